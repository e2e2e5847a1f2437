//! Scores of plans and safety maps against loops over all cells and against numbers worked out by hand.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_grid::{LayerKind, PlanGrid, PlanSpec, SafetyLabel, SafetyMap, SafetyPlane};
use evigrid_metrics::{
    PlanCase, PlanReference, PlanState, PlanTally, PlaneErrors, PlanningDisc, SafetyCase, SafetyReference,
    Score, Scores,
};
use nalgebra::{Isometry2, Vector2, Vector3};
use proptest::prelude::*;

use PlanState::{Free, Occupied, Unknown};

fn spec() -> PlanSpec {
    PlanSpec::of_area([0.0, 3.0], [0.0, 2.0], 1.0).unwrap()
}

fn plan(probabilities: &[f32], map_from_plan: Isometry2<f64>) -> PlanGrid {
    let mut plan = PlanGrid::moving(spec(), map_from_plan);
    plan.probabilities_mut().copy_from_slice(probabilities);
    plan
}

#[test]
fn a_plan_by_hand() {
    let reference =
        PlanReference { spec: spec(), cells: vec![Occupied, Free, Unknown, Free, Occupied, Occupied] };
    // Hit, mistake, not counted, rightly free, undecided, unknown.
    let found = plan(&[0.9, 0.7, 0.9, 0.2, 0.5, f32::NAN], Isometry2::identity());
    let scores = Scores::plan(&found, &reference);
    let columns: Vec<String> = scores.list.iter().map(Score::column).collect();
    assert_eq!(columns, Scores::columns(LayerKind::Plan, &[0.2], false));
    // What is counted frame by frame is known at the end.
    let mut at_end = scores.clone();
    at_end.add_frames(&PlanTally::default());
    let columns: Vec<String> = at_end.list.iter().map(Score::column).collect();
    assert_eq!(columns, Scores::columns(LayerKind::Plan, &[0.2], true));
    let get = |column| scores.get(column).unwrap();
    assert_eq!((get("plan_hits"), get("plan_mistakes"), get("plan_missed")), (1.0, 1.0, 2.0));
    assert_eq!((get("plan_precision"), get("plan_recall"), get("plan_f1")), (0.5, 1.0 / 3.0, 0.4));
    // True 0.9, 0.5, 0.5 against free 0.7, 0.2: four of six pairs are in order.
    assert_eq!(get("plan_auc"), 4.0 / 6.0);
    assert_eq!(scores.main().unwrap().metric.name, "plan_f1");
}

#[test]
fn a_plan_that_knows_nothing_has_an_auc_of_a_half() {
    let reference = PlanReference { spec: spec(), cells: vec![Occupied, Free, Free, Free, Free, Occupied] };
    let scores = Scores::plan(&PlanGrid::unknown(spec()), &reference);
    assert_eq!((scores.get("plan_auc"), scores.get("plan_f1")), (Some(0.5), Some(0.0)));
    assert!(scores.get("plan_precision").unwrap().is_nan());
    let nothing_true = PlanReference { spec: spec(), cells: vec![Free; 6] };
    assert!(Scores::plan(&PlanGrid::unknown(spec()), &nothing_true).get("plan_auc").unwrap().is_nan());
}

#[test]
fn a_moving_plan_is_scored_where_the_vehicle_is() {
    let mut cells = vec![Free; 6];
    cells[0] = Occupied; // x 0..1, y 0..1: behind the vehicle
    cells[5] = Occupied; // x 2..3, y 1..2
    let reference = PlanReference { spec: spec(), cells };
    let ahead = Isometry2::translation(1.0, 0.0);
    // The cell at x 1..2, y 1..2 of the plan lies at x 2..3 of the map; the last row lies outside.
    let found = plan(&[0.1, 0.1, 0.1, 0.8, 0.9, 0.9], ahead);
    let case = PlanCase::new(&found, &reference);
    assert_eq!((case.counts.hits, case.counts.mistakes, case.counts.missed), (1, 0, 1));
    assert_eq!(case.cells.len(), 4);
}

