//! What `safety-map-plus` adds, each addition alone, on height maps made by hand. Cells are 0.1 m wide.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use evigrid_grid::{GridSpec, Method, Moments, Plane, SafetyLabel, SafetyMap};
use evigrid_safety_map::{
    Columns, Model, Robot, SafetyMapPlusSettings, SafetyMapSettings, SafetyMappingPlus, label_columns,
};
use proptest::prelude::*;

use common::{FLOOR, ROBOT, labelled, surface};

fn paper() -> SafetyMapSettings {
    SafetyMapSettings::default()
}

fn at(map: &SafetyMap, x: f64, y: f64) -> SafetyLabel {
    map.labels()[map.spec().cell_of([x, y]).unwrap()]
}

proptest! {
    /// The distance of points from a plane by its definition.
    #[test]
    fn distances_from_planes(
        p in [-1.0..1.0_f64, -1.0..1.0, -2.0..2.0],
        points in prop::collection::vec([-2.0..2.0_f64, -2.0..2.0, -2.0..2.0], 1..20),
    ) {
        let plane = Plane { p1: p[0], p2: p[1], p3: p[2] };
        let mut moments = Moments::default();
        points.iter().for_each(|&point| moments.add(point));
        let squares = points.iter().map(|q| (q[2] - plane.height_m([q[0], q[1]])).powi(2));
        let expected = (squares.sum::<f64>() / points.len() as f64).sqrt();
        prop_assert!((moments.distance_m(&plane) - expected).abs() < 1e-9);
    }
}

/// A ramp of 6 degrees rises through several layers: one segment when joined, and the floor stays another.
#[test]
fn the_strips_of_a_ramp_become_one_plane() {
    let ramp = |[x, _]: [f64; 2]| (x - 0.5_f64).max(0.0) * 6.0_f64.to_radians().tan();
    let strips = labelled(&paper(), ramp);
    assert!(strips.planes().len() >= 3, "{}", strips.planes().len());
    let joined = labelled(&SafetyMapSettings { merge_m: 0.01, ..paper() }, ramp);
    assert_eq!(joined.planes().len(), 2);
    assert_eq!((at(&joined, 0.0, 0.0), at(&joined, 1.8, 0.0)), (SafetyLabel::Level, SafetyLabel::Inclined));
    let slope = joined.plane_of(joined.spec().cell_of([1.8, 0.0]).unwrap()).unwrap().normal.z.acos();
    assert!((slope.to_degrees() - 6.0).abs() < 1e-6, "{}", slope.to_degrees());
}

/// A platform of 7 cm lies on another plane than the floor, however many points the floor has.
#[test]
fn a_step_is_not_joined() {
    let step = |[x, _]: [f64; 2]| if x > 1.0 { 0.10 } else { 0.03 };
    let joined = labelled(&SafetyMapSettings { merge_m: 0.01, ..paper() }, step);
    assert_eq!(joined.planes().len(), 2);
    assert_eq!(at(&joined, 1.5, 0.0), SafetyLabel::NonGround);
}

/// The foot of a ramp is as high as the floor but for half a voxel. Its cells go over to the ramp once they fit it
/// better by the limit, so that both planes are exact.
#[test]
fn the_foot_of_a_ramp_belongs_to_the_ramp() {
    let ramp = |[x, _]: [f64; 2]| (x - 0.5_f64).max(0.0) * 6.0_f64.to_radians().tan();
    let joined = SafetyMapSettings { merge_m: 0.01, ..paper() };
    assert_eq!(at(&labelled(&joined, ramp), 0.85, 0.0), SafetyLabel::Level);
    let map = labelled(&SafetyMapSettings { reassign_cells: true, ..joined }, ramp);
    assert_eq!((at(&map, 0.45, 0.0), at(&map, 0.85, 0.0)), (SafetyLabel::Level, SafetyLabel::Inclined));
    let slopes: Vec<f64> = map.planes().iter().map(|plane| plane.normal.z.acos().to_degrees()).collect();
    assert!(slopes.len() == 2 && slopes[0] < 0.1 && (slopes[1] - 6.0).abs() < 0.05, "{slopes:?}");
}

/// Neither the cells of a floor nor those of a platform of 7 cm go over to the other.
#[test]
fn cells_stay_on_their_side_of_a_step() {
    let step = |[x, _]: [f64; 2]| if x > 1.0 { 0.10 } else { 0.03 };
    let settings = SafetyMapSettings { merge_m: 0.01, ..paper() };
    let reassigned = SafetyMapSettings { reassign_cells: true, ..settings };
    let [cut, held] = [settings, reassigned].map(|settings| labelled(&settings, step));
    assert!(cut.labels() == held.labels() && cut.plane_numbers() == held.plane_numbers());
}

