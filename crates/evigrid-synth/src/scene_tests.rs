use super::*;
use crate::render::FAR_M;
use crate::{World, angle};

fn slow(scene: &Scene, ray: &Ray, max_m: f64) -> Option<(f64, usize)> {
    let ranges = scene.objects.iter().enumerate().filter_map(|(i, o)| Some((o.meets(ray, max_m)?, i)));
    ranges.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))
}

#[test]
fn the_tree_finds_what_a_loop_over_all_shapes_finds() {
    let scene = World::builtin("street").unwrap().scene(0);
    let (mut met, mut hint) = (0, Hint::default());
    for i in 0..20_000 {
        // Directions all around, from one place on the road; every second ray next to the one before.
        let turn = f64::from(i / 2) * 137.507 + f64::from(i % 2) * 0.1;
        let direction = angle::direction(turn, f64::from(i % 1000) * 0.06 - 30.0);
        let ray = Ray { origin: Point3::new(9.3, 0.2, 1.6137), direction };
        let max_m = if i % 3 == 0 { 9.0 } else { FAR_M };
        let expected = slow(&scene, &ray, max_m);
        let fresh = scene.cast(&ray, max_m, &mut Hint::default()).map(|hit| (hit.range_m, hit.object));
        let guessed = scene.cast(&ray, max_m, &mut hint).map(|hit| (hit.range_m, hit.object));
        assert_eq!(fresh, expected, "ray {i}");
        assert_eq!(guessed, expected, "ray {i}");
        assert_eq!(scene.blocks(&ray, max_m, &mut hint), expected.is_some(), "ray {i}");
        met += usize::from(expected.is_some());
    }
    assert!(met > 12_000, "{met}");
}
