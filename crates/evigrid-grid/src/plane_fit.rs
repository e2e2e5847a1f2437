//! Least-squares planes of points (Murarka and Kuipers 2009, section V-B).

use crate::SafetyPlane;
use nalgebra::Vector3;

/// Sums over points, from which a plane is fitted: they add up.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Moments {
    /// Number of points.
    pub count: f64,
    /// Sums of x, y and z, metres.
    pub sum: [f64; 3],
    /// Sums of x x, x y, y y, x z, y z and z z, square metres.
    pub products: [f64; 6],
}

impl Moments {
    /// Adds a point in the map frame, metres.
    #[inline]
    pub fn add(&mut self, [x, y, z]: [f64; 3]) {
        self.count += 1.0;
        for (sum, v) in self.sum.iter_mut().zip([x, y, z]) {
            *sum += v;
        }
        for (sum, v) in self.products.iter_mut().zip([x * x, x * y, y * y, x * z, y * z, z * z]) {
            *sum += v;
        }
    }

    /// The same points, each of which counts as so many.
    #[must_use]
    pub fn weighted(&self, weight: f64) -> Self {
        Self {
            count: weight * self.count,
            sum: self.sum.map(|sum| weight * sum),
            products: self.products.map(|sum| weight * sum),
        }
    }

    /// Adds the points of other moments.
    #[inline]
    pub fn append(&mut self, other: &Self) {
        self.count += other.count;
        for (sum, v) in self.sum.iter_mut().zip(other.sum) {
            *sum += v;
        }
        for (sum, v) in self.products.iter_mut().zip(other.products) {
            *sum += v;
        }
    }

    /// Root mean square of the differences in height between the points and a plane, metres; NaN without points.
    pub fn distance_m(&self, plane: &Plane) -> f64 {
        let [x, y, z] = self.sum.map(|sum| sum / self.count);
        let [xx, xy, yy, xz, yz, zz] = self.products.map(|sum| sum / self.count);
        let (xx, xy, yy) = (xx - x * x, xy - x * y, yy - y * y);
        let (xz, yz, zz) = (xz - x * z, yz - y * z, zz - z * z);
        let Plane { p1, p2, .. } = *plane;
        let mean = z - plane.height_m([x, y]);
        let spread = zz - 2.0 * (p1 * xz + p2 * yz) + p1 * p1 * xx + 2.0 * p1 * p2 * xy + p2 * p2 * yy;
        (mean * mean + spread.max(0.0)).sqrt()
    }

    /// The plane with the least sum of squared errors in z; `None` for fewer than three points, or points on
    /// one line seen from above.
    pub fn plane(&self) -> Option<Plane> {
        if self.count < 3.0 {
            return None;
        }
        let [x, y, z] = self.sum.map(|sum| sum / self.count);
        let [xx, xy, yy, xz, yz, _] = self.products.map(|sum| sum / self.count);
        let (xx, xy, yy) = (xx - x * x, xy - x * y, yy - y * y);
        let (xz, yz) = (xz - x * z, yz - y * z);
        let (determinant, spread) = (xx * yy - xy * xy, xx + yy);
        // Points on one line have the determinant 0 but for rounding.
        if determinant <= 1e-6 * spread * spread {
            return None;
        }
        let p1 = (xz * yy - yz * xy) / determinant;
        let p2 = (yz * xx - xz * xy) / determinant;
        Some(Plane { p1, p2, p3: z - p1 * x - p2 * y })
    }
}

/// A plane z = p1 x + p2 y + p3 in the map frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plane {
    /// Rise along x.
    pub p1: f64,
    /// Rise along y.
    pub p2: f64,
    /// Height at the origin, metres.
    pub p3: f64,
}

impl Plane {
    /// Height at a place, metres.
    pub fn height_m(&self, [x, y]: [f64; 2]) -> f64 {
        self.p1 * x + self.p2 * y + self.p3
    }

    /// Its slope, degrees.
    pub fn slope_deg(&self) -> f64 {
        self.p1.hypot(self.p2).atan().to_degrees()
    }

    /// The plane by its normal.
    pub fn by_normal(&self) -> SafetyPlane {
        let length = (1.0 + self.p1 * self.p1 + self.p2 * self.p2).sqrt();
        let normal = Vector3::new(-self.p1, -self.p2, 1.0) / length;
        SafetyPlane { normal, offset_m: self.p3 / length }
    }
}
