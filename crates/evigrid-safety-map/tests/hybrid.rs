//! The voxels beside the planes, against a count of all voxels one by one.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use evigrid_core::{Pose, View};
use evigrid_grid::{GridSettings, GridSpec, Mapper, SafetyLabel, patches};
use evigrid_safety_map::{SafetyMapSettings, SafetyMapping};

use common::{MOUNTING, floor_and_wall, frame, pose, rig};

/// The disparities of a floor, a wall and a ceiling 0.2 m above the map frame's origin.
fn room(pose: Pose) -> impl Fn(usize, usize) -> f32 {
    let below = floor_and_wall(pose, 3.2);
    move |x, y| {
        let ray = pose.rotation * rig().ray(x as f64, y as f64);
        let to_ceiling = (0.2 - pose.translation.z) / ray.z;
        let ceiling = if ray.z > 0.0 { rig().disparity_px(to_ceiling) as f32 } else { f32::NAN };
        below(x, y).max(ceiling)
    }
}

/// A mapper that has driven up to a wall, below a ceiling that is higher than the robot.
fn driven() -> SafetyMapping {
    let settings = SafetyMapSettings {
        occupied_at: 20,
        radius_m: 2.5,
        robot_height_m: 0.5,
        neighbour_difference_px: 0.0,
        min_disparity_px: 1.2,
        ..SafetyMapSettings::default()
    };
    let grid = GridSettings { x_m: [-1.0, 5.0], y_m: [-2.0, 3.0], z_m: [-1.5, 1.0], cell_size_m: 0.1 };
    let mut mapper = SafetyMapping::new(GridSpec::new(&grid).unwrap(), settings).unwrap();
    for n in 0..30 {
        let pose = pose([0.05 * f64::from(n), 0.02 * f64::from(n % 5), 0.0], 0.0, 0.4);
        let (frame, matching) = frame(n as usize, pose, room(pose));
        mapper.integrate(&View::new(&frame, Some(MOUNTING), &matching)).unwrap();
    }
    mapper
}

#[test]
fn voxels_are_all_that_is_occupied_but_safe_ground() {
    let mapper = driven();
    let (hybrid, model, map) = (mapper.hybrid_model().unwrap(), mapper.model().unwrap(), mapper.map());
    assert_eq!(hybrid.spec, *model.spec());
    let robot_top_m = hybrid.robot_m[2] + hybrid.robot_height_m;
    let expected: Vec<u32> = (0..model.spec().cell_count())
        .filter(|&flat| {
            let centre = model.spec().centre_m(flat);
            let label = map.labels()[map.spec().cell_of([centre[0], centre[1]]).unwrap()];
            let counts = match label {
                SafetyLabel::Level | SafetyLabel::Inclined => centre[2] >= robot_top_m - 1e-9,
                SafetyLabel::NonGround | SafetyLabel::Unknown => true,
                SafetyLabel::Unexamined => false,
            };
            counts && model.is_occupied(flat)
        })
        .map(|flat| flat as u32)
        .collect();
    assert!(expected.len() > 100 && !patches(map).is_empty(), "{}", expected.len());
    assert_eq!(hybrid.voxels, expected);
    let is_safe =
        |flat: &&u32| map.labels()[**flat as usize / model.spec().shape()[2]].is_safe() == Some(true);
    assert!(expected.iter().filter(is_safe).count() > 10, "the ceiling hangs over safe ground");
}

#[test]
fn the_robot_stands_on_its_floor() {
    let hybrid = driven().hybrid_model().unwrap();
    let expected = [0.05 * 29.0, 0.02 * 4.0, -1.0];
    assert!((0..3).all(|a| (hybrid.robot_m[a] - expected[a]).abs() < 1e-9), "{:?}", hybrid.robot_m);
}

#[test]
fn there_is_no_model_before_the_first_frame() {
    let grid = GridSpec::new(&GridSettings::default()).unwrap();
    let mapper = SafetyMapping::new(grid, SafetyMapSettings::default()).unwrap();
    assert!(mapper.hybrid_model().is_none());
}

#[test]
fn segments_are_those_that_the_map_was_made_of() {
    let mapper = driven();
    let (map, columns, segments) = (mapper.map(), mapper.columns(), mapper.segments().unwrap());
    let planes: Vec<_> = segments.list.iter().filter_map(|own| own.plane).map(|p| p.by_normal()).collect();
    assert!(!planes.is_empty());
    assert_eq!(map.planes(), planes);
    for segment in &segments.list {
        let first = segment.cells[0] as usize;
        let as_first = |&cell: &u32| {
            let cell = cell as usize;
            (columns.height(cell), map.labels()[cell]) == (columns.height(first), map.labels()[first])
        };
        assert!(columns.height(first).is_some() && segment.cells.iter().all(as_first));
    }
}
