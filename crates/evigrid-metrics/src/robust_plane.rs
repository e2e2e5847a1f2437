use evigrid_grid::{Moments, SafetyPlane};

/// Fewer points say nothing about a plane.
const MIN_POINTS: usize = 6;
/// Rounds of leaving out and fitting again, at most.
const ROUNDS: usize = 10;
/// Share of the points, the nearest to the plane, that the next round fits.
const KEPT: f64 = 0.75;

/// The plane z(x, y) with the least sum of squared errors in z over three quarters of the points (least trimmed
/// squares; Rousseeuw 1984), found by leaving out the quarter farthest from the last plane again and again. `None`
/// for fewer than 6 points, or points on one line seen from above. Metres.
pub(crate) fn robust_plane(mut points: Vec<[f64; 3]>) -> Option<SafetyPlane> {
    let fit = |points: &[[f64; 3]]| {
        let mut moments = Moments::default();
        points.iter().for_each(|&point| moments.add(point));
        moments.plane()
    };
    let mut plane = fit(&points).filter(|_| points.len() >= MIN_POINTS)?;
    let kept = ((KEPT * points.len() as f64).ceil() as usize).max(MIN_POINTS);
    for _ in 0..ROUNDS {
        let off = |p: &[f64; 3]| (p[2] - plane.height_m([p[0], p[1]])).abs();
        points.sort_by(|a, b| off(a).total_cmp(&off(b)));
        // The nearest points may lie on one line; the plane before is then as good as it gets.
        match fit(&points[..kept]) {
            Some(next) if next != plane => plane = next,
            _ => break,
        }
    }
    Some(plane.by_normal())
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::Vector3;

    /// 30 points of a plane, a quarter of them raised by half a metre.
    #[test]
    fn points_far_off_do_not_count() {
        let height = |x: f64, y: f64| 0.1 * x - 0.05 * y + 2.0;
        let point = |n: usize| {
            let (x, y) = ((n % 6) as f64, (n / 6) as f64);
            [x, y, height(x, y) + if n % 4 == 3 { 0.5 } else { 0.0 }]
        };
        let plane = robust_plane((0..30).map(point).collect()).unwrap();
        for [x, y] in [[0.0, 0.0], [5.0, 1.0], [2.0, 7.0]] {
            let p = Vector3::new(x, y, height(x, y));
            assert!((plane.normal.dot(&p) - plane.offset_m).abs() < 1e-9);
        }
    }

    #[test]
    fn too_few_points_or_points_on_a_line_have_no_plane() {
        assert!(robust_plane((0..5).map(|n| [f64::from(n), f64::from(n * n), 0.0]).collect()).is_none());
        assert!(robust_plane((0..9).map(|n| [f64::from(n), 2.0 * f64::from(n), 1.0]).collect()).is_none());
    }
}