/// Points count as much as there is evidence of their voxel, or all alike.
#[test]
fn points_are_weighted_by_evidence() {
    for weigh_points in [false, true] {
        // Fewer than there are frames, so that points leave their lists again.
        let settings = SafetyMapSettings { occupied_at: 20, points_per_voxel: 3, weigh_points, ..paper() };
        let (spec, mut model) = (common::grid(), Model::new(common::grid(), settings));
        for n in 0..6 {
            let pose = common::pose([0.02 * f64::from(n), 0.0, 0.0], 0.0, 0.5);
            let (frame, matching) = common::frame(0, pose, common::floor_and_wall(pose, 2.5));
            model.update(frame.rig(), &pose, matching.matches.disparity.values());
        }
        let mut columns = Columns::none(spec.plan());
        model.columns(&Robot { at_m: [0.0, 0.0], floor_m: -1.0 }, &mut columns);
        let (layers, mut seen) = (spec.shape()[2], 0);
        for cell in columns.examined() {
            let Some(column) = columns.get(cell) else { continue };
            let mut expected = [0.0; 2];
            for voxel in (0..=column.height as usize).map(|layer| cell * layers + layer) {
                let evidence = f64::from(model.evidence()[voxel]);
                let weight = if weigh_points { evidence / 20.0 } else { 1.0 };
                for point in model.points(voxel).filter(|_| evidence >= 20.0) {
                    expected[0] += weight;
                    expected[1] += weight * point[2] * point[0];
                }
            }
            let found = [column.moments.count, column.moments.products[3]];
            assert!((0..2).all(|n| (found[n] - expected[n]).abs() < 1e-9), "{found:?} {expected:?}");
            seen += 1;
        }
        assert!(seen > 50, "{seen}");
    }
}

/// A gap of 0.3 m from x = 1 m on, then ground 0.5 m lower. What was seen through at the height of the floor is
/// a hole, as far as it was; the rest stays unknown.
#[test]
fn empty_columns_that_were_seen_through_are_holes() {
    let columns = surface(|[x, _]| match x {
        _ if x > 1.3 => -0.5,
        _ if x > 1.0 => f64::NAN,
        _ => 0.0,
    });
    let settings = SafetyMapSettings { hole_at: 10, ..paper() };
    // Seen through at the floor's height alone, and only on the left.
    let spec = *columns.spec();
    let is_free = |cell: usize, height_m: f64| height_m.abs() < 0.02 && spec.centre_m(cell)[1] > 0.0;
    let map = label_columns(&columns, &ROBOT, FLOOR, &settings, &is_free);
    assert_eq!((at(&map, 1.05, 0.5), at(&map, 1.25, 0.5)), (SafetyLabel::NonGround, SafetyLabel::NonGround));
    assert_eq!(at(&map, 1.15, -0.5), SafetyLabel::Unknown);
    assert_eq!((at(&map, 0.95, 0.5), at(&map, 1.5, 0.5)), (SafetyLabel::Level, SafetyLabel::NonGround));
    // Without the rule nothing of it is known.
    let map = label_columns(&columns, &ROBOT, FLOOR, &paper(), &is_free);
    assert_eq!(at(&map, 1.05, 0.5), SafetyLabel::Unknown);
}

/// The cell before a hole or before lower unsafe ground is an edge; that before a wall is not.
#[test]
fn edges_hang_over_a_drop() {
    let settings = SafetyMapSettings { edges_unsafe: true, ..paper() };
    let map = labelled(&settings, |[x, _]| match x {
        _ if x > 1.0 => -0.5,
        _ if x < -1.0 => 1.0,
        _ => 0.0,
    });
    assert_eq!((at(&map, 0.95, 0.0), at(&map, 0.85, 0.0)), (SafetyLabel::NonGround, SafetyLabel::Level));
    assert_eq!(at(&map, -0.95, 0.0), SafetyLabel::Level);
}

/// Unknown cells inside of a ring of obstacles cannot be reached; those behind a wall with a gap can.
#[test]
fn enclosed_cells_are_unsafe() {
    let ring = |gap: bool| {
        let settings = SafetyMapSettings { enclosed_unsafe: true, ..paper() };
        let map = labelled(&settings, move |[x, y]| match (x - 1.2).abs().max(y.abs()) {
            away if away < 0.3 => f64::NAN,
            away if away < 0.5 && !(gap && x < 1.2 && y.abs() < 0.1) => 1.0,
            _ => 0.0,
        });
        at(&map, 1.2, 0.0)
    };
    assert_eq!((ring(false), ring(true)), (SafetyLabel::NonGround, SafetyLabel::Unknown));
}

/// Its settings are a section like any other, and go back and forth unchanged.
#[test]
fn settings_of_the_variant() {
    let settings = SafetyMapPlusSettings::default();
    assert!(SafetyMappingPlus::check(&settings).is_ok());
    let spec: GridSpec = common::grid();
    let wrong = SafetyMapPlusSettings(SafetyMapSettings { merge_m: -1.0, ..settings.0 });
    let error = SafetyMappingPlus::build(spec, &wrong).err().unwrap().to_string();
    assert!(error.starts_with("safety-map-plus.merge_m"), "{error}");
}
