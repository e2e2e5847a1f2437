use super::super::fixtures::{a_box, turned_map, world};
use super::*;

#[test]
fn named_things_are_tracked_in_the_map_frame() {
    let world = world(&[
        a_box([4.0, 2.0, 1.0], [9.0, 1.0, 0.5], "name = \"car\"; yaw_deg = 30.0"),
        a_box([1.0, 1.0, 1.0], [5.0, 5.0, 0.5], ""),
        a_box(
            [0.5, 0.6, 1.8],
            [5.0, -1.0, 0.9],
            "name = \"person\"; motion = { velocity_mps = [0.0, 1.5, 0.0] }",
        ),
    ]);
    let tracks = tracks(&world, &turned_map(), 2);
    let [car, person] = &tracks[..] else { panic!("{tracks:?}") };
    assert_eq!((car.thing, &car.name[..], car.moves, car.is_moving), (0, "car", false, false));
    assert!((car.yaw_rad - (30_f64.to_radians() + 0.3)).abs() < 1e-9);
    assert!((car.lengths_m - Vector3::new(4.0, 2.0, 1.0)).norm() < 1e-9, "{}", car.lengths_m);
    assert!((car.centre_m - turned_map() * Point3::new(9.0, 1.0, 0.5)).norm() < 1e-9);
    assert_eq!((person.thing, &person.name[..], person.moves, person.is_moving), (2, "person", true, true));
    // Two tenths of a second later.
    assert!((person.centre_m - turned_map() * Point3::new(5.0, -0.7, 0.9)).norm() < 1e-9);
    assert!((person.velocity_mps - turned_map().rotation * Vector3::new(0.0, 1.5, 0.0)).norm() < 1e-9);
}
