use super::super::fixtures::{a_box, object, turned_map, world};
use super::*;

fn ground() -> World {
    world(&[
        a_box([40.0, 40.0, 1.0], [0.0, 0.0, -0.5], "ground = true; name = \"floor\""),
        object(
            "ramp = { run_m = 4.0, rise_m = 0.4, width_m = 2.0, thickness_m = 0.3 }",
            [8.0, 1.0, 0.2],
            "yaw_deg = 90.0; ground = true",
        ),
        a_box([2.0, 1.0, 1.0], [5.0, 3.0, 0.5], ""),
        object("cylinder = { radius_m = 1.0, height_m = 0.2 }", [5.0, -3.0, 0.1], "ground = true"),
        object(
            "cylinder = { radius_m = 1.0, height_m = 0.2 }",
            [5.0, -6.0, 0.1],
            "roll_deg = 80.0; ground = true",
        ),
        object("sphere = { radius_m = 1.0 }", [9.0, -3.0, 0.1], "ground = true"),
        object(
            "height_field = { size_m = [2.0, 2.0], heights_m = [[0.0, 0.1], [0.0, 0.1]], thickness_m = 0.1 }",
            [9.0, -6.0, 0.1],
            "ground = true",
        ),
    ])
}

#[test]
fn the_upper_faces_of_the_ground_are_planes() {
    let planes = ground_planes(&ground(), &Pose::identity());
    assert_eq!(planes.iter().map(|plane| plane.thing).collect::<Vec<_>>(), [0, 1, 3]);
    let [floor, ramp, disc] = &planes[..] else { panic!() };
    assert_eq!((floor.name.as_deref(), floor.normal, floor.slope_deg), (Some("floor"), Vector3::z(), 0.0));
    assert!(floor.offset_m.abs() < 1e-12 && (disc.offset_m - 0.2).abs() < 1e-12);
    // The ramp rises by 0.1 along y.
    assert!((ramp.slope_deg - 0.1_f64.atan().to_degrees()).abs() < 1e-9);
    let expected = Vector3::new(0.0, -0.1, 1.0).normalize();
    assert!((ramp.normal - expected).norm() < 1e-9);
    assert!((ramp.offset_m - expected.dot(&Vector3::new(8.0, 1.0, 0.2))).abs() < 1e-9);
    let mut corners: Vec<_> =
        ramp.corners_m.iter().map(|p| [p.x, p.y, p.z].map(|v| (v * 1e6).round() / 1e6)).collect();
    corners.sort_by(|a, b| a.partial_cmp(b).unwrap());
    assert_eq!(corners, [[7.0, -1.0, 0.0], [7.0, 3.0, 0.4], [9.0, -1.0, 0.0], [9.0, 3.0, 0.4]]);
}

#[test]
fn planes_follow_the_map_frame() {
    let (world, moved) = (ground(), turned_map());
    let pairs = ground_planes(&world, &Pose::identity()).into_iter().zip(ground_planes(&world, &moved));
    for (before, after) in pairs {
        assert!((moved.rotation * before.normal - after.normal).norm() < 1e-9);
        assert!((before.slope_deg - after.slope_deg).abs() < 1e-9);
        for (a, b) in before.corners_m.iter().zip(&after.corners_m) {
            assert!((moved * a - b).norm() < 1e-9);
            assert!((after.normal.dot(&b.coords) - after.offset_m).abs() < 1e-9, "a corner is off its plane");
        }
        // One after another around the rectangle.
        let [a, b, c, d] = after.corners_m;
        assert!(((b - a) - (c - d)).norm() < 1e-9 && (b - a).dot(&(c - b)).abs() < 1e-9);
    }
}
