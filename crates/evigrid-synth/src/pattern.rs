//! Regular patterns over surface coordinates, filtered exactly with the pixel's footprint.

use serde::Deserialize;

use crate::noise::{Footprint, hash, split, unit};
use crate::number::{Grey, NonNegative, Positive};

/// A surface coordinate. On upright faces u runs level and v up; on level faces u is the shape's x and v its y.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Axis {
    /// Level.
    U,
    /// Upright.
    V,
}

/// A regular pattern on top of a material's noise.
#[derive(Debug, Clone, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum Pattern {
    /// Stripes of `width_m` every `period_m` along the coordinate `along`.
    Stripes { along: Axis, period_m: Positive, width_m: Positive, grey: Grey },
    /// Squares of `size_m`, every second one of the given grey.
    Checks { size_m: Positive, grey: Grey },
    /// Bricks or slabs in running bond with joints of `joint_m`; `tint` is the spread of grey between bricks.
    Brick { length_m: Positive, height_m: Positive, joint_m: Positive, grey: Grey, tint: NonNegative },
}

impl Pattern {
    /// The grey at (u, v) of a surface that would have grey `base` without the pattern.
    pub fn apply(&self, base: f32, [u, v]: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        let [extent_u, extent_v] = footprint.extents();
        match self {
            Self::Stripes { along, period_m, width_m, grey } => {
                let (x, extent) = if *along == Axis::U { (u, extent_u) } else { (v, extent_v) };
                mix(base, *grey, coverage(x, extent, period_m.0, width_m.0))
            }
            Self::Checks { size_m, grey } => {
                let sign = |x, extent| 2.0 * coverage(x, extent, 2.0 * size_m.0, size_m.0) - 1.0;
                mix(base, *grey, 0.5 + 0.5 * sign(u, extent_u) * sign(v, extent_v))
            }
            Self::Brick { length_m, height_m, joint_m, grey, tint } => {
                let (row, _) = split(v / height_m.0);
                let shifted_u = u + if row & 1 == 0 { 0.0 } else { 0.5 * length_m.0 };
                let (column, _) = split(shifted_u / length_m.0);
                let far = ((extent_u / length_m.0).max(extent_v / height_m.0)).min(1.0) as f32;
                let tone = tint.0 as f32 * (1.0 - far) * unit(hash(column, row, seed));
                let joint_u = coverage(shifted_u, extent_u, length_m.0, joint_m.0);
                let joint_v = coverage(v, extent_v, height_m.0, joint_m.0);
                mix(base + tone, *grey, 1.0 - (1.0 - joint_u) * (1.0 - joint_v))
            }
        }
    }
}

fn mix(base: f32, grey: Grey, share: f64) -> f32 {
    base + share as f32 * (grey.0 as f32 - base)
}

/// The share of the interval of length `extent` centred at `x` that is covered by pulses of `width` every `period`,
/// the first of which begins at 0.
fn coverage(x: f64, extent: f64, period: f64, width: f64) -> f64 {
    let covered_until = |x: f64| {
        let cycles = (x / period).floor();
        cycles * width + (x - cycles * period).min(width)
    };
    ((covered_until(x + 0.5 * extent) - covered_until(x - 0.5 * extent)) / extent).clamp(0.0, 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_is_the_mean_of_the_pulses() {
        // Pulses [0, 1], [4, 5], [8, 9] ...
        for (x, extent, expected) in [
            (0.5, 0.2, 1.0),
            (2.5, 0.2, 0.0),
            (1.0, 0.5, 0.5),
            (2.0, 4.0, 0.25),
            (-3.5, 1.0, 1.0),
            (2.5, 4000.0, 0.25),
        ] {
            assert!((coverage(x, extent, 4.0, 1.0) - expected).abs() < 1e-9, "{x} {extent}");
        }
    }

    #[test]
    fn checks_alternate_and_grey_out_far_away() {
        let checks = Pattern::Checks { size_m: Positive(1.0), grey: Grey(200.0) };
        let at = |p, width_m| checks.apply(100.0, p, &Footprint { width_m, span_m: [0.0; 2] }, 0);
        assert_eq!(at([0.5, 0.5], 0.01), 200.0);
        assert_eq!(at([1.5, 0.5], 0.01), 100.0);
        assert_eq!(at([1.5, -0.5], 0.01), 200.0);
        assert!((at([1.3, 0.1], 1000.0) - 150.0).abs() < 0.1);
    }

    #[test]
    fn bricks_of_the_next_row_are_shifted_by_half() {
        let brick = Pattern::Brick {
            length_m: Positive(0.4),
            height_m: Positive(0.1),
            joint_m: Positive(0.02),
            grey: Grey(250.0),
            tint: NonNegative(0.0),
        };
        let at = |p| brick.apply(80.0, p, &Footprint { width_m: 1e-4, span_m: [0.0; 2] }, 0);
        assert_eq!(at([0.01, 0.05]), 250.0);
        assert_eq!(at([0.21, 0.05]), 80.0);
        assert_eq!(at([0.01, 0.15]), 80.0);
        assert_eq!(at([0.21, 0.15]), 250.0);
        assert_eq!(at([0.21, 0.01]), 250.0);
    }
}
