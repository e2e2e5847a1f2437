//! The methods on views that lack something, and on some whose every number is known.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::{
    Disparity, DisparityPlane, Frame, GrayImage, GroundPlane, Matches, Matching, Mounting, Pose, RoadSplit,
    StereoRig, View, level_camera,
};
use evigrid_grid::{GridSettings, GridSpec, Mapper, Method};
use evigrid_udisparity::{FilterForm, Ternary, Visibility, VisibilitySettings};
use nalgebra::Translation3;

const RIG: StereoRig = StereoRig {
    width: 96,
    height: 64,
    focal_px: 80.0,
    centre_x_px: 47.5,
    centre_y_px: 20.0,
    baseline_m: 0.3,
};
/// The camera 1.2 m over the ground, level.
const MOUNTING: Mounting = Mounting::over_middle(1.2, 0.0);

fn grid() -> GridSpec {
    let settings = GridSettings { x_m: [0.0, 12.0], y_m: [-6.0, 6.0], z_m: [-1.2, 0.8], cell_size_m: 0.25 };
    GridSpec::new(&settings).unwrap()
}

fn ground() -> DisparityPlane {
    GroundPlane::below(&MOUNTING).disparities(&RIG)
}

fn frame(index: usize, stamp_ns: i64, at_m: [f64; 3]) -> Frame {
    let grey = || GrayImage::new(RIG.width, RIG.height, vec![100; RIG.width * RIG.height]).unwrap();
    let pose = Pose::from_parts(Translation3::from(at_m), level_camera());
    Frame::new(index, stamp_ns, RIG, grey(), grey(), pose, None).unwrap()
}

/// Disparities by column and row: of obstacles, and of the road; 0: none.
fn matching(
    obstacle: impl Fn(usize, usize) -> f32,
    road: impl Fn(usize, usize) -> f32,
    tried: usize,
) -> Matching {
    let image = |of: &dyn Fn(usize, usize) -> f32| {
        let value =
            |n: usize| Some(of(n % RIG.width, n / RIG.width)).filter(|d| *d > 0.0).unwrap_or(f32::NAN);
        Disparity::new(RIG.width, RIG.height, (0..RIG.width * RIG.height).map(value).collect()).unwrap()
    };
    let all = image(&|x, y| obstacle(x, y).max(road(x, y)));
    let road =
        RoadSplit { obstacles: image(&obstacle), road: image(&road), ground: ground(), tried: 0..tried };
    Matching { road: Some(road), ..Matching::from(Matches::from_disparity(all)) }
}

fn of_ground(_: usize, y: usize) -> f32 {
    ground().at(0.0, y as f64).max(0.0) as f32
}

fn nothing(_: usize, _: usize) -> f32 {
    0.0
}

fn wall(_: usize, _: usize) -> f32 {
    4.0
}

/// The plan of a method after one frame at the origin.
fn plan(mapper: &mut dyn Mapper, matching: &Matching) -> Vec<f32> {
    let frame = frame(0, 0, [0.0; 3]);
    mapper.integrate(&View::new(&frame, Some(MOUNTING), matching)).unwrap();
    mapper.layers()[0].plan().unwrap().probabilities().to_vec()
}

fn visibility() -> Visibility {
    Visibility::new(grid(), VisibilitySettings::default()).unwrap()
}

#[test]
fn without_any_reading_nothing_is_known() {
    let mut ternary = Ternary::build(grid(), &Default::default()).unwrap();
    for mapper in [&mut visibility() as &mut dyn Mapper, ternary.as_mut()] {
        let plan = plan(mapper, &matching(nothing, nothing, 33));
        assert!(plan.iter().all(|p| p.is_nan() || (p - 0.5).abs() < 1e-4));
    }
}

#[test]
fn road_alone_is_free_and_obstacles_alone_are_occupied() {
    let spec = grid().plan();
    let at = |plan: &[f32], x: f64, y: f64| plan[spec.cell_of([x, y]).unwrap()];
    let road = plan(&mut visibility(), &matching(nothing, of_ground, 33));
    // 24 / 6 = 4 px.
    assert!(at(&road, 6.1, 0.1) < 0.1, "{}", at(&road, 6.1, 0.1));
    // A wall all over, 6 m ahead.
    let walls = plan(&mut visibility(), &matching(wall, nothing, 33));
    assert!(at(&walls, 6.1, 0.1) > 0.75 && at(&walls, 3.0, 0.1) < 0.3);
    assert!((at(&walls, 10.5, 0.1) - 0.5).abs() < 0.1, "nothing is seen behind it");
    // Beside the camera's image, and nearer than the largest disparity shows.
    assert!(at(&walls, 1.0, 5.0).is_nan() && at(&walls, 0.3, 0.1).is_nan());
}

