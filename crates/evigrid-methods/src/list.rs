//! The built-in methods, in the order in which they are listed.

use evigrid_cost_curve::{CostCurve, CostCurveBayes, WinnerTakeAll};
use evigrid_inverse_model::{Line, LinePyramid, Ray, RayPyramid, Souza};
use evigrid_safety_map::{SafetyMapping, SafetyMappingPlus};
use evigrid_udisparity::{Ternary, Visibility, VisibilityFiltered};

use crate::Entry;

/// One line per method.
pub(crate) const BUILT_IN: &[Entry] = &[
    Entry::of::<WinnerTakeAll>(),
    Entry::of::<CostCurve>(),
    Entry::of::<CostCurveBayes>(),
    Entry::of::<Line>(),
    Entry::of::<LinePyramid>(),
    Entry::of::<Ray>(),
    Entry::of::<RayPyramid>(),
    Entry::of::<Souza>(),
    Entry::of::<SafetyMapping>(),
    Entry::of::<SafetyMappingPlus>(),
    Entry::of::<Visibility>(),
    Entry::of::<VisibilityFiltered>(),
    Entry::of::<Ternary>(),
];
