use std::fmt;

use evigrid_core::SettingError;
use schemars::JsonSchema;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::{GridSpec, LayerKind, Mapper, MapperFamily};

/// The inputs of a method beyond rig, pose and images. A run that cannot give them is refused before the
/// first frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct Needs {
    /// Matches ([`evigrid_core::View::matches`]).
    pub matches: bool,
    /// The whole cost volume ([`evigrid_core::View::volume`]).
    pub costs: bool,
    /// Road and obstacles apart ([`evigrid_core::View::road`]).
    pub road: bool,
    /// How the camera stands over the ground ([`evigrid_core::View::mounting`]).
    pub mounting: bool,
}

impl Needs {
    /// Rig, pose and images alone.
    pub const NOTHING: Self = Self { matches: false, costs: false, road: false, mounting: false };
    /// Matches.
    pub const MATCHES: Self = Self { matches: true, ..Self::NOTHING };
    /// Matches, and the costs of all hypotheses.
    pub const COSTS: Self = Self { costs: true, ..Self::MATCHES };

    /// Everything that either needs.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            matches: self.matches | other.matches,
            costs: self.costs | other.costs,
            road: self.road | other.road,
            mounting: self.mounting | other.mounting,
        }
    }
}

impl fmt::Display for Needs {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("stereo pairs, calibration and poses")?;
        if self.mounting {
            f.write_str("; how the camera stands over the ground")?;
        }
        if self.road {
            f.write_str("; a matcher that tells road from obstacles")?;
        }
        if self.costs {
            f.write_str("; matching costs, so no disparities from elsewhere")?;
        }
        Ok(())
    }
}

/// A mapping method: its name, what it needs and shows, its settings, and how an empty map of it is made. It
/// stands beside the settings; a program lists the types it wants to offer.
pub trait Method: 'static {
    /// The name on the command line, in tables, and as the section of its settings.
    const NAME: &'static str;
    /// One line on what it does and where it comes from.
    const SUMMARY: &'static str;
    /// The inputs that it cannot do without.
    const NEEDS: Needs;
    /// The kinds of maps that it shows after every frame.
    const LAYERS: &'static [LayerKind];
    /// Its settings; the doc comment of every field states meaning, unit and source.
    type Settings: Clone + PartialEq + Default + Serialize + DeserializeOwned + JsonSchema + Send + Sync;

    /// `Ok` if the settings are possible. By default all that their types allow are.
    ///
    /// # Errors
    /// If one is outside its domain; the error names it, with the domain and the value.
    fn check(_settings: &Self::Settings) -> Result<(), SettingError> {
        Ok(())
    }

    /// An empty map over a grid.
    ///
    /// # Errors
    /// As [`Self::check`].
    fn build(spec: GridSpec, settings: &Self::Settings) -> Result<Box<dyn Mapper>, SettingError>;

    /// Whether maps under two different settings are cheaper together than each by itself. By default none
    /// are.
    fn shares(_a: &Self::Settings, _b: &Self::Settings) -> bool {
        false
    }

    /// Empty maps for settings of which all pairs share, at least two. Only called where [`Self::shares`]
    /// says so.
    ///
    /// # Errors
    /// As [`Self::check`].
    fn build_family(
        _spec: GridSpec,
        _settings: &[Self::Settings],
    ) -> Result<Option<Box<dyn MapperFamily>>, SettingError> {
        Ok(None)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn needs_add_up_and_are_named() {
        let both = Needs::COSTS.and(Needs { mounting: true, ..Needs::NOTHING });
        assert!(both.matches && both.costs && both.mounting && !both.road);
        assert!(both.to_string().contains("over the ground; matching costs"));
        assert_eq!(Needs::MATCHES.to_string(), "stereo pairs, calibration and poses");
    }
}
