use nalgebra::{Point3, Vector3};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;

use super::*;
use crate::random::{Sensor, stream};

const PLAIN: &str = "grey = 120.0\ncontrast = 0.8\nscale_m = 0.5\noctaves = 6";
const CONCRETE: &str = "grey = 120.0\ncontrast = 25.0\nscale_m = 0.5\noctaves = 8\nroughness = 1.0";
const STRIPES: &str = "grey = 60.0\ncontrast = 10.0\nscale_m = 0.4\noctaves = 6\n\
    pattern = { stripes = { along = \"u\", period_m = 0.4, width_m = 0.2, grey = 220.0 } }";
const SHUTTER: &str = "grey = 96.0\ncontrast = 9.0\nscale_m = 0.4\noctaves = 5\n\
    pattern = { stripes = { along = \"v\", period_m = 0.09, width_m = 0.025, grey = 30.0 } }";
const CHECKS: &str = "grey = 40.0\ncontrast = 10.0\nscale_m = 0.4\noctaves = 6\n\
    pattern = { checks = { size_m = 0.3, grey = 220.0 } }";
const BRICK: &str = "grey = 104.0\ncontrast = 12.0\nscale_m = 0.6\noctaves = 6\nroughness = 0.95\n\
    pattern = { brick = { length_m = 0.26, height_m = 0.09, joint_m = 0.014, grey = 190.0, tint = 30.0 } }";
const SLABS: &str = "grey = 138.0\ncontrast = 14.0\nscale_m = 0.4\noctaves = 6\nroughness = 0.95\n\
    pattern = { brick = { length_m = 0.6, height_m = 0.4, joint_m = 0.02, grey = 60.0, tint = 30.0 } }";
const GRASS: &str = "grey = 92.0\ncontrast = 14.0\nscale_m = 1.5\noctaves = 5\n\
    pattern = { grass = { length_m = 0.12, width_m = 0.008, clump_m = 0.35, contrast = 26.0 } }";
const ROAD: &str = "grey = 88.0\ncontrast = 15.0\nscale_m = 0.6\noctaves = 7\nroughness = 0.95\n\
    pattern = { road = { grey = 205, centre_lines_m = [0.0], dash_m = 3.0, gap_m = 6.0, line_width_m = 0.12, \
    edge_lines_m = [-3.2, 3.2], \
    crosswalks = [{ at_m = 12.0, length_m = 3.0, from_m = -3.0, to_m = 3.0, bar_m = 0.5, gap_m = 0.5 }], \
    stop_lines = [{ at_m = 9.5, width_m = 0.4, from_m = -3.1, to_m = -0.1 }] } }";

const ALL: [(&str, &str); 9] = [
    ("plain", PLAIN),
    ("concrete", CONCRETE),
    ("stripes", STRIPES),
    ("shutter", SHUTTER),
    ("checks", CHECKS),
    ("brick", BRICK),
    ("slabs", SLABS),
    ("grass", GRASS),
    ("road", ROAD),
];

fn material(toml: &str) -> Material {
    Material::new(toml::from_str(toml).unwrap())
}

const SEED: u32 = 7;

/// A plane in the world: x forward, y left, z up, the origin on the ground below the left camera.
struct Plane {
    origin: Point3<f64>,
    u: Vector3<f64>,
    v: Vector3<f64>,
}

const GROUND: Plane = Plane {
    origin: Point3::new(0.0, 0.0, 0.0),
    u: Vector3::new(1.0, 0.0, 0.0),
    v: Vector3::new(0.0, 1.0, 0.0),
};

/// An upright wall through (x, 0), its level direction (a, b, 0).
fn wall(x: f64, a: f64, b: f64) -> Plane {
    Plane { origin: Point3::new(x, 0.0, 0.0), u: Vector3::new(a, b, 0.0), v: Vector3::z() }
}

/// The grey of the surface point (u, v) as a camera that looks along x sees it; see `render::footprint`.
fn seen(material: &Material, plane: &Plane, [u, v]: [f64; 2], camera: &Point3<f64>, focal_px: f64) -> f32 {
    let ray = plane.origin + plane.u * u + plane.v * v - camera;
    let width_m = ray.x / focal_px;
    let normal = plane.u.cross(&plane.v);
    let along_normal = ray.dot(&normal);
    let span = (ray - normal * along_normal) * (width_m / along_normal.abs());
    let footprint = Footprint { width_m, span_m: [span.dot(&plane.u), span.dot(&plane.v)] };
    material.grey([u, v], &footprint, SEED)
}

fn uniform(rng: &mut ChaCha8Rng, from: f64, to: f64) -> f64 {
    from + (to - from) * f64::from(rng.next_u32()) / 4_294_967_296.0
}

