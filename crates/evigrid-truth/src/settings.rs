use evigrid_core::{SettingError, require_setting};
use evigrid_grid::Clamp;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Where the truth comes from.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum TruthSource {
    /// The laser scans that were recorded beside the cameras.
    #[default]
    Laser,
    /// The shapes of a synthetic world.
    Exact,
}

impl TruthSource {
    /// The name in settings and tables.
    pub fn name(self) -> &'static str {
        match self {
            Self::Laser => "laser",
            Self::Exact => "exact",
        }
    }
}

/// The truth that maps are scored against, and how laser scans become the reference grid.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct TruthSettings {
    /// laser, or exact: the shapes of a synthetic world, over all frames of the run from the first one on.
    /// Unit: none. Source: own protocol.
    pub source: TruthSource,
    /// Rays that end nearer than this are dropped (they hit the vehicle). Unit: m. Source: own protocol.
    pub min_range_m: f64,
    /// Rays that end farther than this are free space up to here. Unit: m. Source: own protocol.
    pub max_range_m: f64,
    /// Evidence of a scan for a cell in which a ray ends. Unit: log-odds. Source: OctoMap's default (0.85).
    pub hit_log_odds: f32,
    /// Evidence of a scan for a cell that a ray crosses. Unit: log-odds. Source: OctoMap's default (-0.4).
    pub miss_log_odds: f32,
    /// Bounds of the fused log-odds. Unit: log-odds. Source: OctoMap's defaults (-2 and 3.5).
    pub log_odds_bounds: [f32; 2],
    /// A cell is occupied if its log-odds ever exceeded this. Unit: log-odds. Source: Brandao et al.
    /// IV-B ("occupied at any time").
    pub occupied_above: f32,
    /// Returns of the laser count as in view of the left camera between these depths. Unit: m. Source: own protocol.
    pub view_depth_m: [f64; 2],
}

impl Default for TruthSettings {
    fn default() -> Self {
        Self {
            source: TruthSource::Laser,
            min_range_m: 1.0,
            max_range_m: 80.0,
            hit_log_odds: 0.85,
            miss_log_odds: -0.4,
            log_odds_bounds: [-2.0, 3.5],
            occupied_above: 0.0,
            view_depth_m: [1.0, 40.0],
        }
    }
}

impl TruthSettings {
    /// Gives the settings back if they are possible.
    ///
    /// # Errors
    /// If the ranges are not 0 <= min < max, or an evidence has the wrong sign,
    /// or the bounds do not enclose 0.
    pub fn checked(self) -> Result<Self, SettingError> {
        let require =
            |ok, key, expected: &str, found: String| require_setting(ok, "truth", key, expected, found);
        let (near, far) = (self.min_range_m, self.max_range_m);
        require(near.is_finite() && near >= 0.0, "min_range_m", "a number from 0", near.to_string())?;
        require(far.is_finite() && far > near, "max_range_m", "more than min_range_m", far.to_string())?;
        let (hit, miss) = (self.hit_log_odds, self.miss_log_odds);
        require(hit.is_finite() && hit > 0.0, "hit_log_odds", "a number above 0", hit.to_string())?;
        require(miss.is_finite() && miss < 0.0, "miss_log_odds", "a number below 0", miss.to_string())?;
        let [min, max] = self.log_odds_bounds;
        let bounded = min.is_finite() && max.is_finite() && min < 0.0 && max > 0.0;
        require(bounded, "log_odds_bounds", "[below 0, above 0]", format!("[{min}, {max}]"))?;
        let [from, to] = self.view_depth_m;
        let ordered = from.is_finite() && from >= 0.0 && to.is_finite() && to > from;
        require(
            ordered,
            "view_depth_m",
            "two finite numbers [from, to] with 0 <= from < to",
            format!("[{from}, {to}]"),
        )?;
        let above = self.occupied_above;
        require(above < max && above > min, "occupied_above", "a number within the bounds", above.to_string())
            .map(|()| self)
    }

    /// The bounds as a clamp.
    pub fn clamp(&self) -> Clamp {
        Clamp { min: self.log_odds_bounds[0], max: self.log_odds_bounds[1] }
    }
}
