use nalgebra::Point3;

use super::*;

const BOX: &str = include_str!("../tests/box.toml");

/// Where the ray of a pixel first meets any shape, without a tree.
fn slow_hit(scene: &Scene, ray: &Ray) -> Option<(usize, f64)> {
    let one = |(i, object): (usize, &crate::scene::Object)| {
        Some((i, Scene::new(vec![object.clone()]).cast(ray, FAR_M, &mut Hint::default())?.range_m))
    };
    scene.objects().iter().enumerate().filter_map(one).min_by(|a, b| a.1.total_cmp(&b.1))
}

#[test]
fn a_renderer_without_a_tree_agrees_on_every_pixel() {
    let text = BOX.replace("width = 160", "width = 80").replace("height = 96", "height = 48");
    let text = text.replace("focal_px = 120", "focal_px = 45").replace("[79.5, 47.5]", "[39.5, 15.0]");
    let more = "[[object]]\nshape = { cylinder = { radius_m = 0.4, height_m = 2.0 } }\nroll_deg = 20\n\
                centre_m = [5.0, -0.6, 1.0]\nmaterial = \"wood\"\n\
                repeat = { count = 3, step_m = [1.5, 0.5, 0.2] }\n\
                [[object]]\nshape = { sphere = { radius_m = 0.5 } }\n\
                centre_m = [6.0, 1.2, 0.7]\nmaterial = \"soil\"\n\
                [[object]]\nshape = { ramp = { run_m = 2, rise_m = 0.4, width_m = 1, thickness_m = 0.1 } }\n\
                yaw_deg = 30\ncentre_m = [4.5, 0.4, 0.25]\nmaterial = \"wood\"\n\
                [[object]]\nshape = { rough_ground = { size_m = [6, 6], squares = [12, 12], \
                deviation_m = 0.1,\n\
                scale_m = 1, octaves = 2, roughness = 0.6, thickness_m = 0.4 } }\ncentre_m = [12, -6, 0.1]\n\
                material = \"soil\"\n";
    let world = World::from_toml(&format!("{text}{more}")).unwrap();
    let (scene, pose) = (world.scene(1), world.true_world_from_left(1));
    let (left, right) = (Camera::left(world.rig, &pose), Camera::right(world.rig, &pose));
    let truth = LeftViewTruth::new(&world, 1);
    let (mut hidden, mut shapes) = (0, std::collections::BTreeSet::new());
    for (i, pixel) in truth.pixels().iter().enumerate() {
        let (x, y) = ((i % 80) as f64, (i / 80) as f64);
        let (ray, _) = left.ray(x, y);
        let Some((object, range_m)) = slow_hit(&scene, &ray) else {
            assert_eq!(*pixel, SKY, "({x}, {y})");
            continue;
        };
        let point = ray.at(range_m);
        let depth = pose.inverse_transform_point(&point).z;
        assert_eq!(pixel.surface.map(|(shape, _)| shape as usize), Some(object), "({x}, {y})");
        assert!((pixel.depth_m - depth).abs() < 1e-9 * depth, "({x}, {y}): {} {depth}", pixel.depth_m);
        // Seen by the right camera: the same point is the first on its ray to it.
        let to_point = point - right.position();
        let back = Ray { origin: right.position(), direction: to_point.normalize() };
        let first = slow_hit(&scene, &back).map_or(f64::INFINITY, |(_, range_m)| range_m);
        let in_image = x - f64::from(pixel.disparity_px) >= -0.5;
        assert_eq!(pixel.seen_by_right, in_image && (first - to_point.norm()).abs() < 1e-6, "({x}, {y})");
        hidden += usize::from(!pixel.seen_by_right && in_image);
        shapes.insert(object);
    }
    assert!(hidden > 20 && shapes.len() == 8, "{hidden} hidden, shapes {shapes:?}");
}

#[test]
fn the_right_camera_finds_the_same_surface_point_at_the_true_disparity() {
    for (text, frame) in [(BOX, 0), (include_str!("../../../datasets/synth/street.toml"), 7)] {
        let world = World::from_toml(text).unwrap();
        let (scene, pose) = (world.scene(frame), world.true_world_from_left(frame));
        let right = Camera::right(world.rig, &pose);
        let truth = LeftViewTruth::new(&world, frame);
        let (mut compared, mut on_edges) = (0, 0);
        for (i, pixel) in truth.pixels().iter().enumerate().filter(|(_, p)| p.seen_by_right) {
            let (x, y) = ((i % world.rig.width) as f64, (i / world.rig.width) as f64);
            let point = pose * Point3::from(world.rig.ray(x, y) * pixel.depth_m);
            let (ray, _) = right.ray(x - world.rig.disparity_px(pixel.depth_m), y);
            let hit = scene.cast(&ray, FAR_M, &mut Hint::default()).unwrap();
            let distance = (ray.at(hit.range_m) - point).norm();
            // A ray on the very edge of a shape may pass it by.
            let on_edge = hit.object as u32 != pixel.surface.unwrap().0;
            assert!(distance < 1e-6 || on_edge, "pixel {i}: {distance} m");
            // The single precision of the disparity moves the ray across its own direction by less than that.
            let (rounded, _) = right.ray(x - f64::from(pixel.disparity_px), y);
            let off = (point - rounded.origin).cross(&rounded.direction).norm();
            assert!(off < 1e-6, "pixel {i}: {off} m off the ray");
            compared += 1;
            on_edges += usize::from(on_edge);
        }
        assert!(compared > 5000 && on_edges * 1000 < compared, "{compared} pixels, {on_edges} on edges");
    }
}

#[test]
fn the_posts_fill_as_many_pixels_as_published() {
    // Andert 2009, Table I: 194047 valid pixels of 640 x 480, objects between 6 and 25 m (Fig. 6).
    let truth = LeftViewTruth::new(&World::builtin("andert-posts").unwrap(), 0);
    let near = truth.pixels().iter().filter(|pixel| pixel.depth_m < 25.0).count();
    assert!(near.abs_diff(194_047) < 307_200 * 3 / 1000, "{near}");
    assert!(truth.pixels().iter().all(|pixel| pixel.depth_m > 6.0));
}