/// A random surface and a random point on it, 2 to 40 m ahead.
type Draw = fn(&mut ChaCha8Rng) -> (Plane, [f64; 2]);

/// Walls are seen at 18 degrees from their plane or more. At less the true footprints of the
/// two cameras differ by some 10 percent in length, and with them the greys of strong
/// patterns, however they are filtered.
const DRAWS: [(&str, Draw); 4] = [
    ("ground", |rng| {
        let x = uniform(rng, 2.0, 40.0);
        (GROUND, [x, x * uniform(rng, -0.7, 0.7)])
    }),
    ("wall across", |rng| on_wall(rng, [0.0, 1.0], [-0.7, 0.7])),
    ("wall at 45 degrees", |rng| on_wall(rng, [0.5_f64.sqrt(), 0.5_f64.sqrt()], [-0.7, 0.5])),
    ("wall at 60 degrees", |rng| on_wall(rng, [0.75_f64.sqrt(), 0.5], [-0.7, 0.2])),
];

/// A point on an upright wall whose level direction is (a, b, 0), 2 to 40 m ahead; its image column is
/// uniform between the two given ones (left is positive, in focal lengths).
fn on_wall(rng: &mut ChaCha8Rng, [a, b]: [f64; 2], [from, to]: [f64; 2]) -> (Plane, [f64; 2]) {
    let x = uniform(rng, 2.0, 40.0);
    let u = x * uniform(rng, from, to) / b;
    (wall(x - u * a, a, b), [u, uniform(rng, 0.0, 6.0)])
}

#[test]
fn both_cameras_see_the_same_grey_at_a_surface_point() {
    for (focal_px, baseline_m) in [(420.0, 0.5), (700.0, 0.3)] {
        for (surface, draw) in DRAWS {
            for (name, toml) in ALL {
                let material = material(toml);
                let mut rng = stream(1, 0, Sensor::Left, 0);
                let difference = |_| {
                    let (plane, point) = draw(&mut rng);
                    let grey = |y| seen(&material, &plane, point, &Point3::new(0.0, y, 1.6), focal_px);
                    (grey(0.0) - grey(-baseline_m)).abs()
                };
                let mean = (0..5000).map(difference).sum::<f32>() / 5000.0;
                assert!(mean < 1.0, "{name}, {surface}, f = {focal_px} px, b = {baseline_m} m: {mean}");
            }
        }
    }
}

/// Over 40 m there are some 700 cells of the coarsest noise (1.5 m, grass), whose mean is about 14 /
/// sqrt(700) = 0.5; the mean over 40000 points of deviation 85 (checks) is good to 0.43.
#[test]
fn a_huge_footprint_shows_the_mean_of_a_material() {
    let point = Footprint { width_m: 1e-5, span_m: [0.0; 2] };
    let huge = Footprint { width_m: 40.0, span_m: [0.0; 2] };
    for (name, toml) in ALL {
        let material = material(toml);
        let mut rng = stream(1, 0, Sensor::Left, 0);
        let grey = |_| {
            let at = [uniform(&mut rng, -17.0, 23.0), uniform(&mut rng, -21.0, 19.0)];
            f64::from(material.grey(at, &point, SEED))
        };
        let mean = (0..40_000).map(grey).sum::<f64>() / 40_000.0;
        let found = f64::from(material.grey([3.0, -1.0], &huge, SEED));
        assert!((found - mean).abs() < 2.0, "{name}: {found} {mean}");
    }
}

#[test]
fn a_material_without_contrast_is_perfectly_plain() {
    for roughness in ["1e-6", "1.0", "1e6"] {
        let toml =
            format!("grey = 77.0\ncontrast = 0.0\nscale_m = 0.5\noctaves = 16\nroughness = {roughness}");
        let material = material(&toml);
        for i in 0..200 {
            let footprint =
                Footprint { width_m: 0.001 * f64::from(i + 1), span_m: [0.02 * f64::from(i), 0.0] };
            assert_eq!(material.grey([0.13 * f64::from(i), -7.1], &footprint, SEED), 77.0);
        }
    }
}

#[test]
fn no_roughness_makes_a_grey_that_is_no_number() {
    for roughness in ["1e-6", "1e6"] {
        let toml =
            format!("grey = 77.0\ncontrast = 9.0\nscale_m = 0.5\noctaves = 16\nroughness = {roughness}");
        let point = Footprint { width_m: 1e-6, span_m: [0.0; 2] };
        let grey = material(&toml).grey([0.3, 0.4], &point, SEED);
        assert!((grey - 77.0).abs() < 40.0, "{grey}");
    }
}
