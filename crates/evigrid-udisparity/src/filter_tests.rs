use super::*;

const SHAPE: [usize; 2] = [100, 90];
const CELLS: usize = 9000;

fn settings(form: FilterForm) -> FilterSettings {
    FilterSettings {
        form,
        velocities: 7,
        step_mps: 1.0,
        static_share: 0.5,
        change_per_s: 0.0,
        weight: 1.0,
        bounds: [0.001, 0.999],
    }
}

/// A filter over cells of 0.2 m, all of them empty.
fn empty(settings: FilterSettings) -> Filter {
    let mut filter = Filter::new(settings, SHAPE, 0.2);
    (0..SHAPE[0] * SHAPE[1]).for_each(|cell| filter.set(cell, 0.0, None));
    filter
}

fn cell([i, j]: [usize; 2]) -> usize {
    i * SHAPE[1] + j
}

/// Cells of a block of 6 x 6 from a corner on.
fn block([i, j]: [usize; 2]) -> impl Iterator<Item = usize> {
    (0..36).map(move |n| cell([i + n / 6, j + n % 6]))
}

static NOTHING: [f32; CELLS] = [f32::NAN; CELLS];

/// Whether nothing that comes in over the border can have reached a cell within 8 steps of up to 3 cells.
fn is_inner(cell: usize) -> bool {
    (24..SHAPE[0] - 24).contains(&(cell / SHAPE[1])) && (24..SHAPE[1] - 24).contains(&(cell % SHAPE[1]))
}

/// Mass after 8 unobserved steps of 0.2 s of a block of 36 cells of 0.98 that moves by one cell a step.
fn unobserved(form: FilterForm) -> f64 {
    let mut filter = empty(settings(form));
    block([40, 40]).for_each(|cell| filter.set(cell, 0.98, Some([1.0, 0.0])));
    (0..=8).for_each(|n| filter.step(n * 200_000_000, [0, 0], &NOTHING).unwrap());
    let inner = filter.probabilities().iter().enumerate().filter(|(cell, _)| is_inner(*cell));
    inner.map(|(_, p)| f64::from(*p)).sum()
}

#[test]
fn an_unobserved_block_keeps_its_mass_or_fades() {
    assert!((unobserved(FilterForm::MassConserving) - 35.28).abs() < 1e-3);
    let (faded, twin) = (unobserved(FilterForm::Normalised), normalised_twin());
    assert!((faded - twin).abs() < 1e-2 * twin, "{faded} {twin}");
}

/// The same block by the definition of the normalised form: every cell takes P(free or occupied, v) from where it would
/// have been, and is divided by all it took. Velocities are whole cells a step; cells beyond the window are not asked.
fn normalised_twin() -> f64 {
    let velocities: Vec<[i64; 2]> = (-3..=3).flat_map(|x| (-3..=3).map(move |y| [x, y])).collect();
    let prior = |v: &[i64; 2]| 0.5 / 49.0 + if *v == [0, 0] { 0.5 } else { 0.0 };
    let block: Vec<usize> = block([40, 40]).collect();
    // P(free, v) and P(occupied, v).
    let start = |cell: usize, v: &[i64; 2]| {
        if block.contains(&cell) {
            let share = f64::from(u8::from(*v == [1, 0]));
            [0.02 * share, 0.98 * share]
        } else {
            [prior(v), 0.0]
        }
    };
    let mut now: Vec<Vec<[f64; 2]>> =
        (0..CELLS).map(|cell| velocities.iter().map(|v| start(cell, v)).collect()).collect();
    for _ in 0..8 {
        let before = now.clone();
        for (cell, to) in now.iter_mut().enumerate() {
            let [i, j] = [cell / SHAPE[1], cell % SHAPE[1]].map(|n| n as i64);
            for (n, v) in velocities.iter().enumerate() {
                let [a, b] = [i - v[0], j - v[1]];
                let is_in = (0..SHAPE[0] as i64).contains(&a) && (0..SHAPE[1] as i64).contains(&b);
                to[n] = if is_in { before[a as usize * SHAPE[1] + b as usize][n] } else { [prior(v), 0.0] };
            }
            let sum: f64 = to.iter().flatten().sum();
            to.iter_mut().flatten().for_each(|p| *p /= sum);
        }
    }
    let inner = now.iter().enumerate().filter(|(cell, _)| is_inner(*cell));
    inner.flat_map(|(_, all)| all).map(|[_, occupied]| occupied).sum()
}