/// Every pair of a true and a free cell; cells are looked up by distances, not by indices.
fn slowly(found: &PlanGrid, reference: &PlanReference) -> [f64; 4] {
    let inside = |a: [f64; 2], b: [f64; 2]| (0..2).all(|i| (a[i] - b[i]).abs() < 0.5);
    let cells = |spec: &PlanSpec| (0..spec.cell_count()).collect::<Vec<_>>();
    let (mut counts, mut known) = ([0.0; 3], Vec::new());
    for flat in cells(found.spec()) {
        let centre = found.centre_in_map_m(flat);
        let p = found.probabilities()[flat];
        for other in
            cells(&reference.spec).into_iter().filter(|&o| inside(centre, reference.spec.centre_m(o)))
        {
            match (reference.cells[other], p > 0.5) {
                (Unknown, _) => continue,
                (Occupied, true) => counts[0] += 1.0,
                (Free, true) => counts[1] += 1.0,
                (Occupied, false) => counts[2] += 1.0,
                (Free, false) => {}
            }
            known.push((if p.is_nan() { 0.5 } else { p }, reference.cells[other] == Occupied));
        }
    }
    for other in cells(&reference.spec).into_iter().filter(|&o| reference.cells[o] == Occupied) {
        let centre = found.map_from_plan().inverse() * nalgebra::Point2::from(reference.spec.centre_m(other));
        let covered =
            cells(found.spec()).into_iter().any(|f| inside(centre.into(), found.spec().centre_m(f)));
        counts[2] += f64::from(u8::from(!covered));
    }
    let (mut ordered, mut pairs) = (0.0, 0.0);
    for (p, _) in known.iter().filter(|k| k.1) {
        for (q, _) in known.iter().filter(|k| !k.1) {
            pairs += 1.0;
            ordered += f64::from(u8::from(p > q)) + 0.5 * f64::from(u8::from(p == q));
        }
    }
    [counts[0], counts[1], counts[2], ordered / pairs]
}

proptest! {
    #[test]
    fn plans_equal_all_pairs(
        probabilities in prop::collection::vec(
            prop_oneof![Just(f32::NAN), Just(0.1_f32), Just(0.5), Just(0.51), Just(0.9)], 6),
        cells in prop::collection::vec(prop_oneof![Just(Unknown), Just(Free), Just(Occupied)], 6),
        (x, y, yaw) in (-1.3..1.3, -1.3..1.3, -3.1..3.1),
    ) {
        let found = plan(&probabilities, Isometry2::new(Vector2::new(x, y), yaw));
        let reference = PlanReference { spec: spec(), cells };
        let scores = Scores::plan(&found, &reference);
        let expected = slowly(&found, &reference);
        let columns = ["plan_hits", "plan_mistakes", "plan_missed", "plan_auc"];
        for (column, expected) in columns.into_iter().zip(expected) {
            let value = scores.get(column).unwrap();
            let same = (value - expected).abs() < 1e-12 || value.is_nan() && expected.is_nan();
            prop_assert!(same, "{column}: {value} {expected}");
        }
    }
}

fn safety(spec: PlanSpec, labels: &[SafetyLabel]) -> SafetyMap {
    let mut map = SafetyMap::unknown(spec);
    labels.iter().enumerate().for_each(|(flat, label)| map.set(flat, *label, None));
    map
}

#[test]
fn a_safety_map_by_hand() {
    use SafetyLabel::{Inclined, Level, NonGround, Unknown};
    let wide = PlanSpec::of_area([0.0, 4.0], [0.0, 2.0], 1.0).unwrap();
    let truth = safety(wide, &[NonGround, NonGround, NonGround, Level, Inclined, Unknown, NonGround, Level]);
    // The map ends before the last two cells of the truth.
    let found = safety(spec(), &[NonGround, Level, Unknown, Inclined, NonGround, NonGround]);
    let truth = SafetyReference::new(truth);
    let scores = Scores::safety(&SafetyCase::new(&found, &truth, None));
    let columns: Vec<String> = scores.list.iter().map(Score::column).collect();
    assert_eq!(columns, Scores::columns(LayerKind::Safety, &[], true));
    for (column, value) in [
        ("safety_fn_rate", 1.0 / 2.0),
        ("safety_fp_rate", 1.0 / 2.0),
        ("safety_unclassified", 3.0 / 7.0),
        ("safety_unsafe_found", 1.0 / 4.0),
    ] {
        assert_eq!(scores.get(column), Some(value), "{column}");
    }
    assert_eq!(scores.main().unwrap().metric.name, "safety_unsafe_found");
    let empty = Scores::safety(&SafetyCase::new(&SafetyMap::unknown(spec()), &truth, None));
    assert!(empty.get("safety_fn_rate").unwrap().is_nan());
    assert_eq!((empty.get("safety_unclassified"), empty.get("safety_unsafe_found")), (Some(1.0), Some(0.0)));
}

