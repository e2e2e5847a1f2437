//! Views from which nothing can be learned: nothing panics, and the map says that it does not know.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use evigrid_core::View;
use evigrid_grid::{Mapper, Method, SafetyLabel};
use evigrid_safety_map::{SafetyMapSettings, SafetyMapping};

use common::{MOUNTING, floor_and_wall, frame, grid, pose};

/// Maps ten slightly different frames.
fn mapped(
    settings: SafetyMapSettings,
    at: [f64; 3],
    disparity: impl Fn(usize, usize) -> f32,
) -> SafetyMapping {
    let mut mapper = SafetyMapping::new(grid(), settings).unwrap();
    for n in 0..30 {
        let (frame, matching) = frame(n, pose([at[0] + 0.01 * n as f64, at[1], at[2]], 0.0, 0.4), &disparity);
        mapper.integrate(&View::new(&frame, Some(MOUNTING), &matching)).unwrap();
    }
    mapper
}

fn knows_nothing(mapper: &SafetyMapping) -> bool {
    mapper.map().labels().iter().all(|label| label.is_safe().is_none())
}

#[test]
fn no_points_at_all() {
    assert!(knows_nothing(&mapped(SafetyMapSettings::default(), [0.0; 3], |_, _| f32::NAN)));
}

#[test]
fn all_points_in_one_voxel() {
    let one = |x: usize, y: usize| if (x, y) == (15, 20) { 4.0 } else { f32::NAN };
    let settings = SafetyMapSettings { neighbour_difference_px: 0.0, ..SafetyMapSettings::default() };
    assert!(knows_nothing(&mapped(settings, [0.0; 3], one)));
}

#[test]
fn a_robot_outside_of_the_map() {
    let far = pose([50.0, 80.0, 0.0], 0.0, 0.4);
    let mapper = mapped(SafetyMapSettings::default(), [50.0, 80.0, 0.0], floor_and_wall(far, 53.0));
    assert!(mapper.map().labels().iter().all(|&label| label == SafetyLabel::Unexamined));
}

/// The robot drives 2 m above everything that it sees.
#[test]
fn no_ground_in_reach() {
    let wall_alone = |x: usize, _: usize| if x.is_multiple_of(2) { 3.5 } else { f32::NAN };
    let mapper = mapped(SafetyMapSettings::default(), [0.0, 0.0, 3.0], wall_alone);
    assert!(knows_nothing(&mapper));
}

#[test]
fn no_evidence_against_anything() {
    let at = pose([0.0; 3], 0.0, 0.4);
    let settings = SafetyMapSettings { decrement: 0, ..SafetyMapSettings::default() };
    let mapper = mapped(settings, [0.0; 3], floor_and_wall(at, 2.5));
    assert!(mapper.map().labels().contains(&SafetyLabel::Level));
}

/// A standing robot adds nothing, however long it stands.
#[test]
fn frames_of_a_standing_robot_are_dropped() {
    let at = pose([0.0; 3], 0.0, 0.4);
    let (frame, matching) = frame(0, at, floor_and_wall(at, 2.5));
    let view = View::new(&frame, Some(MOUNTING), &matching);
    let mut mapper = SafetyMapping::new(grid(), SafetyMapSettings::default()).unwrap();
    mapper.integrate(&view).unwrap();
    let once = mapper.model().unwrap().evidence().to_vec();
    (0..5).for_each(|_| mapper.integrate(&view).unwrap());
    assert_eq!(mapper.model().unwrap().evidence(), once);
}

#[test]
fn a_camera_that_stands_nowhere_is_refused() {
    let at = pose([0.0; 3], 0.0, 0.4);
    let (frame, matching) = frame(0, at, |_, _| f32::NAN);
    let mut mapper = SafetyMapping::new(grid(), SafetyMapSettings::default()).unwrap();
    let error = mapper.integrate(&View::new(&frame, None, &matching)).unwrap_err();
    assert!(error.to_string().contains("mounting"), "{error}");
    const { assert!(SafetyMapping::NEEDS.mounting) };
}

#[test]
fn settings_outside_of_their_domain_are_refused() {
    let refuse = |settings: SafetyMapSettings| {
        SafetyMapping::new(grid(), settings).err().map(|e| e.to_string()).unwrap_or_default()
    };
    let d = SafetyMapSettings::default();
    assert!(refuse(SafetyMapSettings { decrement: -1, ..d }).contains("safety-map.decrement"));
    assert!(refuse(SafetyMapSettings { radius_m: f64::NAN, ..d }).contains("radius_m"));
    assert!(refuse(SafetyMapSettings { points_per_voxel: 0, ..d }).contains("points_per_voxel"));
    assert!(refuse(SafetyMapSettings { max_slope_deg: 91.0, ..d }).contains("max_slope_deg"));
    assert!(refuse(SafetyMapSettings { max_slope_deg: 90.0, ..d }).is_empty());
}

/// Evidence stops at the ends of its type instead of turning round.
#[test]
fn evidence_never_overflows() {
    let at = pose([0.013, 0.017, 0.0], 0.0, 0.4);
    let (_, matching) = frame(0, at, floor_and_wall(at, 2.5));
    let most = SafetyMapSettings {
        increment_hit: 10_000,
        decrement: 10_000,
        min_disparity_px: 1.2,
        ..SafetyMapSettings::default()
    };
    let mut model = evigrid_safety_map::Model::new(grid(), most);
    for _ in 0..30_000 {
        model.update(&common::rig(), &at, matching.matches.disparity.values());
    }
    let (low, high) = (model.evidence().iter().min(), model.evidence().iter().max());
    assert_eq!(low, Some(&i32::MIN));
    assert!(high.is_some_and(|&high| high > 0), "{high:?}");
    // The camera's own voxel is passed by every ray and hit by none.
    assert_eq!(model.evidence()[grid().cell_of([0.013, 0.017, 0.0]).unwrap()], i32::MIN);
}
