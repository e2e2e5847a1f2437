use anyhow::Result;
use evigrid_cost_curve::{
    CostCurve, CostCurveBayes, CostScale, PeakRatios, WinnerTakeAll, WinnerTakeAllSettings,
};
use evigrid_grid::{GridSpec, Mapper, MapperFamily};
use evigrid_inverse_model::InverseModelMapper;

use crate::{Config, RunInfo};

/// The mapping methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Brandao et al.'s baseline.
    WinnerTakeAll,
    /// Brandao et al.
    CostCurve,
    /// Brandao et al. by Bayes' rule: the project's own.
    CostCurveBayes,
    /// Andert 2009, section V-A.
    Line,
    /// Andert 2009, section VI-B.
    LinePyramid,
    /// Andert 2009, section V-B.
    Ray,
    /// Andert 2009, section VI-C.
    RayPyramid,
    /// Souza et al. 2012.
    Souza,
}

impl Method {
    /// All methods, in the order in which they are listed.
    pub const ALL: [Self; 8] = [
        Self::WinnerTakeAll,
        Self::CostCurve,
        Self::CostCurveBayes,
        Self::Line,
        Self::LinePyramid,
        Self::Ray,
        Self::RayPyramid,
        Self::Souza,
    ];

    /// The name on the command line, in tables and as the section of its settings.
    pub fn name(self) -> &'static str {
        match self {
            Self::WinnerTakeAll => "winner-take-all",
            Self::CostCurve => "cost-curve",
            Self::CostCurveBayes => "cost-curve-bayes",
            Self::Line => "line",
            Self::LinePyramid => "line-pyramid",
            Self::Ray => "ray",
            Self::RayPyramid => "ray-pyramid",
            Self::Souza => "souza",
        }
    }

    /// One line on what it does and where it comes from.
    pub fn summary(self) -> &'static str {
        match self {
            Self::WinnerTakeAll => {
                "Elfes' inverse model with a Gaussian around the best match of each pixel: the baseline of Brandao et al."
            }
            Self::CostCurve => {
                "the matching costs of all disparities of each pixel as evidence: Brandao et al."
            }
            Self::CostCurveBayes => {
                "the same evidence by Bayes' rule, with a realistic prior and looks instead of pixels: our own"
            }
            Self::Line => "a line per pixel, free up to what was measured and occupied there: Andert 2009",
            Self::LinePyramid => {
                "the same with as few lines as the cells allow, from an image pyramid: Andert 2009"
            }
            Self::Ray => "per cell the nearest that is seen in the pixels around its image: Andert 2009",
            Self::RayPyramid => "the same in four pixels of an image pyramid: Andert 2009",
            Self::Souza => {
                "lines whose profile is widened by the error of the platform's motion: Souza, Maia, Goncalves 2012"
            }
        }
    }

    /// What a data set must have for it.
    pub fn needs(self) -> &'static str {
        match self {
            Self::CostCurve | Self::CostCurveBayes => {
                "stereo pairs, calibration and poses; matching costs, so no disparities from elsewhere"
            }
            _ => "stereo pairs, calibration and poses",
        }
    }

    /// Whether it needs matching costs, which disparities from elsewhere have not.
    pub fn needs_costs(self) -> bool {
        matches!(self, Self::CostCurve | Self::CostCurveBayes)
    }

    /// The method with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|m| m.name() == name)
    }

    /// An empty map of this method.
    ///
    /// # Errors
    /// If one of its settings is outside its domain.
    pub fn build(self, spec: GridSpec, config: &Config) -> Result<Box<dyn Mapper>> {
        Ok(match self {
            Self::WinnerTakeAll => Box::new(WinnerTakeAll::new(spec, config.winner_take_all)?),
            Self::CostCurve => Box::new(CostCurve::new(spec, config.cost_curve, cost_scale(config))?),
            Self::CostCurveBayes => {
                Box::new(CostCurveBayes::new(spec, config.cost_curve_bayes, cost_scale(config))?)
            }
            Self::Line => Box::new(InverseModelMapper::line(spec, config.line)?),
            Self::LinePyramid => Box::new(InverseModelMapper::line_pyramid(spec, config.line_pyramid)?),
            Self::Ray => Box::new(InverseModelMapper::ray(spec, config.ray)?),
            Self::RayPyramid => Box::new(InverseModelMapper::ray_pyramid(spec, config.ray_pyramid)?),
            Self::Souza => Box::new(InverseModelMapper::souza(spec, config.souza)?),
        })
    }
}

/// What the numbers of the matcher's cost volume stand for.
fn cost_scale(config: &Config) -> CostScale {
    let unit = config.stereo.cost_unit();
    CostScale { window_pixels: unit.pixels, grey_levels: unit.levels }
}

/// Maps of one method that are built together.
pub(crate) struct Family {
    /// Numbers of the points whose maps they are, by position in the family.
    pub members: Vec<usize>,
    /// The maps.
    pub mapper: Box<dyn MapperFamily>,
}

impl Family {
    /// Empty maps for points (number, method and what a run of it would be) that share their matches: those that differ
    /// in nothing but the peak ratio in one family.
    ///
    /// # Errors
    /// If one of the settings is outside its domain.
    pub fn build(points: &[(usize, Method, &RunInfo)]) -> Result<Vec<Self>> {
        let mut groups: Vec<Vec<(usize, Method, &RunInfo)>> = Vec::new();
        for &point in points {
            match groups.iter_mut().find(|group| share_drawing(&group[0], &point)) {
                Some(group) => group.push(point),
                None => groups.push(vec![point]),
            }
        }
        groups.iter().map(|group| Self::of(group)).collect()
    }

    fn of(group: &[(usize, Method, &RunInfo)]) -> Result<Self> {
        let (_, method, info) = group[0];
        let members = group.iter().map(|(number, ..)| *number).collect();
        if group.len() == 1 {
            return Ok(Self { members, mapper: Box::new(method.build(info.spec, &info.config)?) });
        }
        // Only winner-take-all shares its drawing.
        let ratios: Vec<f64> = group.iter().map(|(_, _, i)| i.config.winner_take_all.peak_ratio).collect();
        let mapper = Box::new(PeakRatios::new(info.spec, info.config.winner_take_all, &ratios)?);
        Ok(Self { members, mapper })
    }
}

/// Whether two points differ in nothing that their maps depend on but the peak ratio, and the method can make use of it.
fn share_drawing(a: &(usize, Method, &RunInfo), b: &(usize, Method, &RunInfo)) -> bool {
    let settings = |info: &RunInfo| {
        let settings = info.config.winner_take_all;
        WinnerTakeAllSettings { peak_ratio: 1.0, ..settings }
    };
    a.1 == b.1
        && match a.1 {
            Method::WinnerTakeAll => a.2.spec == b.2.spec && settings(a.2) == settings(b.2),
            _ => false,
        }
}
