use anyhow::Result;
use evigrid_cost_curve::WinnerTakeAll;
use evigrid_grid::{GridSpec, Mapper};

use crate::Config;

/// The mapping methods.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Method {
    /// Brandao et al.'s baseline.
    WinnerTakeAll,
}

impl Method {
    /// All methods, in the order in which they are listed.
    pub const ALL: [Self; 1] = [Self::WinnerTakeAll];

    /// The name on the command line, in tables and as the section of its settings.
    pub fn name(self) -> &'static str {
        match self {
            Self::WinnerTakeAll => "winner-take-all",
        }
    }

    /// One line on what it does and where it comes from.
    pub fn summary(self) -> &'static str {
        match self {
            Self::WinnerTakeAll => {
                "Elfes' inverse model with a Gaussian around the best match of each pixel: the baseline of Brandao et al."
            }
        }
    }

    /// What a data set must have for it.
    pub fn needs(self) -> &'static str {
        match self {
            Self::WinnerTakeAll => "stereo pairs, calibration and poses",
        }
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
        })
    }
}
