use super::*;
use crate::ray::LocalRay;

fn build(spec: &ShapeSpec) -> Result<(Shape, Pose), String> {
    spec.build(1, None)
}

#[test]
fn the_middle_of_a_ramps_face_is_its_centre() {
    let [run_m, width_m, thickness_m] = [3.0, 1.0, 0.2].map(Positive);
    let (shape, pose) = build(&ShapeSpec::Ramp { run_m, rise_m: Finite(0.4), width_m, thickness_m }).unwrap();
    for (x, inside) in [(-1.49, true), (0.0, true), (1.49, true), (1.6, false)] {
        let height = 0.4 / 3.0 * x;
        let at = |z: f64| pose.inverse_transform_point(&nalgebra::Point3::new(x, 0.2, z)).coords;
        assert_eq!(shape.contains(&at(height - 1e-6)), inside, "{x}");
        assert!(!shape.contains(&at(height + 1e-6)), "{x}");
    }
}

#[test]
fn a_height_field_has_its_heights_and_an_inside() {
    let heights_m = vec![vec![0.0, 1.0, 0.0], vec![0.5, 2.0, 0.0]].into_iter();
    let heights_m = heights_m.map(|row: Vec<f64>| row.into_iter().map(Finite).collect()).collect();
    let spec = ShapeSpec::HeightField {
        size_m: [Positive(4.0), Positive(2.0)],
        heights_m,
        thickness_m: Positive(0.3),
    };
    let (shape, _) = build(&spec).unwrap();
    let Shape::Mesh(mesh) = &shape else { panic!("{shape:?}") };
    assert!(mesh.is_closed() && mesh.len() <= spec.triangles(), "{} {}", mesh.len(), spec.triangles());
    for (x, y, height) in
        [(-1.999, -0.999, 0.001), (0.0, -0.999, 1.0), (0.0, 0.999, 2.0), (-1.0, -0.999, 0.5)]
    {
        let down = LocalRay { origin: Vector3::new(x, y, 9.0), direction: -Vector3::z() };
        let hit = shape.cast(&down, 100.0).unwrap();
        assert!((9.0 - hit.range_m - height).abs() < 3e-3, "{x} {y}: {}", 9.0 - hit.range_m);
        assert!(hit.normal.z > 0.0);
    }
    assert!(shape.contains(&Vector3::new(0.1, 0.1, 0.2)));
    assert!(!shape.contains(&Vector3::new(0.1, 0.1, -0.31)));
    assert!(!shape.contains(&Vector3::new(1.9, 0.1, 0.3)));
}

#[test]
fn rough_ground_has_the_deviation_that_was_asked_for() {
    let spec = ShapeSpec::RoughGround {
        size_m: [Positive(60.0), Positive(50.0)],
        squares: [Count(120), Count(100)],
        deviation_m: NonNegative(0.1),
        scale_m: Positive(3.0),
        octaves: Octaves(2),
        roughness: Positive(0.5),
        thickness_m: Positive(1.0),
    };
    let (shape, _) = build(&spec).unwrap();
    let down = |x: f64, y: f64| {
        let ray = LocalRay { origin: Vector3::new(x, y, 9.0), direction: -Vector3::z() };
        9.0 - shape.cast(&ray, 100.0).unwrap().range_m
    };
    let heights: Vec<f64> = (0..2000)
        .map(|i| down((f64::from(i) * 0.618).fract() * 59.0 - 29.5, f64::from(i) * 0.0249 - 24.9))
        .collect();
    let mean = heights.iter().sum::<f64>() / 2000.0;
    let deviation = (heights.iter().map(|h| (h - mean).powi(2)).sum::<f64>() / 2000.0).sqrt();
    // Straight edges between the squares' corners take a little away.
    assert!(mean.abs() < 0.03 && (0.08..0.11).contains(&deviation), "{mean} {deviation}");
}

#[test]
fn unsound_meshes_are_refused() {
    let mesh = |vertices: &[[f64; 3]], triangles: &[[u32; 3]]| {
        let vertices_m = vertices.iter().map(|v| v.map(Finite)).collect();
        build(&ShapeSpec::Mesh { vertices_m, triangles: triangles.to_vec() }).unwrap_err()
    };
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [2.0, 0.0, 0.0]];
    assert!(mesh(&corners, &[]).contains("at least one triangle"));
    assert!(
        mesh(&corners, &[[0, 1, 2], [0, 1, 4]])
            .contains("triangle 1: expected vertex numbers below 4, found 4")
    );
    assert!(mesh(&corners, &[[0, 1, 3]]).contains("triangle 0: expected an area"));
    let rows = vec![vec![Finite(0.0); 3], vec![Finite(0.0); 2]];
    let uneven =
        ShapeSpec::HeightField { size_m: [Positive(1.0); 2], heights_m: rows, thickness_m: Positive(1.0) };
    assert!(build(&uneven).unwrap_err().contains("found lengths [3, 2]"));
    let file = ShapeSpec::MeshFile { path: "none.obj".into(), unit_m: Positive(1.0) };
    assert!(build(&file).unwrap_err().contains("a world that is a file"));
    assert!(file.build(1, Some(Path::new("/nowhere"))).unwrap_err().contains("/nowhere/none.obj"));
}