#[test]
fn a_block_moves_with_its_velocity() {
    let mut filter = empty(settings(FilterForm::MassConserving));
    block([40, 50]).for_each(|cell| filter.set(cell, 0.98, Some([1.0, -2.0])));
    // Five steps of one cell along x and two against y.
    (0..=5).for_each(|n| filter.step(n * 200_000_000, [0, 0], &NOTHING).unwrap());
    let inside: Vec<usize> = block([45, 40]).collect();
    for (cell, p) in filter.probabilities().iter().enumerate().filter(|(cell, _)| is_inner(*cell)) {
        let expected = if inside.contains(&cell) { 0.98 } else { 0.0 };
        assert!((p - expected).abs() < 1e-4, "{cell}: {p}");
    }
    let velocity = filter.velocities()[inside[7]];
    assert_eq!(velocity.mode_mps, [1.0, -2.0]);
    assert!(velocity.spread_mps < 1e-2);
}

/// A block that moves by half a cell a frame is observed; nothing tells the filter how fast.
#[test]
fn the_velocity_of_an_observed_block_is_found() {
    for form in [FilterForm::MassConserving, FilterForm::Normalised] {
        let mut filter = Filter::new(settings(form), SHAPE, 0.2);
        for n in 0..20_i64 {
            let mut observed = vec![0.02; SHAPE[0] * SHAPE[1]];
            block([10 + n as usize / 2, 20]).for_each(|cell| observed[cell] = 0.98);
            filter.step(n * 50_000_000, [0, 0], &observed).unwrap();
        }
        // 0.1 m in 0.05 s. Of cells inside the block only what has moved in tells the velocity.
        let velocities = filter.velocities();
        let modes: Vec<[f32; 2]> = block([19, 20]).map(|cell| velocities[cell].mode_mps).collect();
        let count = |mode: &[f32; 2]| modes.iter().filter(|other| *other == mode).count();
        let most = modes.iter().max_by_key(|mode| count(mode)).unwrap();
        assert_eq!(*most, [2.0, 0.0], "{form:?}: {modes:?}");
    }
}

#[test]
fn without_motion_and_observation_nothing_changes() {
    let still = FilterSettings { velocities: 1, ..settings(FilterForm::MassConserving) };
    let mut filter = empty(still);
    block([5, 30]).for_each(|cell| filter.set(cell, 0.7, None));
    let before = filter.probabilities().to_vec();
    (0..4).for_each(|n| filter.step(n * 100_000_000, [0, 0], &NOTHING).unwrap());
    assert_eq!(filter.probabilities(), before);
    // And what is unknown everywhere stays so at any velocity.
    let mut filter = Filter::new(settings(FilterForm::MassConserving), SHAPE, 0.2);
    (0..6).for_each(|n| filter.step(n * 130_000_000, [0, 0], &NOTHING).unwrap());
    assert!(filter.probabilities().iter().all(|p| (p - 0.5).abs() < 1e-4));
}

