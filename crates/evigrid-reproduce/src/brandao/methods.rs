//! The methods and settings that are compared: the one place to add another.

use anyhow::Result;
use evigrid_cost_curve::{CostCurve, CostCurveBayes, WinnerTakeAll};
use evigrid_eval::Config;
use evigrid_grid::Method;

/// A method under settings that have a name.
#[derive(Debug, Clone)]
pub struct Reading {
    /// For legends and tables.
    pub name: String,
    pub method: &'static str,
    /// `SECTION.KEY=VALUE`; none: the method's defaults.
    pub sets: Vec<String>,
    /// The paper's words on it, if any.
    pub paper: &'static str,
}

/// A line of the list below.
struct Listed {
    name: &'static str,
    method: &'static str,
    sets: &'static [&'static str],
    /// Whether a frame takes far below a second.
    quick: bool,
}

const fn quick(name: &'static str, method: &'static str, sets: &'static [&'static str]) -> Listed {
    Listed { name, method, sets, quick: true }
}

/// Every whole-curve method under every reading of what the paper leaves open, none with the left-right
/// check. The first of a method is what recordings show.
const WHOLE_CURVE: [Listed; 7] = [
    quick("whole curve, grey levels", CostCurve::NAME, &[]),
    quick("whole curve, homogeneous", CostCurve::NAME, &["cost-curve.cost_unit=homogeneous"]),
    quick("whole curve, intensities 0..1", CostCurve::NAME, &["cost-curve.cost_unit=unit-intensities"]),
    quick("whole curve, grey levels, variance / 30", CostCurve::NAME, &["cost-curve.variance_factor=0.0333"]),
    quick("cost-curve-bayes (our own)", CostCurveBayes::NAME, &["cost-curve-bayes.left_right_check=false"]),
    quick(
        "whole curve, homogeneous, eq. 6",
        CostCurve::NAME,
        &["cost-curve.cost_unit=homogeneous", "cost-curve.free_space_model=true"],
    ),
    Listed {
        name: "whole curve, homogeneous, spread over cells",
        method: CostCurve::NAME,
        sets: &["cost-curve.cost_unit=homogeneous", "cost-curve.hypotheses_to_cells=spread-over-cells"],
        quick: false,
    },
];

/// End of the name of a reading with the left-right check.
pub const CHECKED: &str = ", left-right check";

/// Depth up to which maps are compared, unless said otherwise: the default of the whole curve, metres.
pub const DEPTH_M: f64 = 40.0;

/// Every whole-curve method, with what the paper says of it.
pub fn whole_curve(paper: &'static str) -> Vec<Reading> {
    WHOLE_CURVE.iter().map(|listed| listed.reading(paper)).collect()
}

/// Those of them that can be run many times.
pub fn quick_whole_curve(paper: &'static str) -> Vec<Reading> {
    WHOLE_CURVE.iter().filter(|listed| listed.quick).map(|listed| listed.reading(paper)).collect()
}

impl Listed {
    fn reading(&self, paper: &'static str) -> Reading {
        let sets = self.sets.iter().map(|&set| set.to_owned()).collect();
        // What the paper says, it says of its own method.
        let paper = if self.method == CostCurve::NAME { paper } else { "" };
        Reading { name: self.name.to_owned(), method: self.method, sets, paper }.within_depth(DEPTH_M)
    }
}

/// The paper's baseline: filtered by the peak ratio alone.
pub fn winner_take_all(peak_ratio: f64, paper: &'static str) -> Reading {
    Reading {
        name: format!("winner-take-all, peak ratio {peak_ratio}"),
        method: WinnerTakeAll::NAME,
        sets: vec![
            format!("winner-take-all.peak_ratio={peak_ratio}"),
            "winner-take-all.left_right_check=false".into(),
        ],
        paper,
    }
    .within_depth(DEPTH_M)
}

impl Reading {
    /// The reading up to another depth.
    pub fn within_depth(mut self, depth_m: f64) -> Self {
        self.set("max_depth_m", &depth_m.to_string());
        self
    }

    /// The reading with the left-right check.
    pub fn checked(mut self) -> Self {
        self.set("left_right_check", "true");
        self.name += CHECKED;
        self
    }

    /// The reading without the left-right check.
    pub fn unchecked(mut self) -> Self {
        self.set("left_right_check", "false");
        self
    }

    /// Gives a setting of the method a value, once.
    fn set(&mut self, key: &str, value: &str) {
        let key = format!("{}.{key}=", self.method);
        self.sets.retain(|set| !set.starts_with(&key));
        self.sets.push(format!("{key}{value}"));
    }

    /// All settings of a run on a recording; `base` holds what all runs have in common.
    pub fn config(&self, base: &[String]) -> Result<Config> {
        let sets = [base, &self.sets[..]].concat();
        let mut config = Config::load(None, &sets)?;
        config.run.methods = vec![self.method.to_owned()];
        Ok(config)
    }
}
