//! Means over the area of a pixel's footprint.

use super::interval::Interval;
use crate::noise::Footprint;
use crate::number::Grey;

/// No area is smaller than this along u or v, metres: coordinates of 1e6 m are good to 1e-10 m.
const SMALLEST_M: f64 = 1e-8;

impl Footprint {
    /// The area over which patterns are averaged: around a point, as long along each coordinate as the
    /// footprint. It is never quite empty, not even for a microscope.
    pub fn area(&self, [u, v]: [f64; 2]) -> [Interval; 2] {
        let [extent_u, extent_v] = self.extents();
        [Interval::around(u, extent_u.max(SMALLEST_M)), Interval::around(v, extent_v.max(SMALLEST_M))]
    }
}

/// The mean grey of an area of which this share is `grey` and the rest `base`.
pub fn mix(base: f32, grey: Grey, share: f64) -> f32 {
    base + share as f32 * (grey.0 as f32 - base)
}
