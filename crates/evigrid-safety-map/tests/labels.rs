//! Algorithm 2 on height maps that hold each rule alone. Cells are 0.1 m wide.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use evigrid_grid::{SafetyLabel, SafetyMap};
use evigrid_safety_map::{Columns, SafetyMapSettings, Spread, label_columns};

use common::{FLOOR, ROBOT, labelled, plan};

fn defaults() -> SafetyMapSettings {
    SafetyMapSettings::default()
}

fn at(map: &SafetyMap, x: f64, y: f64) -> SafetyLabel {
    map.labels()[map.spec().cell_of([x, y]).unwrap()]
}

#[test]
fn a_level_floor_is_level() {
    let map = labelled(&defaults(), |_| 0.0);
    assert!(map.labels().iter().all(|&label| label == SafetyLabel::Level));
    assert_eq!(map.planes().len(), 1);
}

/// A step of 15 cm goes up two layers, so that no segment leads there; one of 10 cm leads there, but the
/// planes disagree.
#[test]
fn steps_are_unsafe() {
    for (step_m, expected) in
        [(0.15, SafetyLabel::NonGround), (-0.15, SafetyLabel::NonGround), (0.10, SafetyLabel::NonGround)]
    {
        let map = labelled(&defaults(), |[x, _]| if x > 1.0 { step_m } else { 0.0 });
        assert_eq!(at(&map, 0.5, 0.0), SafetyLabel::Level);
        assert_eq!(at(&map, 1.5, 0.0), expected, "{step_m}");
    }
}

/// h_T: planes agree if they differ by less than 5 cm. The floor is at 0.03 m, so that both steps reach the
/// next layer.
#[test]
fn steps_of_less_than_5_cm_are_safe() {
    let beyond = |step_m: f64| {
        let map = labelled(&defaults(), move |[x, _]| if x > 1.0 { 0.03 + step_m } else { 0.03 });
        at(&map, 1.5, 0.0)
    };
    assert_eq!(beyond(0.049), SafetyLabel::Level);
    assert_eq!(beyond(0.051), SafetyLabel::NonGround);
}

/// num_T: a platform one layer up, 4 cm high, that touches the floor along some cells alone; of n facing cells
/// n on either side count, and one more at each end, since cells touch at corners too.
#[test]
fn five_cells_lead_to_a_segment_and_four_do_not() {
    // The platform begins at x = 1; a trench keeps it from the floor but for a bridge of `width` cells.
    let platform = |width: f64, settings: &SafetyMapSettings| {
        let map = labelled(settings, move |[x, y]| match x {
            _ if x > 1.1 => 0.07,
            _ if x > 0.7 && !(0.0..width).contains(&y) => f64::NAN,
            _ if x > 1.0 => 0.07,
            _ => 0.03,
        });
        at(&map, 1.5, 0.0)
    };
    // One cell of bridge: its end, and that of the platform, make 2 agreeing cells.
    let limit = |min_border_cells| SafetyMapSettings { min_border_cells, ..defaults() };
    assert_eq!(platform(0.1, &limit(2)), SafetyLabel::Level);
    assert_eq!(platform(0.1, &limit(3)), SafetyLabel::NonGround);
    // Two cells wide: 2 + 2. Three cells: 3 + 3, so that the paper's 5 are reached.
    assert_eq!(platform(0.2, &defaults()), SafetyLabel::NonGround);
    assert_eq!(platform(0.3, &defaults()), SafetyLabel::Level);
}

/// n_small: five cells are too few, six are not (a 2 x 3 patch has no interior, so the rule for thin ones is
/// off here).
#[test]
fn small_segments_are_unknown() {
    let patch = |cells: f64| {
        let settings = SafetyMapSettings { min_interior_per_boundary: 0.0, ..defaults() };
        let map = labelled(&settings, move |[x, y]| {
            let inside = (0.5..0.7).contains(&x) && (0.0..cells * 0.1 - 0.001).contains(&y);
            if inside { 0.07 } else { 0.03 }
        });
        at(&map, 0.55, 0.05)
    };
    assert_eq!(patch(2.0), SafetyLabel::Unknown);
    assert_eq!(patch(3.0), SafetyLabel::Level);
}

