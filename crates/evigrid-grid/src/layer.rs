use std::borrow::Cow;

use crate::{LogOddsGrid, PlanGrid, SafetyMap};

/// A kind of map. The list is closed: every `match` over it shows what a new kind costs.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum LayerKind {
    /// Log-odds in three dimensions.
    Voxels,
    /// Probabilities in two dimensions.
    Plan,
    /// Safety labels in two dimensions, with the planes behind them.
    Safety,
}

impl LayerKind {
    /// All kinds, in the order of tables.
    pub const ALL: [Self; 3] = [Self::Voxels, Self::Plan, Self::Safety];

    /// The name for people and in errors.
    pub fn name(self) -> &'static str {
        match self {
            Self::Voxels => "voxels",
            Self::Plan => "plan",
            Self::Safety => "safety",
        }
    }
}

/// One map that a method shows. Borrowed where the method keeps it as it is, owned where it is made for
/// showing.
#[derive(Debug, Clone)]
pub enum Layer<'a> {
    /// Log-odds in three dimensions, in the map frame.
    Voxels(Cow<'a, LogOddsGrid>),
    /// Probabilities in two dimensions, fixed in the map or moving with the vehicle.
    Plan(Cow<'a, PlanGrid>),
    /// Safety labels in two dimensions, in the map frame.
    Safety(Cow<'a, SafetyMap>),
}

impl<'a> Layer<'a> {
    /// Its kind.
    pub fn kind(&self) -> LayerKind {
        match self {
            Self::Voxels(_) => LayerKind::Voxels,
            Self::Plan(_) => LayerKind::Plan,
            Self::Safety(_) => LayerKind::Safety,
        }
    }

    /// The voxels, if this is such a layer.
    pub fn voxels(&self) -> Option<&LogOddsGrid> {
        match self {
            Self::Voxels(map) => Some(map),
            Self::Plan(_) | Self::Safety(_) => None,
        }
    }

    /// The plan, if this is such a layer.
    pub fn plan(&self) -> Option<&PlanGrid> {
        match self {
            Self::Plan(map) => Some(map),
            Self::Voxels(_) | Self::Safety(_) => None,
        }
    }

    /// The safety map, if this is such a layer.
    pub fn safety(&self) -> Option<&SafetyMap> {
        match self {
            Self::Safety(map) => Some(map),
            Self::Voxels(_) | Self::Plan(_) => None,
        }
    }
}

impl<'a> From<&'a LogOddsGrid> for Layer<'a> {
    fn from(map: &'a LogOddsGrid) -> Self {
        Self::Voxels(Cow::Borrowed(map))
    }
}

impl From<LogOddsGrid> for Layer<'_> {
    fn from(map: LogOddsGrid) -> Self {
        Self::Voxels(Cow::Owned(map))
    }
}

impl<'a> From<&'a PlanGrid> for Layer<'a> {
    fn from(map: &'a PlanGrid) -> Self {
        Self::Plan(Cow::Borrowed(map))
    }
}

impl<'a> From<&'a SafetyMap> for Layer<'a> {
    fn from(map: &'a SafetyMap) -> Self {
        Self::Safety(Cow::Borrowed(map))
    }
}
