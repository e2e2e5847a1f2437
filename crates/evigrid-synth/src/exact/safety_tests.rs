use super::super::fixtures::{a_box, grid, object, turned_map, world};
use super::*;
use SafetyLabel::{Inclined, Level, NonGround, Unknown};

/// A floor at height 0 from x = -2 to 6, y = -4 to 4, on which the robot stands at (1, 0.5).
fn floor() -> String {
    a_box([8.0, 8.0, 1.0], [2.0, 0.0, -0.5], "")
}

/// Level ground of this height from x = `from` to 9, y = -4 to 4.
fn beyond(from: f64, height_m: f64) -> String {
    a_box([9.0 - from, 8.0, 1.0], [0.5 * (9.0 + from), 0.0, height_m - 0.5], "")
}

/// A slope that begins at the floor's end and rises for 2 m.
fn ramp(degrees: f64) -> String {
    raised_ramp(degrees, 0.0)
}

/// A slope with a step before it.
fn raised_ramp(degrees: f64, step_m: f64) -> String {
    let rise = 2.0 * degrees.to_radians().tan();
    let shape = format!("ramp = {{ run_m = 2.0, rise_m = {rise}, width_m = 8.0, thickness_m = 0.1 }}");
    object(&shape, [7.0, 0.0, step_m + 0.5 * rise], "")
}

fn truth(objects: &[String], settings: &SafetyRules) -> SafetyTruth {
    let spec = grid([0.0, 10.0], [-2.0, 2.0], [0.0, 1.0], 0.1);
    SafetyTruth::new(&world(objects), spec, &Pose::identity(), 0, settings).unwrap()
}

fn label_at(truth: &SafetyTruth, x: f64, y: f64) -> SafetyLabel {
    truth.labels()[nearest_cell(truth.spec(), [x, y])]
}

/// The labels of the cells at y = 0.05 between two places along x.
fn along(truth: &SafetyTruth, from: f64, to: f64) -> Vec<SafetyLabel> {
    let count = ((to - from) / 0.1).round() as usize;
    (0..count).map(|i| label_at(truth, from + 0.05 + 0.1 * i as f64, 0.05)).collect()
}

#[test]
fn what_lies_behind_the_floor() {
    let rows: &[(&str, Vec<String>, SafetyLabel)] = &[
        ("nothing", vec![], Unknown),
        ("more floor", vec![beyond(6.0, 0.0)], Level),
        ("a slope of 2 degrees", vec![ramp(2.0)], Level),
        ("a slope of 5 degrees", vec![ramp(5.0)], Inclined),
        ("a slope down", vec![ramp(-5.0)], Inclined),
        ("a slope of 9.9 degrees", vec![ramp(9.9)], Inclined),
        ("a slope of 10.1 degrees", vec![ramp(10.1)], NonGround),
        // From centre to centre of the cells it is 5.3 cm, from plane to plane less than 5 cm.
        ("a slope behind a low step", vec![raised_ramp(9.0, 0.045)], Inclined),
        ("a slope behind a step", vec![raised_ramp(9.0, 0.06)], NonGround),
        ("a steep slope", vec![ramp(15.0)], NonGround),
        ("a steep slope down", vec![ramp(-15.0)], NonGround),
        ("a low kerb", vec![beyond(6.0, 0.03)], Level),
        ("a low kerb within a cell", vec![beyond(5.96, 0.03)], Level),
        ("a kerb", vec![beyond(6.0, 0.15)], NonGround),
        ("a kerb within a cell", vec![beyond(5.96, 0.15)], NonGround),
        ("a kerb just too high", vec![beyond(6.0, 0.051)], NonGround),
        ("a small drop", vec![beyond(6.0, -0.03)], Level),
        ("a drop", vec![beyond(6.0, -0.3)], NonGround),
        ("a deep drop", vec![beyond(6.0, -3.0)], NonGround),
        (
            "a bridge over more floor",
            vec![beyond(6.0, 0.0), a_box([2.0, 3.0, 0.4], [7.0, 0.0, 1.5], "")],
            Level,
        ),
        (
            "a bridge that the robot does not fit under",
            vec![beyond(6.0, 0.0), a_box([2.0, 3.0, 0.4], [7.0, 0.0, 1.3], "")],
            NonGround,
        ),
        ("a table", vec![beyond(6.0, 0.0), a_box([2.0, 3.0, 0.05], [7.0, 0.0, 0.72], "")], NonGround),
        ("a wall", vec![beyond(6.0, 0.0), a_box([2.0, 3.0, 2.5], [7.0, 0.0, 1.25], "")], NonGround),
    ];
    for (name, objects, expected) in rows {
        let objects = [vec![floor()], objects.clone()].concat();
        let truth = truth(&objects, &SafetyRules::default());
        assert!(along(&truth, 0.0, 5.9).iter().all(|&label| label == Level), "{name}: the floor");
        let behind = along(&truth, 6.2, 7.8);
        assert!(behind.iter().all(|label| label == expected), "{name}: {behind:?}");
    }
}

