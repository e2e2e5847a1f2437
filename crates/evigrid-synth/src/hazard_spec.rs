//! Hazards and safe areas as a world describes them.

use std::collections::BTreeSet;

use serde::Deserialize;
use toml::Spanned;

use crate::angle::sin_cos_deg;
use crate::description::WorldSpec;
use crate::name::Name;
use crate::number::Finite;
use crate::{HazardKind, SynthError};

/// A named place that is dangerous to the robot.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct HazardSpec {
    /// Its name in tables.
    name: Spanned<Name>,
    /// What makes it dangerous.
    kind: HazardKind,
    /// From and to along the world's x before the turn, metres.
    x_m: Extent,
    /// From and to along the world's y before the turn, metres.
    y_m: Extent,
    /// Its turn about its own centre, anticlockwise from above.
    #[serde(default)]
    yaw_deg: Finite,
}

/// A named place that the robot may drive on.
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SafeAreaSpec {
    /// Its name in tables.
    name: Spanned<Name>,
    /// From and to along the world's x before the turn, metres.
    x_m: Extent,
    /// From and to along the world's y before the turn, metres.
    y_m: Extent,
    /// Its turn about its own centre, anticlockwise from above.
    #[serde(default)]
    yaw_deg: Finite,
}

/// The lower and the upper end of a length along an axis, metres.
#[derive(Debug, Clone, Copy, Deserialize)]
#[serde(try_from = "[Finite; 2]")]
struct Extent([f64; 2]);

impl TryFrom<[Finite; 2]> for Extent {
    type Error = String;

    fn try_from(ends: [Finite; 2]) -> Result<Self, String> {
        let [from, to] = ends.map(|end| end.0);
        if from < to {
            return Ok(Self([from, to]));
        }
        Err(format!("expected [from, to] with from < to, found [{from}, {to}]"))
    }
}

/// A rectangle on the ground of the world's frame.
#[derive(Debug, Clone, Copy)]
pub struct Area {
    centre_m: [f64; 2],
    /// Half its lengths along its own axes.
    half_m: [f64; 2],
    /// Cosine and sine of the turn of its axes.
    heading: [f64; 2],
}

impl Area {
    fn new(x_m: Extent, y_m: Extent, yaw_deg: Finite) -> Self {
        let ends = [x_m.0, y_m.0];
        let (sin, cos) = sin_cos_deg(yaw_deg.0);
        Self {
            centre_m: ends.map(|[from, to]| 0.5 * (from + to)),
            half_m: ends.map(|[from, to]| 0.5 * (to - from)),
            heading: [cos, sin],
        }
    }

    /// The area from and to these ends along the world's x and y.
    #[cfg(test)]
    pub fn between(x_m: [f64; 2], y_m: [f64; 2]) -> Self {
        Self::new(Extent(x_m), Extent(y_m), Finite(0.0))
    }

    /// Whether a place of the world, metres, lies in the area; its border belongs to it.
    pub fn contains(&self, [x, y]: [f64; 2]) -> bool {
        let (away, [cos, sin]) = ([x - self.centre_m[0], y - self.centre_m[1]], self.heading);
        let own = [cos * away[0] + sin * away[1], cos * away[1] - sin * away[0]];
        own.iter().zip(self.half_m).all(|(along, half)| along.abs() <= half)
    }
}

/// An area with the name and the kind that it has in tables.
#[derive(Debug, Clone)]
pub struct NamedArea {
    pub name: String,
    pub kind: HazardKind,
    pub area: Area,
}

/// The hazards of a world, then its safe areas, each in the order of the text.
///
/// # Errors
/// If a name is there twice (with its line in `text`), or there is no robot that could be in danger.
pub fn named_areas(spec: &WorldSpec, text: &str) -> Result<Vec<NamedArea>, SynthError> {
    let hazards = spec.hazard.iter().map(|it| (&it.name, it.kind, Area::new(it.x_m, it.y_m, it.yaw_deg)));
    let safe = spec.safe_area.iter();
    let safe = safe.map(|it| (&it.name, HazardKind::SafeArea, Area::new(it.x_m, it.y_m, it.yaw_deg)));
    let mut known = BTreeSet::new();
    let mut areas = Vec::new();
    for (name, kind, area) in hazards.chain(safe) {
        let (line, name) = (name.span().start, &name.get_ref().0);
        if !known.insert(name) {
            let reason =
                format!("expected a name of its own for each hazard and safe area, found `{name}` twice");
            return Err(SynthError::at(text, line, &reason));
        }
        areas.push(NamedArea { name: name.clone(), kind, area });
    }
    if !areas.is_empty() && spec.robot.is_none() {
        let key = if spec.hazard.is_empty() { "safe_area" } else { "hazard" };
        return Err(SynthError::value(key, "a section [robot], whose safety map it belongs to", "none"));
    }
    Ok(areas)
}

#[cfg(test)]
#[path = "hazard_spec_tests.rs"]
mod tests;