/// In a row of cells, those on either side of a step from safe to unsafe are at the border; unknown cells make
/// none, nor do those that lie apart.
#[test]
fn cells_at_borders_by_hand() {
    use SafetyLabel::{Inclined, Level, NonGround, Unknown};
    let row = PlanSpec::of_area([0.0, 8.0], [0.0, 1.0], 1.0).unwrap();
    let labels = [Level, Inclined, NonGround, NonGround, NonGround, Unknown, Level, Level];
    let truth = SafetyReference::new(safety(row, &labels));
    let at_border: Vec<usize> = (0..8).filter(|&cell| truth.is_at_border(cell)).collect();
    assert_eq!(at_border, [1, 2]);
    // Everything is called level: two of three unsafe cells are left beside the border.
    let found = safety(row, &[Level; 8]);
    let case = SafetyCase::new(&found, &truth, None);
    assert_eq!((case.strict.false_negatives, case.beside_borders.false_negatives), (3, 2));
    assert_eq!((case.strict.true_negatives, case.beside_borders.true_negatives), (4, 3));
    assert_eq!((case.inclined, case.inclined_found), (1, 0));
    // A robot at 6.5 m that plans 1 m ahead: the cells 6 and 7 count, 5 is unknown; the radius is included.
    let disc = PlanningDisc { at_m: [6.5, 0.5], radius_m: 1.0 };
    let mut near = SafetyCase::new(&found, &truth, Some(disc));
    assert_eq!((near.strict.false_negatives, near.strict.true_negatives), (0, 2));
    near.add(&case);
    assert_eq!((near.strict.false_negatives, near.strict.true_negatives), (3, 6));
}

/// A plane one degree off and 10 cm too high, on a floor; a second one, half on the floor and mostly on a ramp.
#[test]
fn planes_are_held_against_the_true_plane_below_most_of_their_cells() {
    use SafetyLabel::{Inclined, Level};
    let tilted = |degrees: f64, offset_m: f64| {
        let (s, c) = degrees.to_radians().sin_cos();
        SafetyPlane { normal: Vector3::new(-s, 0.0, c), offset_m }
    };
    let row = PlanSpec::of_area([0.0, 6.0], [-0.5, 0.5], 1.0).unwrap();
    let with_planes = |planes: [SafetyPlane; 2], first: usize| {
        let mut map = SafetyMap::unknown(row);
        let numbers = planes.map(|plane| map.add_plane(plane));
        (0..6).for_each(|n| {
            let (label, plane) = if n < first { (Level, numbers[0]) } else { (Inclined, numbers[1]) };
            map.set(n, label, Some(plane));
        });
        map
    };
    let truth = SafetyReference::new(with_planes([tilted(0.0, 0.0), tilted(6.0, 0.0)], 3));
    let found = with_planes([tilted(1.0, 0.1), tilted(6.5, 0.0)], 2);
    let case = SafetyCase::new(&found, &truth, None);
    assert_eq!((case.level_planes.count, case.inclined_planes.count), (1, 1));
    assert!((case.level_planes.mean_angle_deg() - 1.0).abs() < 1e-9);
    assert!((case.inclined_planes.mean_angle_deg() - 0.5).abs() < 1e-9);
    // Heights of the first plane over its cells at x = 0.5 and 1.5 m, from the floor.
    let height_m = |x: f64| (0.1 + x * 1.0_f64.to_radians().sin()) / 1.0_f64.to_radians().cos();
    let expected_cm = 50.0 * (height_m(0.5) + height_m(1.5));
    assert!((case.level_planes.mean_distance_cm() - expected_cm).abs() < 1e-9);
    assert_eq!(case.planes().count, 2);
    assert_eq!(case.inclined_rate(), 1.0);
}

/// Angles 1, 2 and 6 degrees: mean 3, squares of the differences 4, 1 and 9. Distances 0.01, 0.02 and 0.06 m.
#[test]
fn deviations_of_planes_are_those_of_all_frames_together() {
    let (mut first, mut second) = (PlaneErrors::default(), PlaneErrors::default());
    first.add_plane(1.0, 0.01);
    first.add_plane(2.0, 0.02);
    second.add_plane(6.0, 0.06);
    assert_eq!(second.deviation_angle_deg(), 0.0);
    first.add(&second);
    let expected = (14.0_f64 / 3.0).sqrt();
    assert!((first.mean_angle_deg() - 3.0).abs() < 1e-12 && (first.mean_distance_cm() - 3.0).abs() < 1e-12);
    assert!((first.deviation_angle_deg() - expected).abs() < 1e-9);
    assert!((first.deviation_distance_cm() - expected).abs() < 1e-9);
    assert!(PlaneErrors::default().deviation_angle_deg().is_nan());
}
