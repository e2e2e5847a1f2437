//! The four algorithms.

use anyhow::Result;
use evigrid_grid::GridSpec;
use evigrid_inverse_model::{
    InverseModelMapper, LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings, WindowCube,
};

/// An algorithm of Table I; `RayMetre` is ray tracing with windows of one metre, which
/// alone gives the published counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Algorithm {
    Line,
    LinePyramid,
    Ray,
    RayPyramid,
    RayMetre,
}

/// Those of the table.
pub const ALL: [Algorithm; 4] =
    [Algorithm::Line, Algorithm::LinePyramid, Algorithm::Ray, Algorithm::RayPyramid];

impl Algorithm {
    pub fn name(self) -> &'static str {
        match self {
            Self::Line => "line",
            Self::LinePyramid => "line-pyramid",
            Self::Ray => "ray",
            Self::RayPyramid => "ray-pyramid",
            Self::RayMetre => "ray, windows of 1 m",
        }
    }

    pub fn draws_lines(self) -> bool {
        matches!(self, Self::Line | Self::LinePyramid)
    }

    /// An empty map with the parameters of the paper, which are the defaults.
    pub fn mapper(self, spec: GridSpec) -> Result<InverseModelMapper> {
        Ok(match self {
            Self::Line => InverseModelMapper::line(spec, LineSettings::default())?,
            Self::LinePyramid => InverseModelMapper::line_pyramid(spec, LinePyramidSettings::default())?,
            Self::Ray => InverseModelMapper::ray(spec, RaySettings::default())?,
            Self::RayPyramid => InverseModelMapper::ray_pyramid(spec, RayPyramidSettings::default())?,
            Self::RayMetre => {
                let window = WindowCube::Metre;
                InverseModelMapper::ray(spec, RaySettings { window, ..RaySettings::default() })?
            }
        })
    }
}
