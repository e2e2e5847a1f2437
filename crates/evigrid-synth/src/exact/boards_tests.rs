use super::super::fixtures::{a_box, world};
use super::*;

fn seen(objects: &[String], frame: usize) -> BoardView {
    let world = world(objects);
    let views = boards(&world, frame, &LeftViewTruth::new(&world, frame));
    assert_eq!(views.len(), 1);
    views[0].clone()
}

/// A board 2 m wide whose front is 7.95 m before the camera of frame 0.
fn board(rest: &str) -> String {
    a_box([0.1, 2.0, 1.5], [9.0, 0.0, 0.75], &format!("board = true; name = \"board\"; {rest}"))
}

/// Width of a pixel on the board.
const PIXEL_M: f64 = 7.95 / 120.0;

#[test]
fn a_board_in_full_view_shows_its_full_width() {
    let floor = a_box([40.0, 40.0, 1.0], [0.0, 0.0, -0.5], "");
    let view = seen(&[floor, board("")], 0);
    assert_eq!((view.thing, view.name.as_deref(), view.width_m), (1, Some("board"), 2.0));
    assert!((view.distance_m - 8.0).abs() < 1e-9);
    for visible in [view.visible_left_m, view.visible_both_m] {
        assert!((visible - 2.0).abs() < PIXEL_M && visible <= 2.0 + 1e-12, "{view:?}");
    }
    assert!((seen(&[board("")], 2).distance_m - 6.0).abs() < 1e-9);
}

#[test]
fn what_stands_before_a_board_hides_its_shadow() {
    // Seen from the left camera at (1, 0.7) and the right one at (1, 0.3), with its edge at y = 0.5.
    let post = a_box([0.1, 3.0, 3.0], [6.0, -1.0, 1.0], "");
    let view = seen(&[board(""), post], 0);
    let left_edge = 0.7 - 0.2 / 5.05 * 7.95;
    let right_edge = 0.3 + 0.2 / 4.95 * 7.95;
    assert!((view.visible_left_m - (1.0 - left_edge)).abs() < PIXEL_M, "{view:?}");
    assert!((view.visible_both_m - (1.0 - right_edge)).abs() < PIXEL_M, "{view:?}");
    assert!(view.visible_both_m < view.visible_left_m - PIXEL_M);
}

#[test]
fn parts_on_both_sides_of_a_post_add_up() {
    let post = a_box([0.1, 0.25, 3.0], [5.0, 0.4, 1.0], "");
    let view = seen(&[board(""), post], 0);
    let [from, to] = [[0.275, 4.05], [0.525, 4.05]].map(|[y, x]| 0.7 + (y - 0.7) / x * 7.95);
    assert!((view.visible_left_m - (2.0 - (to - from))).abs() < 2.0 * PIXEL_M, "{view:?}");
}

#[test]
fn a_board_seen_from_the_side_or_behind_shows_no_width() {
    let across = a_box([2.0, 0.1, 1.5], [7.0, 0.7, 0.75], "board = true");
    let view = seen(&[across], 0);
    assert_eq!((view.width_m, view.visible_left_m), (2.0, 0.0));
    let behind = a_box([0.1, 2.0, 1.5], [-9.0, 0.0, 0.75], "board = true");
    let view = seen(&[behind], 0);
    assert!((view.distance_m + 10.0).abs() < 1e-9 && view.visible_left_m == 0.0);
}

#[test]
fn a_turned_board_that_leaves_the_image() {
    // Its left end is beyond the image, whose border is at -80 / 120 of the depth.
    let turned = a_box([0.02, 6.0, 1.5], [5.0, 3.0, 0.75], "board = true; yaw_deg = 20.0");
    let view = seen(&[turned], 0);
    let (sin, cos) = 20_f64.to_radians().sin_cos();
    // Along the board from its centre at (4, 2.3) before the camera: (4 - s sin) * 2 / 3 = 2.3 + s cos.
    let at_border = (4.0 * 80.0 / 120.0 - 2.3) / (cos + sin * 80.0 / 120.0);
    assert!((view.visible_left_m - (3.0 + at_border)).abs() < 0.06, "{view:?} {at_border}");
}

#[test]
fn unions_count_overlaps_once() {
    assert_eq!(length_of_union(vec![[3.0, 4.0], [0.0, 1.0], [0.5, 2.0], [0.6, 0.7]]), 3.0);
    assert_eq!(length_of_union(Vec::new()), 0.0);
}