/// The window goes on under a block that stands in the world.
#[test]
fn a_static_world_stays_where_it_is_in_the_map() {
    let still = FilterSettings { velocities: 1, ..settings(FilterForm::MassConserving) };
    let mut filter = empty(still);
    block([30, 20]).for_each(|cell| filter.set(cell, 0.9, None));
    filter.step(0, [0, 0], &NOTHING).unwrap();
    filter.step(100_000_000, [3, -2], &NOTHING).unwrap();
    let inside: Vec<usize> = block([27, 22]).collect();
    for (flat, p) in filter.probabilities().iter().enumerate() {
        let (i, j) = (flat / SHAPE[1], flat % SHAPE[1]);
        let is_new = i >= SHAPE[0] - 3 || j < 2;
        let expected = if is_new {
            0.5
        } else if inside.contains(&flat) {
            0.9
        } else {
            0.0
        };
        assert!((p - expected).abs() < 1e-6, "{i} {j}: {p}");
    }
}

/// Every cell by itself: what is there goes to the four cells around its target.
#[test]
fn moving_is_that_of_the_definition() {
    let (nx, ny) = (7, 6);
    let from: Vec<f32> = (0..42).map(|n| ((n * 29) % 17) as f32).collect();
    for by in [[0.0, 0.0], [1.0, -2.0], [0.3, 0.6], [-2.7, 1.2], [-0.4, -5.5], [9.0, 0.0], [0.0, -9.3]] {
        let mut to = vec![0.0; 42];
        moved(&from, &mut to, [nx, ny], by, 3.0);
        let at = |i: f64, j: f64| {
            let is_in = (0.0..nx as f64).contains(&i) && (0.0..ny as f64).contains(&j);
            if is_in { f64::from(from[i as usize * ny + j as usize]) } else { 3.0 }
        };
        for (n, found) in to.iter().enumerate() {
            let (i, j) = ((n / ny) as f64 - by[0], (n % ny) as f64 - by[1]);
            let (a, b) = (i - i.floor(), j - j.floor());
            let (i, j) = (i.floor(), j.floor());
            let expected = (1.0 - a) * ((1.0 - b) * at(i, j) + b * at(i, j + 1.0))
                + a * ((1.0 - b) * at(i + 1.0, j) + b * at(i + 1.0, j + 1.0));
            assert!((f64::from(*found) - expected).abs() < 1e-4, "{by:?} {n}: {found} {expected}");
        }
    }
}

#[test]
fn bad_times_and_rates_are_refused_and_change_nothing() {
    let mut filter = Filter::new(settings(FilterForm::MassConserving), SHAPE, 0.2);
    filter.step(1_000_000_000, [0, 0], &[0.9; CELLS]).unwrap();
    let before = filter.probabilities().to_vec();
    for (stamp, text) in [
        (1_000_000_000, "time stamp"),
        (900_000_000, "time stamp"),
        (i64::MIN, "time stamp"),
        (1_001_000_000, "0.02 cells"),
        (9_000_000_000, "half the grid"),
    ] {
        let error = filter.step(stamp, [0, 0], &[0.9; CELLS]).unwrap_err().to_string();
        assert!(error.contains(text), "{error}");
        assert_eq!(filter.probabilities(), before);
    }
    filter.step(1_200_000_000, [0, 0], &[0.9; CELLS]).unwrap();
}

#[test]
fn impossible_settings_are_refused() {
    let base = settings(FilterForm::MassConserving);
    let refuse = |s: FilterSettings| s.check("visibility").unwrap_err().to_string();
    assert!(refuse(FilterSettings { velocities: 4, ..base }).contains("velocities: expected an odd number"));
    assert!(refuse(FilterSettings { step_mps: 0.0, ..base }).contains("velocity_step_mps"));
    assert!(refuse(FilterSettings { static_share: 1.1, ..base }).contains("static_share"));
    assert!(refuse(FilterSettings { change_per_s: f64::NAN, ..base }).contains("velocity_change_per_s"));
    assert!(refuse(FilterSettings { weight: 0.0, ..base }).contains("observation_weight"));
    assert!(refuse(FilterSettings { bounds: [0.0, 0.9], ..base }).contains("filter_bounds"));
}