#[test]
fn cells_with_an_edge_are_no_ground() {
    let around =
        |end: &[String]| along(&truth(&[&[floor()], end].concat(), &SafetyRules::default()), 5.8, 6.2);
    assert_eq!(around(&[beyond(5.96, 0.15)]), [Level, NonGround, NonGround, NonGround]);
    assert_eq!(around(&[beyond(5.96, 0.03)]), [Level; 4]);
    assert_eq!(around(&[]), [Level, Level, Unknown, Unknown]);
    assert_eq!(around(&[a_box([0.04, 8.0, 1.0], [6.02, 0.0, -0.5], "")]), [Level, Level, Unknown, Unknown]);
    assert_eq!(around(&[a_box([0.06, 8.0, 1.0], [6.03, 0.0, -0.5], "")]), [Level, Level, NonGround, Unknown]);
}

#[test]
fn what_is_behind_something_steep_is_out_of_reach() {
    let top = 2.0 * 15_f64.to_radians().tan();
    let around = truth(&[floor(), ramp(15.0), beyond(8.0, top)], &SafetyRules::default());
    assert!(along(&around, 8.1, 8.9).iter().all(|&label| label == NonGround));
    let top = 2.0 * 8_f64.to_radians().tan();
    let up = truth(&[floor(), ramp(8.0), beyond(8.0, top)], &SafetyRules::default());
    assert!(along(&up, 6.1, 7.9).iter().all(|&label| label == Inclined));
    assert!(along(&up, 8.1, 8.9).iter().all(|&label| label == Level));
}

#[test]
fn small_and_thin_patches_are_unknown_if_they_are_low() {
    let patch = |size: [f64; 2], height_m: f64| {
        let [x, y] = size;
        let on = a_box([x, y, height_m], [3.0 + 0.5 * x, 0.5 * y, 0.5 * height_m], "");
        label_at(&truth(&[floor(), on], &SafetyRules::default()), 3.05, 0.05)
    };
    assert_eq!(patch([0.2, 0.2], 0.03), Unknown);
    // Thin: 20 cells, none of them with all its neighbours.
    assert_eq!(patch([1.0, 0.2], 0.03), Unknown);
    assert_eq!(patch([0.4, 0.4], 0.03), Level);
    // One voxel up they are still looked at, farther up they are not.
    assert_eq!(patch([0.2, 0.2], 0.09), Unknown);
    assert_eq!(patch([0.2, 0.2], 0.4), NonGround);
}

#[test]
fn a_low_step_must_be_wide_enough_to_cross() {
    // More ground behind a gap, and a strip of it that crosses the gap.
    let reach = |width_m: f64, settings: &SafetyRules| {
        let strip = a_box([0.5, width_m, 1.0], [6.25, 0.5 * width_m, 0.03 - 0.5], "");
        label_at(&truth(&[floor(), beyond(6.3, 0.03), strip], settings), 7.55, -1.05)
    };
    let settings = SafetyRules::default();
    // One cell on the strip and the three before it: four. A wider strip by one cell: two and four.
    assert_eq!(reach(0.1, &settings), NonGround);
    assert_eq!(reach(0.2, &settings), Level);
    assert_eq!(reach(0.1, &SafetyRules { min_border_cells: 4, ..settings }), Level);
    assert_eq!(reach(0.2, &SafetyRules { min_border_cells: 7, ..settings }), NonGround);
}

#[test]
fn cells_beyond_the_range_are_unknown() {
    let settings = SafetyRules { max_range_m: Some(4.0), ..SafetyRules::default() };
    let truth = truth(&[floor()], &settings);
    // From (1, 0.5).
    assert_eq!([4.95, 5.05].map(|x| label_at(&truth, x, 0.45)), [Level, Unknown]);
}

#[test]
fn the_labels_follow_the_map_frame() {
    let world = world(&[floor(), beyond(6.0, 0.15)]);
    let spec = grid([0.0, 10.0], [-2.0, 2.0], [0.0, 1.0], 0.1);
    let truth = SafetyTruth::new(&world, spec, &turned_map(), 1, &SafetyRules::default()).unwrap();
    let mut count = [0; 2];
    for (flat, &label) in truth.labels().iter().enumerate() {
        let [x, y] = cell_point(&spec, [flat / 40, flat % 40], [0.5, 0.5]);
        let at = turned_map().inverse() * nalgebra::Point3::new(x, y, 0.0);
        if at.x < 5.9 && at.y.abs() < 3.9 {
            assert_eq!(label, Level, "{at}");
            count[0] += 1;
        } else if (6.1..8.8).contains(&at.x) && at.y.abs() < 3.9 {
            assert_eq!(label, NonGround, "{at}");
            count[1] += 1;
        }
    }
    assert!(count[0] > 2000 && count[1] > 300, "{count:?}");
}

#[test]
fn a_robot_on_an_edge_is_refused() {
    let spec = grid([0.0, 10.0], [-2.0, 2.0], [0.0, 1.0], 0.1);
    let world = world(&[floor(), a_box([2.0, 1.08, 0.2], [1.0, 0.0, 0.1], "")]);
    let settings = SafetyRules::default();
    let on = |frame| SafetyTruth::new(&world, spec, &Pose::identity(), frame, &settings);
    let error = on(0).map(|_| ()).unwrap_err().to_string();
    assert!(error.contains("without an edge in its cell at frame 0"), "{error}");
    assert!(on(2).is_ok());
}