#[test]
fn what_is_nearer_than_the_disparities_that_were_tried_is_not_known() {
    // Up to 6 px: nothing nearer than 24 / 6.5 = 3.7 m.
    let plan = plan(&mut visibility(), &matching(wall, nothing, 7));
    let spec = grid().plan();
    assert!(plan[spec.cell_of([3.4, 0.1]).unwrap()].is_nan());
    assert!(plan[spec.cell_of([3.9, 0.1]).unwrap()] < 0.4);
    let frame = frame(0, 0, [0.0; 3]);
    let none = matching(nothing, nothing, 1);
    let error = visibility().integrate(&View::new(&frame, None, &none)).unwrap_err().to_string();
    assert_eq!(error, "disparities: expected at least 1 px, found 0 to 0");
}

#[test]
fn a_camera_that_sees_no_ground_knows_of_none() {
    let mut above = matching(nothing, nothing, 33);
    // The horizon lies far below the image.
    let up = GroundPlane::below(&Mounting::over_middle(1.2, -1.0)).disparities(&RIG);
    above.road.as_mut().unwrap().ground = up;
    let plan = plan(&mut visibility(), &above);
    assert!(plan.iter().all(|p| p.is_nan() || (p - 0.5).abs() < 1e-4));
}

#[test]
fn views_that_cannot_be_mapped_are_refused() {
    let (frame, mut map) = (frame(0, 0, [0.0; 3]), visibility());
    let bare = Matching::from(matching(nothing, nothing, 33).matches);
    let error = map.integrate(&View::new(&frame, None, &bare)).unwrap_err().to_string();
    assert_eq!(error, "expected road and obstacles apart, found none");
    let mut upside_down = matching(nothing, nothing, 33);
    upside_down.road.as_mut().unwrap().ground.per_row = -0.2;
    let error = map.integrate(&View::new(&frame, None, &upside_down)).unwrap_err().to_string();
    assert!(error.starts_with("ground: expected disparities that grow downwards"), "{error}");
}

#[test]
fn a_frame_out_of_order_leaves_the_filtered_map_as_it_is() {
    let settings = VisibilitySettings { filter: FilterForm::MassConserving, ..Default::default() };
    let mut map = Visibility::new(grid(), settings).unwrap();
    let walls = matching(wall, nothing, 33);
    let first = frame(0, 1_000_000_000, [0.0; 3]);
    map.integrate(&View::new(&first, None, &walls)).unwrap();
    let bits = |map: &Visibility| {
        let now = map.layers()[0].plan().unwrap().probabilities().to_vec();
        now.into_iter().map(f32::to_bits).collect::<Vec<u32>>()
    };
    let before = bits(&map);
    // The time stands still, and it runs back; the camera has moved on.
    for stamp in [1_000_000_000, 900_000_000] {
        let late = frame(1, stamp, [1.0, 0.0, 0.0]);
        let error = map.integrate(&View::new(&late, None, &walls)).unwrap_err().to_string();
        assert!(error.starts_with("time stamp of a filtered frame"), "{error}");
        assert_eq!(bits(&map), before);
    }
    let next = frame(1, 1_100_000_000, [1.0, 0.0, 0.0]);
    map.integrate(&View::new(&next, None, &walls)).unwrap();
    assert!(map.layers()[0].plan().unwrap().velocities().is_some());
}

#[test]
fn the_plan_rolls_and_its_cells_stay_in_the_map() {
    let walls = matching(wall, nothing, 33);
    let mut map = visibility();
    for (n, x) in [0.0, 0.8, 1.3].into_iter().enumerate() {
        let frame = frame(n, n as i64 * 100_000_000, [x, 0.0, 0.0]);
        map.integrate(&View::new(&frame, None, &walls)).unwrap();
        let layers = map.layers();
        let [centre_x, _] = layers[0].plan().unwrap().centre_in_map_m(0);
        // Whole cells from the first place, as near to the camera's as they come.
        let moved = (centre_x - 0.125) / 0.25;
        assert!((moved - moved.round()).abs() < 1e-9 && (moved - x / 0.25).abs() <= 0.5 + 1e-9);
    }
}

/// A frame that shows other ground makes the grid that a new map would make of it.
#[test]
fn ground_that_changes_is_followed() {
    let road = matching(nothing, of_ground, 33);
    let mut tilted = matching(wall, nothing, 33);
    tilted.road.as_mut().unwrap().ground =
        GroundPlane::below(&Mounting::over_middle(1.4, 0.1)).disparities(&RIG);
    let fresh = plan(&mut visibility(), &tilted);
    let mut map = visibility();
    for matching in [&road, &tilted] {
        let last = plan(&mut map, matching);
        let same = last.iter().zip(&fresh).all(|(a, b)| a.to_bits() == b.to_bits());
        assert_eq!(same, std::ptr::eq(matching, &tilted));
    }
}
