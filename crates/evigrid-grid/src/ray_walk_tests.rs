#![allow(clippy::unwrap_used)]
use super::*;
use crate::GridSettings;
use proptest::prelude::*;

fn spec() -> GridSpec {
    let settings = GridSettings { x_m: [0.0, 8.0], y_m: [0.0, 6.0], z_m: [0.0, 4.0], cell_size_m: 1.0 };
    GridSpec::new(&settings).unwrap()
}

/// Length of the parameter interval that the segment spends in a cell, by brute force.
fn overlap(cell: [usize; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
    let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
    for a in 0..3 {
        let (low, d) = (cell[a] as f64, to[a] - from[a]);
        if d.abs() < 1e-12 {
            if from[a] < low || from[a] >= low + 1.0 {
                return -1.0;
            }
        } else {
            let (t0, t1) = ((low - from[a]) / d, (low + 1.0 - from[a]) / d);
            enter = enter.max(t0.min(t1));
            leave = leave.min(t0.max(t1));
        }
    }
    leave - enter
}

fn check(from: [f64; 3], to: [f64; 3]) -> Result<(), TestCaseError> {
    let spec = spec();
    let walk: Vec<_> = RayWalk::in_cells(&spec, from, to).collect();
    let visited: Vec<_> = walk.iter().map(|&(flat, _)| spec.voxel(flat)).collect();
    for flat in 0..spec.cell_count() {
        let cell = spec.voxel(flat);
        let overlap = overlap(cell, from, to);
        let count = visited.iter().filter(|v| **v == cell).count();
        prop_assert!(count <= 1, "{cell:?} twice");
        prop_assert!(overlap < 1e-9 || count == 1, "{cell:?} missed, overlap {overlap}");
        prop_assert!(overlap > -1e-9 || count == 0, "{cell:?} not met, overlap {overlap}");
    }
    for (pair, steps) in visited.windows(2).zip(walk.windows(2)) {
        let moved: usize = (0..3).map(|a| pair[0][a].abs_diff(pair[1][a])).sum();
        prop_assert_eq!(moved, 1, "from {:?} to {:?}", pair[0], pair[1]);
        prop_assert_eq!(steps[0].1 - steps[1].1, 1);
    }
    check_parameters(&spec, from, to)?;
    let inside = |p: [f64; 3]| spec.flat(p.map(|v| v.floor() as i64));
    if let Some(end) = inside(to) {
        prop_assert_eq!(walk.last().copied(), Some((end, 0)));
    }
    if let Some(start) = inside(from) {
        prop_assert_eq!(walk.first().map(|w| w.0), Some(start));
    }
    Ok(())
}

/// Every cell holds the middle between where it is entered and where it is left.
fn check_parameters(spec: &GridSpec, from: [f64; 3], to: [f64; 3]) -> Result<(), TestCaseError> {
    let mut walk = RayWalk::in_cells(spec, from, to);
    let mut enter = walk.enter();
    loop {
        let leave = walk.leave();
        let Some((cell, _)) = walk.next() else { return Ok(()) };
        let middle: [f64; 3] = std::array::from_fn(|a| from[a] + (to[a] - from[a]) * 0.5 * (enter + leave));
        let cell = spec.voxel(cell).map(|v| v as f64);
        let within = |a: usize| (cell[a] - 1e-8..cell[a] + 1.0 + 1e-8).contains(&middle[a]);
        prop_assert!((0..3).all(within), "{cell:?} holds no {middle:?}");
        prop_assert!(leave > enter - 1e-9);
        enter = leave;
    }
}

fn anywhere() -> impl Strategy<Value = [f64; 3]> {
    [-4.0..12.0, -4.0..10.0, -4.0..8.0]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2000))]
    #[test]
    fn the_walk_visits_what_the_segment_crosses(from in anywhere(), to in anywhere()) {
        check(from, to)?;
    }

    #[test]
    fn also_along_faces_edges_and_diagonals(
        from in [-2..10_i32, -2..8_i32, -2..6_i32],
        to in [-2..10_i32, -2..8_i32, -2..6_i32],
        shift in [0.0..1.0_f64, 0.0..1.0_f64, 0.0..1.0_f64],
    ) {
        // Shifted off the faces: the segment then still runs parallel to axes and diagonals, through edges.
        let at = |p: [i32; 3]| std::array::from_fn(|a| f64::from(p[a]) + shift[a].clamp(0.01, 0.99));
        let spec = spec();
        let (from, to) = (at(from), at(to));
        let walk: Vec<_> = RayWalk::in_cells(&spec, from, to).collect();
        for (flat, _) in &walk {
            prop_assert!(overlap(spec.voxel(*flat), from, to) > -1e-9);
        }
        for flat in 0..spec.cell_count() {
            let met = walk.iter().any(|w| w.0 == flat);
            prop_assert!(met || overlap(spec.voxel(flat), from, to) < 1e-9);
        }
    }
}

#[test]
fn steps_are_counted_beyond_the_grid() {
    // Along +x from cell 6: the grid ends with cell 7, the segment in cell 20.
    let walk: Vec<_> = RayWalk::in_cells(&spec(), [6.5, 0.5, 0.5], [20.5, 0.5, 0.5]).collect();
    assert_eq!(walk.iter().map(|w| w.1).collect::<Vec<_>>(), [14, 13]);
    assert_eq!(RayWalk::in_cells(&spec(), [9.0, 0.5, 0.5], [20.5, 0.5, 0.5]).count(), 0);
    let to_goal = RayWalk::towards(&spec(), [1.5, 0.5, 0.5], [4.5, 0.5, 0.5], [3, 0, 0]);
    assert_eq!(to_goal.map(|w| w.1).collect::<Vec<_>>(), [2, 1, 0, -1]);
    for goal in [[3, 0, 0], [1, 1, 1]] {
        assert_eq!(RayWalk::towards(&spec(), [1.5, 0.5, 0.5], [1.5, 0.5, 0.5], goal).steps(), 2);
    }
    let point: Vec<_> = RayWalk::in_cells(&spec(), [1.5, 1.5, 1.5], [1.5, 1.5, 1.5]).collect();
    assert_eq!(point, [(24 + 4 + 1, 0)]);
}
