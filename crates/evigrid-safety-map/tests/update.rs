//! The 3-D model against a slow twin, and a grid that scrolls against one that stands.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeMap;

use evigrid_core::{MatchFilter, MatchLimits, Matches, Matching, Pose, View};
use evigrid_grid::{GridSpec, Mapper};
use evigrid_safety_map::{Model, Readings, SafetyMapSettings, SafetyMapping};
use nalgebra::Point3;
use proptest::prelude::*;

use common::{MOUNTING, floor_and_wall, frame, grid, pose, rig};

/// Evidence by the definition alone: every voxel is asked whether the segment from the camera to the point
/// passes through it, and where.
struct Twin {
    spec: GridSpec,
    evidence: Vec<i32>,
    points: BTreeMap<usize, Vec<(f64, [f64; 3])>>,
}

impl Twin {
    fn update(&mut self, map_from_left: Pose, matching: &Matching, s: &SafetyMapSettings) {
        let rig = rig();
        let camera: [f64; 3] = map_from_left.translation.vector.into();
        let mut seen = Vec::new();
        for y in 0..rig.height {
            for x in 0..rig.width {
                let d = f64::from(matching.matches.disparity.values()[y * rig.width + x]);
                if d.is_nan() || d < s.min_disparity_px {
                    continue;
                }
                let point = map_from_left * Point3::from(rig.ray(x as f64, y as f64) * rig.depth_m(d));
                let point: [f64; 3] = point.into();
                let Some(voxel) = self.spec.cell_of(point) else { continue };
                if seen.contains(&voxel) {
                    continue;
                }
                seen.push(voxel);
                self.ray(camera, point, voxel, s);
                let distance = (0..3).map(|a| (point[a] - camera[a]).powi(2)).sum::<f64>().sqrt();
                let list = self.points.entry(voxel).or_default();
                list.push((distance, point));
                list.sort_by(|a, b| a.0.total_cmp(&b.0));
                list.truncate(s.points_per_voxel);
            }
        }
    }

    fn ray(&mut self, camera: [f64; 3], point: [f64; 3], hit: usize, s: &SafetyMapSettings) {
        // Parameter 0 at the camera, 1 at the point; the ray goes on behind it.
        let mut passed: Vec<(f64, usize)> = (0..self.spec.cell_count())
            .filter_map(|voxel| {
                let (low, c) = (self.spec.voxel(voxel), self.spec.cell_size_m());
                let (mut enter, mut leave) = (0.0_f64, 3.0_f64);
                for a in 0..3 {
                    let corner = self.spec.origin_m()[a] + low[a] as f64 * c;
                    let inverse = 1.0 / (point[a] - camera[a]);
                    let (t, u) = ((corner - camera[a]) * inverse, (corner + c - camera[a]) * inverse);
                    (enter, leave) = (enter.max(t.min(u)), leave.min(t.max(u)));
                }
                (enter < leave).then_some((enter, voxel))
            })
            .collect();
        passed.sort_by(|a, b| a.0.total_cmp(&b.0));
        let place = passed.iter().position(|&(_, voxel)| voxel == hit).unwrap();
        for (n, &(_, voxel)) in passed.iter().enumerate() {
            self.evidence[voxel] += match n {
                _ if n == place => s.increment_hit,
                _ if n + 1 == place || n == place + 1 => s.increment_beside,
                _ if n < place => -s.decrement,
                _ => 0,
            };
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(12))]
    #[test]
    fn evidence_and_points_of_the_twin(
        at in prop::collection::vec([-0.3..0.3_f64, -0.3..0.3, -0.2..0.2], 3),
        (yaw, tilt, wall) in (-0.5..0.5_f64, 0.05..0.6_f64, 1.5..4.0_f64),
        points_per_voxel in 1..4_usize,
    ) {
        let settings = SafetyMapSettings { points_per_voxel, decrement: 3, min_disparity_px: 1.2, ..SafetyMapSettings::default() };
        // The floor is on no face of a voxel, where rounding would decide.
        let spec = grid().raised(0.033);
        let mut model = Model::new(spec, settings);
        let mut twin = Twin { spec, evidence: vec![0; spec.cell_count()], points: BTreeMap::new() };
        for (n, at) in at.into_iter().enumerate() {
            let pose = pose(at, yaw + 0.1 * n as f64, tilt);
            let (_, matching) = frame(n, pose, floor_and_wall(pose, wall));
            model.update(&rig(), &pose, matching.matches.disparity.values());
            twin.update(pose, &matching, &settings);
        }
        prop_assert!(twin.points.len() > 50, "{}", twin.points.len());
        let differs = (0..spec.cell_count()).find(|&n| model.evidence()[n] != twin.evidence[n]);
        prop_assert_eq!(differs, None);
        for voxel in 0..spec.cell_count() {
            let expected = twin.points.get(&voxel).map_or(&[][..], Vec::as_slice);
            let found: Vec<[f64; 3]> = model.points(voxel).collect();
            prop_assert_eq!(found.len(), expected.len());
            for (found, (_, expected)) in found.iter().zip(expected) {
                prop_assert!((0..3).all(|a| (found[a] - expected[a]).abs() < 1e-6));
            }
        }
    }
}

