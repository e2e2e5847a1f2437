//! Safety maps over frames: by place and by hazard, counted by hand.
#![allow(clippy::unwrap_used)]

use evigrid_grid::SafetyLabel::{self, Inclined, Level, NonGround, Unknown};
use evigrid_grid::{PlanSpec, SafetyMap};
use evigrid_metrics::{
    AreaTally, NamedArea, PlaceCounts, PlanningDisc, SafetyCounts, SafetyReference, SafetyTally,
};

/// A row of ten cells of 0.5 m along x, from 0 on.
fn row(labels: [SafetyLabel; 10]) -> SafetyMap {
    let mut map = SafetyMap::unknown(PlanSpec::of_area([0.0, 5.0], [-0.25, 0.25], 0.5).unwrap());
    labels.into_iter().enumerate().for_each(|(flat, label)| map.set(flat, label, None));
    map
}

fn robot(x: f64) -> PlanningDisc {
    PlanningDisc { at_m: [x, 0.0], radius_m: 2.0 }
}

fn truth() -> SafetyReference {
    let labels = [Level, Level, Level, Level, NonGround, NonGround, Unknown, Inclined, Inclined, Level];
    let area =
        |name: &str, is_safe, cells| NamedArea { name: name.into(), kind: "it".into(), is_safe, cells };
    let areas = vec![area("pit", false, vec![4, 5]), area("ramp", true, vec![7, 8])];
    SafetyReference::new(row(labels)).with_areas(areas).with_way(&[[0.25, 0.0], [1.25, 0.0], [1.25, 0.0]])
}

/// Two frames: from 0.25 m the cells 0 to 4 are in reach, from 1.25 m the cells 0 to 6.
fn tally() -> SafetyTally {
    let truth = truth();
    let mut tally = SafetyTally::new(&truth);
    let first = row([Level, NonGround, Level, NonGround, Level, Level, Level, Level, Level, Level]);
    tally.add(&first, &truth, robot(0.25), 0);
    let second = row([Level, Level, Unknown, Level, NonGround, Level, Level, Level, Level, Level]);
    tally.add(&second, &truth, robot(1.25), 1);
    tally
}

fn counts(numbers: [usize; 6]) -> SafetyCounts {
    let [
        true_positives,
        false_positives,
        true_negatives,
        false_negatives,
        unclassified_safe,
        unclassified_unsafe,
    ] = numbers;
    SafetyCounts {
        true_positives,
        false_positives,
        true_negatives,
        false_negatives,
        unclassified_safe,
        unclassified_unsafe,
    }
}

#[test]
fn a_tally_is_the_sum_of_its_frames() {
    // TP, FP, TN, FN, unclassified safe and unsafe.
    assert_eq!(tally().case.strict, counts([1, 2, 5, 2, 1, 0]));
}

#[test]
fn places_by_hand() {
    let list = tally().places.list(0.5);
    let of = |place: &str| -> Vec<&PlaceCounts> { list.iter().filter(|p| p.place == place).collect() };
    let rings = of("ring around the robot");
    // Frame 0: cells 0, 1 | 2, 3 | 4 at 0, 0.5 | 1, 1.5 | 2 m. Frame 1: cells 2, 1, 3 | 0, 4 | 5 unsafe in truth,
    // at 1.5 m; the cell at 2 m is unknown in truth.
    assert_eq!(
        rings.iter().map(|r| r.range_m).collect::<Vec<_>>(),
        [0, 1, 2].map(|n| [f64::from(n), f64::from(n) + 1.0].map(Some))
    );
    let expected = [[0, 1, 3, 0, 1, 0], [1, 1, 2, 1, 0, 0], [0, 0, 0, 1, 0, 0]].map(counts);
    assert_eq!(rings.iter().map(|r| r.counts).collect::<Vec<_>>(), expected);
    // After frame 0 the robot drives over cells 0, 1 and 2; after frame 1 it stays on cell 2, which is unknown.
    assert_eq!(
        of("driven over later").iter().map(|p| p.counts).collect::<Vec<_>>(),
        [counts([0, 1, 2, 0, 1, 0])]
    );
    // Cell 3 lies beside the pit, cell 2 two cells off, cell 1 three, cell 0 four.
    let near = of("safe, by distance from unsafe");
    assert_eq!(near[0].range_m, [Some(0.0), Some(0.75)]);
    assert_eq!(near[5].range_m, [Some(5.25), None]);
    let expected =
        [[0, 1, 1, 0, 0, 0], [0, 0, 1, 0, 1, 0], [0, 1, 1, 0, 0, 0], [0, 0, 2, 0, 0, 0], [0; 6], [0; 6]];
    assert_eq!(near.iter().map(|p| p.counts).collect::<Vec<_>>(), expected.map(counts));
}

#[test]
fn hazards_by_hand() {
    let [pit, ramp]: [AreaTally; 2] = tally().areas.try_into().unwrap();
    assert_eq!(pit.counts, counts([1, 0, 0, 2, 0, 0]));
    let nearest = pit.nearest.unwrap();
    assert_eq!((nearest.distance_m, nearest.counts), (1.0, counts([1, 0, 0, 1, 0, 0])));
    assert_eq!((pit.recall(&nearest.counts), pit.wrong(&nearest.counts)), (0.5, 0.5));
    // In the first frame the pit is called safe, in the second half of it is found.
    assert_eq!((pit.first.unwrap().distance_m, pit.half.unwrap().distance_m), (1.0, 1.0));
    // The ramp was never in reach.
    assert_eq!((ramp.nearest, ramp.first, ramp.half), (None, None, None));
    assert!(ramp.recall(&ramp.counts).is_nan());
}

/// A safe area is found where it is safe, and its views are kept from the frame they belong to.
#[test]
fn a_safe_area_is_right_where_it_is_safe() {
    let truth = truth();
    let mut tally = SafetyTally::new(&truth);
    for (x, label) in [(2.25, NonGround), (2.75, Unknown), (3.25, Inclined)] {
        tally.add(&row([label; 10]), &truth, robot(x), 0);
    }
    let ramp = &tally.areas[1];
    // From 2.25 m cells 7 and 8 lie at 1.5 and 2 m, from 3.25 m at 0.5 and 1 m.
    assert_eq!((ramp.nearest.unwrap().distance_m, ramp.first.unwrap().distance_m), (0.5, 0.5));
    assert_eq!(ramp.counts, counts([0, 2, 2, 0, 2, 0]));
    assert_eq!((ramp.recall(&ramp.counts), ramp.wrong(&ramp.counts)), (1.0 / 3.0, 1.0 / 3.0));
}
