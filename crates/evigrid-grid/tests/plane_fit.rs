//! Least-squares planes against exact ones.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_grid::{Moments, Plane};
use nalgebra::{Matrix3, Vector3};
use proptest::prelude::*;

fn moments(points: &[[f64; 3]]) -> Moments {
    let mut moments = Moments::default();
    points.iter().for_each(|&point| moments.add(point));
    moments
}

proptest! {
    /// Points of a plane give that plane, far from the origin too; a normal equation solved in full gives the
    /// same plane for noisy points.
    #[test]
    fn planes_are_found_again(
        p in [-1.0..1.0_f64, -1.0..1.0, -2.0..2.0],
        at in [-200.0..200.0_f64, -200.0..200.0],
        points in prop::collection::vec([-2.0..2.0_f64, -2.0..2.0, -0.1..0.1], 12..60),
    ) {
        let exact = Plane { p1: p[0], p2: p[1], p3: p[2] };
        let place = |q: &[f64; 3]| [q[0] + at[0], q[1] + at[1]];
        let on_plane: Vec<[f64; 3]> =
            points.iter().map(|q| { let [x, y] = place(q); [x, y, exact.height_m([x, y])] }).collect();
        let found = moments(&on_plane).plane().unwrap();
        for q in &on_plane {
            prop_assert!((found.height_m([q[0], q[1]]) - q[2]).abs() < 1e-6);
        }
        let noisy: Vec<[f64; 3]> =
            on_plane.iter().zip(&points).map(|(on, q)| [on[0], on[1], on[2] + q[2]]).collect();
        let found = moments(&noisy).plane().unwrap();
        let (mut left, mut right) = (Matrix3::zeros(), Vector3::zeros());
        for q in &noisy {
            let row = Vector3::new(q[0] - at[0], q[1] - at[1], 1.0);
            left += row * row.transpose();
            right += row * q[2];
        }
        let solved = left.lu().solve(&right).unwrap();
        prop_assert!((found.p1 - solved.x).abs() < 1e-6 && (found.p2 - solved.y).abs() < 1e-6);
        prop_assert!((found.height_m(at) - solved.z).abs() < 1e-6);
    }
}

#[test]
fn too_few_points_or_points_on_a_line_make_no_plane() {
    assert_eq!(moments(&[]).plane(), None);
    assert_eq!(moments(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0]]).plane(), None);
    let line: Vec<[f64; 3]> = (0..20).map(|n| f64::from(n) * 0.1).map(|t| [t, 2.0 * t + 1.0, 0.3]).collect();
    assert_eq!(moments(&line).plane(), None);
    assert_eq!(moments(&vec![[3.0, 4.0, 5.0]; 10]).plane(), None);
}

#[test]
fn slope_and_normal_by_hand() {
    let plane = Plane { p1: 1.0, p2: 0.0, p3: 2.0 };
    assert!((plane.slope_deg() - 45.0).abs() < 1e-12);
    let by_normal = plane.by_normal();
    let root = 0.5_f64.sqrt();
    assert!((by_normal.normal - Vector3::new(-root, 0.0, root)).norm() < 1e-12);
    assert!((by_normal.offset_m - 2.0 * root).abs() < 1e-12);
}