/// Drives through 6 m of a corridor with a grid that holds all of it, and with one that moves along.
#[test]
fn a_scrolling_grid_shows_the_same_map() {
    let settings = SafetyMapSettings {
        occupied_at: 20,
        radius_m: 1.5,
        neighbour_difference_px: 0.0,
        ..SafetyMapSettings::default()
    };
    let wide = evigrid_grid::GridSettings {
        x_m: [-4.0, 12.0],
        y_m: [-4.0, 5.0],
        z_m: [-1.5, 1.5],
        cell_size_m: 0.1,
    };
    let narrow = evigrid_grid::GridSettings { x_m: [-4.0, 6.0], y_m: [-4.0, 4.0], ..wide };
    let of = |grid, scroll| {
        SafetyMapping::new(GridSpec::new(&grid).unwrap(), SafetyMapSettings { scroll, ..settings }).unwrap()
    };
    let (mut fixed, mut scrolling) = (of(wide, false), of(narrow, true));
    let mut classified = 0;
    for n in 0..60 {
        let pose = pose([0.1 * f64::from(n), 0.02 * f64::from(n % 5), 0.0], 0.0, 0.5);
        let wall = pose.translation.x + 3.0;
        let (frame, matching) = frame(n as usize, pose, floor_and_wall(pose, wall));
        let view = View::new(&frame, Some(MOUNTING), &matching);
        fixed.integrate(&view).unwrap();
        scrolling.integrate(&view).unwrap();
        let (a, b) = (fixed.map(), scrolling.map());
        assert_eq!(b.spec().shape(), [100, 80]);
        for flat in 0..b.labels().len() {
            let other = a.spec().cell_of(b.spec().centre_m(flat)).unwrap();
            assert_eq!(b.labels()[flat], a.labels()[other], "frame {n}, {:?}", b.spec().centre_m(flat));
            classified += usize::from(b.labels()[flat].is_safe().is_some());
        }
        let (a, b) = (fixed.model().unwrap(), scrolling.model().unwrap());
        for flat in 0..b.evidence().len() {
            let other = a.spec().cell_of(b.spec().centre_m(flat)).unwrap();
            let at = b.spec().centre_m(flat);
            assert_eq!(b.evidence()[flat], a.evidence()[other], "frame {n}, {at:?}");
        }
    }
    assert!(classified > 1000, "{classified}");
    assert!((scrolling.map().spec().origin_m()[0] - 1.9).abs() < 1e-9);
}

proptest! {
    /// Outliers by counting the neighbours of every pixel.
    #[test]
    fn outliers_of_the_twin(
        disparities in prop::collection::vec(prop_oneof![Just(f32::NAN), 0.0..6.0_f32], 7 * 5),
        limit_px in prop_oneof![Just(0.0), Just(1.0)],
    ) {
        let (width, height) = (7_i64, 5_i64);
        let image = evigrid_core::Disparity::new(7, 5, disparities.clone()).unwrap();
        let matches = Matches::from_disparity(image);
        let limits = MatchLimits::left_right(None);
        let mut readings = Readings::default();
        let found = readings.fill(&MatchFilter::new(&matches, &limits), 7, 5, limit_px).to_vec();
        let at = |x: i64, y: i64| {
            let inside = (0..width).contains(&x) && (0..height).contains(&y);
            Some(disparities[(y * width + x) as usize * usize::from(inside)]).filter(|d| inside && !d.is_nan())
        };
        for y in 0..height {
            for x in 0..width {
                let offsets = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy)));
                let others: Vec<f32> = offsets
                    .filter(|&offset| offset != (0, 0))
                    .filter_map(|(dx, dy)| at(x + dx, y + dy))
                    .collect();
                let expected = at(x, y).filter(|own| {
                    let near = others.iter().filter(|d| (*d - own).abs() <= limit_px as f32).count();
                    limit_px == 0.0 || (near > 0 && 2 * near >= others.len())
                });
                let found = found[(y * width + x) as usize];
                prop_assert_eq!(expected, Some(found).filter(|d| *d >= 0.0), "pixel {} {}", x, y);
            }
        }
    }
}
