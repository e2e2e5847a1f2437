use serde::Deserialize;

use super::interval::Interval;
use crate::noise::{Footprint, FractalNoise};
use crate::number::{Finite, Grey, NonNegative, Positive};

/// Markings painted on a road that runs along u. Both u and v count from the shape's own origin (the centre
/// of a box). Where lines would run through a crosswalk or a stop line, they are interrupted.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RoadSpec {
    /// Grey of fresh paint, 0 to 255 in full light.
    grey: Grey,
    /// Where the dashed lines run: v of the middle of each, metres.
    #[serde(default)]
    centre_lines_m: Vec<Finite>,
    /// Length of a dash, metres. One dash begins at u = 0.
    #[serde(default = "default_dash")]
    dash_m: Positive,
    /// From the end of a dash to the next dash, metres; 0 for solid lines.
    #[serde(default = "default_gap")]
    gap_m: NonNegative,
    /// Width of the dashed and the solid lines, metres.
    #[serde(default = "default_line_width")]
    line_width_m: Positive,
    /// Where the solid lines run: v of the middle of each, metres.
    #[serde(default)]
    edge_lines_m: Vec<Finite>,
    /// Crosswalks (zebra crossings).
    #[serde(default)]
    crosswalks: Vec<Crosswalk>,
    /// Stop lines.
    #[serde(default)]
    stop_lines: Vec<StopLine>,
    /// The mean share of the paint that is gone, 0 to 1. It is gone in patches; what is left shows the
    /// texture of the road, softened.
    #[serde(default)]
    wear: Wear,
}

/// Bars along u, side by side across the road.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct Crosswalk {
    /// u of its middle, metres.
    at_m: Finite,
    /// Length of the bars along u, metres.
    length_m: Positive,
    /// v where the first bar begins, metres.
    from_m: Finite,
    /// v where the crosswalk ends, metres; a bar that reaches beyond is cut.
    to_m: Finite,
    /// Width of a bar, metres.
    bar_m: Positive,
    /// From one bar to the next, metres.
    gap_m: NonNegative,
}

/// A line across the road.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
struct StopLine {
    /// u of its middle, metres.
    at_m: Finite,
    /// Its width along u, metres.
    width_m: Positive,
    /// v where it begins, metres.
    from_m: Finite,
    /// v where it ends, metres.
    to_m: Finite,
}

/// A share of worn paint.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "f64")]
struct Wear(f64);

impl TryFrom<f64> for Wear {
    type Error = String;

    fn try_from(value: f64) -> Result<Self, String> {
        if (0.0..=1.0).contains(&value) {
            return Ok(Self(value));
        }
        Err(format!("expected a share from 0 to 1, found {value}"))
    }
}

impl Default for Wear {
    fn default() -> Self {
        Self(0.2)
    }
}

fn default_dash() -> Positive {
    Positive(3.0)
}

fn default_gap() -> NonNegative {
    NonNegative(6.0)
}

fn default_line_width() -> Positive {
    Positive(0.12)
}

/// How much of the road's own texture shows through the paint.
const SHOW_THROUGH: f32 = 0.4;

/// Standard deviation of the share of paint that is gone, relative to its mean.
const PATCHINESS: f32 = 0.6;

/// A marked road.
#[derive(Debug, Clone)]
pub struct Road {
    grey: f32,
    wear: f32,
    /// Where paint is gone.
    patches: FractalNoise,
    lines: Vec<Line>,
    bars: Vec<Bars>,
}

/// A line along u.
#[derive(Debug, Clone)]
struct Line {
    v: Interval,
    period_m: f64,
    dash_m: f64,
    /// Where it is interrupted; these do not overlap unless the description is odd.
    gaps: Vec<Interval>,
}

/// Bars side by side that fill a rectangle, beginning at the start of `v`.
#[derive(Debug, Clone)]
struct Bars {
    u: Interval,
    v: Interval,
    period_m: f64,
    bar_m: f64,
}

impl Road {
    /// The road that `spec` describes.
    pub fn new(spec: &RoadSpec) -> Self {
        let crosswalks = spec.crosswalks.iter().map(|c| Bars {
            u: Interval::around(c.at_m.0, c.length_m.0),
            v: Interval::between(c.from_m.0, c.to_m.0),
            period_m: c.bar_m.0 + c.gap_m.0,
            bar_m: c.bar_m.0,
        });
        let stop_lines = spec.stop_lines.iter().map(|s| Bars {
            u: Interval::around(s.at_m.0, s.width_m.0),
            v: Interval::between(s.from_m.0, s.to_m.0),
            period_m: 1.0,
            bar_m: 1.0,
        });
        let bars: Vec<Bars> = crosswalks.chain(stop_lines).collect();
        let line = |v: &Finite, gap_m: f64| {
            let v = Interval::around(v.0, spec.line_width_m.0);
            let crossing = bars.iter().filter(|b| b.v.common(v).length() > 0.0);
            Line {
                v,
                period_m: spec.dash_m.0 + gap_m,
                dash_m: spec.dash_m.0,
                gaps: crossing.map(|b| b.u).collect(),
            }
        };
        let dashed = spec.centre_lines_m.iter().map(|v| line(v, spec.gap_m.0));
        let solid = spec.edge_lines_m.iter().map(|v| line(v, 0.0));
        Self {
            grey: spec.grey.0 as f32,
            wear: spec.wear.0 as f32,
            patches: FractalNoise::new(0.5, 4, 0.8),
            lines: dashed.chain(solid).collect(),
            bars,
        }
    }

    /// Grey of the road with its markings; without them it is `base`, of which
    /// `texture` is the part that varies.
    pub fn apply(&self, base: f32, texture: f32, point: [f64; 2], footprint: &Footprint, seed: u32) -> f32 {
        let share = self.painted(footprint.area(point)) as f32;
        if share == 0.0 {
            return base;
        }
        let gone = self.wear * (1.0 + PATCHINESS * self.patches.sample(point, footprint, seed ^ 0x5bd1_e995));
        let paint = self.grey + SHOW_THROUGH * texture;
        base + share * (1.0 - gone) * (paint - base)
    }

    /// The share of an area that is marked.
    fn painted(&self, [u, v]: [Interval; 2]) -> f64 {
        let lines: f64 = self.lines.iter().map(|line| line.painted(u, v)).sum();
        let bars: f64 = self.bars.iter().map(|bars| bars.painted(u, v)).sum();
        ((lines + bars) / (u.length() * v.length())).min(1.0)
    }
}

impl Line {
    /// The painted part of an area, square metres.
    fn painted(&self, u: Interval, v: Interval) -> f64 {
        let across = v.common(self.v).length();
        if across == 0.0 {
            return 0.0;
        }
        let dashes = |u: Interval| u.covered(0.0, self.period_m, self.dash_m);
        let interrupted: f64 = self.gaps.iter().map(|&gap| dashes(u.common(gap))).sum();
        across * (dashes(u) - interrupted).max(0.0)
    }
}

impl Bars {
    /// The painted part of an area, square metres.
    fn painted(&self, u: Interval, v: Interval) -> f64 {
        let along = u.common(self.u).length();
        if along == 0.0 {
            return 0.0;
        }
        along * v.common(self.v).covered(self.v.start(), self.period_m, self.bar_m)
    }
}
