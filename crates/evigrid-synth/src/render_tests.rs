use std::collections::BTreeMap;

use nalgebra::Point3;

use super::*;
use crate::World;

const BOX: &str = include_str!("../tests/box.toml");

/// Greys that the left and the right camera of a frame see at the projections of a world point; `None` where
/// it is outside an image or hidden from a camera.
fn greys_of_point(world: &World, frame: usize, point: &Point3<f64>) -> Option<(f32, f32)> {
    let world_from_left = world.true_world_from_left(frame);
    let scene = world.scene(frame);
    let in_left = world_from_left.inverse_transform_point(point);
    let (x, y) = world.rig.project(&in_left)?;
    let right_x = x - world.rig.disparity_px(in_left.z);
    let inside = |x: f64| x >= 0.0 && x <= (world.rig.width - 1) as f64;
    let seen = |camera: &Camera, x: f64| {
        let (ray, _) = camera.ray(x, y);
        let hit = scene.cast(&ray, FAR_M, &mut Hint::default())?;
        ((ray.at(hit.range_m) - point).norm() < 1e-4).then_some(())
    };
    let (left, right) =
        (Camera::left(world.rig, &world_from_left), Camera::right(world.rig, &world_from_left));
    (inside(x) && inside(right_x)).then_some(())?;
    seen(&left, x)?;
    seen(&right, right_x)?;
    let renderer = Renderer::new(&scene, &world.materials, &world.light);
    let grey = |camera: &Camera, x: f64| {
        let tiles = Tiles::new(&scene, camera);
        let candidates = tiles.around(x.round() as usize, y.round() as usize);
        renderer.sample(camera, x, y, candidates, &mut Hint::default()).grey
    };
    Some((grey(&left, x), grey(&right, right_x)))
}

#[test]
fn both_cameras_see_the_same_grey_at_a_point_of_the_box() {
    let world = World::from_toml(BOX).unwrap();
    let (sin, cos) = 25_f64.to_radians().sin_cos();
    let mut differences = Vec::new();
    for i in 0..40 {
        for j in 0..30 {
            // The face of the box towards the camera: x = -0.5 in its own frame.
            let (u, v) = (-1.9 + 3.8 * f64::from(i) / 40.0, 0.1 + 2.8 * f64::from(j) / 30.0);
            let point = Point3::new(9.0 - 0.5 * cos - u * sin, 1.0 - 0.5 * sin + u * cos, v);
            if let Some((left, right)) = greys_of_point(&world, 0, &point) {
                differences.push((left - right).abs());
            }
        }
    }
    let mean = differences.iter().sum::<f32>() / differences.len() as f32;
    let worst = differences.iter().copied().fold(0.0, f32::max);
    assert!(differences.len() > 800, "{}", differences.len());
    assert!(mean < 0.5 && worst < 4.0, "mean {mean}, worst {worst}");
}

/// Mean difference of the grey that both cameras see at a surface point, by material, over a middle frame.
fn differences(world: &World) -> BTreeMap<usize, (f64, usize)> {
    let frame = world.frame_count() / 2;
    let (scene, pose) = (world.scene(frame), world.true_world_from_left(frame));
    let cameras = [Camera::left(world.rig, &pose), Camera::right(world.rig, &pose)];
    let tiles = cameras.map(|camera| Tiles::new(&scene, &camera));
    let renderer = Renderer::new(&scene, &world.materials, &world.light);
    let truth = crate::LeftViewTruth::new(world, frame);
    let mut sums = BTreeMap::new();
    for (i, pixel) in truth.pixels().iter().enumerate().filter(|(i, p)| p.seen_by_right && i % 7 == 0) {
        let (x, y) = (i % world.rig.width, i / world.rig.width);
        let right_x = (x as f64 - world.rig.disparity_px(pixel.depth_m)).max(0.0);
        let [left, right] = [(0, x as f64), (1, right_x)].map(|(c, x)| {
            let candidates = tiles[c].around((x.round() as usize).min(world.rig.width - 1), y);
            renderer.sample(&cameras[c], x, y as f64, candidates, &mut Hint::default())
        });
        // The same side in the same light: a point on an edge may be seen as either of two sides.
        if left.key == right.key {
            let material = scene.object((left.key >> 4) as usize).material;
            let (sum, count) = sums.entry(material).or_insert((0.0, 0));
            *sum += f64::from(left.grey.clamp(0.0, 255.0) - right.grey.clamp(0.0, 255.0)).abs();
            *count += 1;
        }
    }
    sums
}

#[test]
fn both_cameras_see_the_same_grey_of_every_material_of_every_world() {
    for name in World::builtin_names() {
        let mut compared = 0;
        for (material, (sum, count)) in differences(&World::builtin(name).unwrap()) {
            compared += count;
            let mean = sum / count as f64;
            assert!(mean < 1.0 || count < 100, "{name}, material {material}: {mean} over {count} points");
        }
        assert!(compared > 1000, "{name}: {compared} points");
    }
}

#[test]
fn the_ground_is_met_at_height_over_sine() {
    let tilted = BOX.replace("baseline_m", "tilt_deg = 7.0\nbaseline_m");
    let world = World::from_toml(&tilted).unwrap();
    let camera = Camera::left(world.rig, &world.true_world_from_left(0));
    let (mut met, scene) = (0, world.scene(0));
    for y in 0..world.rig.height {
        // At the left border the box is out of the way.
        let angle = ((y as f64 - 47.5) / 120.0).atan() + 7_f64.to_radians();
        let (ray, _) = camera.ray(79.5, y as f64);
        let Some(hit) = scene.cast(&ray, FAR_M, &mut Hint::default()) else { continue };
        let expected = 1.5 / angle.sin();
        if hit.object == 0 {
            met += 1;
            assert!(
                (hit.range_m - expected).abs() < 1e-6 * expected.max(1.0),
                "{y}: {} {expected}",
                hit.range_m
            );
        }
    }
    assert!(met > 20, "{met}");
}

#[test]
fn the_box_shades_the_ground_on_the_side_away_from_the_sun() {
    let world = World::from_toml(BOX).unwrap();
    let scene = world.scene(0);
    let renderer = Renderer::new(&scene, &world.materials, &world.light);
    let up = Vector3::z();
    // The sun stands in the direction (-0.94, 0.34) at 50 degrees: the shadow of
    // the 3 m high box is 2.5 m long.
    let lit = |x, y| renderer.sunlight(&Point3::new(x, y, 0.0), &up, &mut Hint::default()) > 0.0;
    assert!(!lit(9.0 + 0.94 * 1.5, 1.0 - 0.34 * 1.5));
    assert!(lit(9.0 - 0.94 * 1.5, 1.0 + 0.34 * 1.5));
    assert!(lit(9.0 + 0.94 * 4.5, 1.0 - 0.34 * 4.5));
}

#[test]
fn the_sky_is_above_the_horizon() {
    let world = World::from_toml(BOX).unwrap();
    let (camera, scene) = (Camera::left(world.rig, &world.true_world_from_left(0)), world.scene(0));
    let image = Renderer::new(&scene, &world.materials, &world.light).image(&camera);
    assert!(image[..10].iter().all(|&grey| (210.0..=240.0).contains(&grey)), "{:?}", &image[..10]);
}