/// r_thin: a strip two cells wide has no interior; one of 3 x 20 cells has 18 for 42.
#[test]
fn thin_segments_are_unknown() {
    let strip = |width: f64| {
        let map = labelled(&defaults(), move |[x, y]| {
            if (0.5..0.5 + width).contains(&x) && (-1.0..1.0).contains(&y) { 0.07 } else { 0.03 }
        });
        at(&map, 0.55, 0.05)
    };
    assert_eq!(strip(0.199), SafetyLabel::Unknown);
    assert_eq!(strip(0.299), SafetyLabel::Level);
}

/// theta_max and theta_T: ramps that begin at x = 0.5 m.
#[test]
fn slopes_decide_between_level_inclined_and_unsafe() {
    let ramp = |slope_deg: f64| {
        let rise = slope_deg.to_radians().tan();
        let map = labelled(&defaults(), move |[x, _]| (x - 0.5).max(0.0) * rise);
        (at(&map, 0.2, 0.0), at(&map, 1.4, 0.0))
    };
    assert_eq!(ramp(2.0), (SafetyLabel::Level, SafetyLabel::Level));
    assert_eq!(ramp(6.0), (SafetyLabel::Level, SafetyLabel::Inclined));
    assert_eq!(ramp(14.0), (SafetyLabel::Level, SafetyLabel::NonGround));
}

/// As printed, a thin segment between two safe ones becomes safe again; by the reading it stays unknown.
#[test]
fn the_printed_algorithm_makes_thin_segments_safe() {
    let strip = |spread| {
        let settings = SafetyMapSettings { spread, ..defaults() };
        let map = labelled(&settings, |[x, _]| if (0.5..0.699).contains(&x) { 0.07 } else { 0.03 });
        at(&map, 0.55, 0.0)
    };
    assert_eq!(strip(Spread::Unexamined), SafetyLabel::Unknown);
    assert_eq!(strip(Spread::Any), SafetyLabel::Level);
}

/// Cells without a column are unknown, those beyond the radius unexamined, and high columns unsafe.
#[test]
fn cells_outside_of_segments() {
    let map = labelled(&defaults(), |[x, y]| match (x, y) {
        _ if x > 1.5 => f64::NAN,
        _ if y > 1.5 => 0.8,
        _ => 0.0,
    });
    assert_eq!(at(&map, 1.8, 0.0), SafetyLabel::Unknown);
    assert_eq!(at(&map, 0.0, 1.8), SafetyLabel::NonGround);
    let mut columns = Columns::none(plan());
    columns.fill(plan(), ROBOT.at_m, 0.5, |_| None);
    let map = label_columns(&columns, &ROBOT, FLOOR, &defaults(), &|_, _| false);
    assert_eq!(at(&map, 0.0, 0.0), SafetyLabel::Unknown);
    assert_eq!(at(&map, 1.0, 0.0), SafetyLabel::Unexamined);
}

/// No floor in reach: nothing is known, whatever else stands there.
#[test]
fn without_floor_nothing_is_known() {
    let map = labelled(&defaults(), |_| 0.9);
    assert!(map.labels().iter().all(|&label| label == SafetyLabel::Unknown));
}

/// A potential drop-off edge is safe, next to an unknown cell, and near lower ground.
#[test]
fn edges_of_drop_offs_are_marked() {
    let map = labelled(&defaults(), |[x, _]| match x {
        _ if x > 1.2 => -0.5,
        _ if x > 1.0 => f64::NAN,
        _ => 0.0,
    });
    let marked: Vec<f64> =
        (0..map.labels().len()).filter(|&n| map.drop_offs()[n]).map(|n| map.spec().centre_m(n)[0]).collect();
    assert!(!marked.is_empty() && marked.iter().all(|x| (x - 0.95).abs() < 1e-9), "{marked:?}");
    // The same gap without lower ground behind it.
    let map = labelled(&defaults(), |[x, _]| if (1.0..1.2).contains(&x) { f64::NAN } else { 0.0 });
    assert!(map.drop_offs().iter().all(|&marked| !marked));
}

/// A wall of 90 degrees: its columns are high, and no plane of it is ground.
#[test]
fn a_wall_is_unsafe() {
    let map = labelled(&defaults(), |[x, _]| if x > 1.0 { 1.2 } else { 0.0 });
    assert_eq!((at(&map, 0.9, 0.0), at(&map, 1.1, 0.0)), (SafetyLabel::Level, SafetyLabel::NonGround));
}
