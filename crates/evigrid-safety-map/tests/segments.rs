//! Algorithm 1 against connected components that are computed another way.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeSet;

use evigrid_grid::Moments;
use evigrid_safety_map::{Column, Columns, SafetyMapSettings, Segments};
use proptest::prelude::*;

use common::{FLOOR, ROBOT, plan};

/// Labels all cells by passing the smallest label on between equal neighbours until nothing changes.
fn components(heights: &[Option<i32>], shape: [usize; 2]) -> Vec<Option<usize>> {
    let mut labels: Vec<Option<usize>> = heights.iter().enumerate().map(|(n, h)| h.map(|_| n)).collect();
    loop {
        let before = labels.clone();
        for n in 0..labels.len() {
            for m in touching(n, shape) {
                if heights[n].is_some() && heights[n] == heights[m] {
                    labels[n] = labels[n].min(labels[m]);
                }
            }
        }
        if labels == before {
            return labels;
        }
    }
}

fn touching(n: usize, [nx, ny]: [usize; 2]) -> Vec<usize> {
    let (i, j) = (n / ny, n % ny);
    (0..nx * ny).filter(|&m| m != n && (m / ny).abs_diff(i) <= 1 && (m % ny).abs_diff(j) <= 1).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(40))]
    /// The segments are the components that steps of one layer connect with the robot's.
    #[test]
    fn segments_are_reachable_components(cells in prop::collection::vec(0..6_u8, 12 * 9)) {
        let spec = evigrid_grid::PlanSpec::of_area([-0.6, 0.6], [-0.45, 0.45], 0.1).unwrap();
        let heights: Vec<Option<i32>> =
            cells.iter().map(|&v| (v < 5).then(|| FLOOR + i32::from(v) / 2 * 2 - 1 + i32::from(v > 3))).collect();
        let mut columns = Columns::none(spec);
        columns.fill(spec, ROBOT.at_m, 4.0, |flat| {
            heights[flat].map(|height| Column { height, moments: Moments::default() })
        });
        let found = Segments::find(&columns, &ROBOT, FLOOR, &SafetyMapSettings::default());

        let labels = components(&heights, spec.shape());
        let is_floor = |&n: &usize| heights[n].is_some_and(|h| (h - FLOOR).abs() <= 1);
        let away = |n: usize| { let [x, y] = spec.centre_m(n); x.hypot(y) };
        let start = (0..heights.len()).filter(is_floor).min_by(|&a, &b| away(a).total_cmp(&away(b)));
        let mut expected = BTreeSet::new();
        expected.extend(start.and_then(|n| labels[n]));
        loop {
            let before = expected.len();
            for (n, height) in heights.iter().enumerate() {
                if labels[n].is_some_and(|label| expected.contains(&label)) {
                    let near = |&m: &usize| {
                        heights[m].is_some_and(|h| (h - height.unwrap()).abs() <= 1)
                    };
                    expected.extend(touching(n, spec.shape()).into_iter().filter(near).filter_map(|m| labels[m]));
                }
            }
            if expected.len() == before {
                break;
            }
        }
        prop_assert_eq!(found.list.len(), expected.len());
        for (n, label) in labels.iter().enumerate() {
            let reached = label.is_some_and(|label| expected.contains(&label));
            prop_assert_eq!(found.of(n).is_some(), reached);
        }
        for segment in &found.list {
            let own: BTreeSet<_> = segment.cells.iter().map(|&n| labels[n as usize]).collect();
            prop_assert_eq!(own.len(), 1);
            let all = labels.iter().filter(|label| own.contains(label)).count();
            prop_assert_eq!(all, segment.cells.len());
            let inside = |&&n: &&u32| {
                let same = |&m: &usize| labels[m] == labels[n as usize];
                touching(n as usize, spec.shape()).into_iter().filter(same).count() == 8
            };
            prop_assert_eq!(segment.cells.iter().filter(inside).count(), segment.interior);
        }
    }
}

/// Cells farther than the planning radius are not looked at; those at the radius are.
#[test]
fn the_planning_radius_is_a_disc() {
    let spec = plan();
    let mut columns = Columns::none(spec);
    columns.fill(spec, [0.05, 0.05], 1.0, |_| Some(Column { height: FLOOR, moments: Moments::default() }));
    let inside = (0..spec.cell_count()).filter(|&n| {
        let [x, y] = spec.centre_m(n);
        (x - 0.05).hypot(y - 0.05) <= 1.0 + 1e-9
    });
    assert_eq!(columns.examined().collect::<Vec<_>>(), inside.collect::<Vec<_>>());
    // Moved away, nothing of the old disc is left.
    columns.fill(spec, [9.0, 0.0], 1.0, |_| Some(Column { height: FLOOR, moments: Moments::default() }));
    assert_eq!(columns.examined().count(), 0);
    assert!((0..spec.cell_count()).all(|n| columns.get(n).is_none() && !columns.is_examined(n)));
}
