use evigrid_core::require_setting;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use crate::error::StereoError;

/// Graph cuts with occlusions (Kolmogorov and Zabih 2001).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct GraphCutSettings {
    /// Difference of grey levels from which a match costs no more; its square is the largest cost. Unit: grey
    /// levels. Source: Kolmogorov, Monasse, Tan 2014 (30); OpenCV 2 (square root of 1000).
    pub cutoff: usize,
    /// Weight of smoothness; 0: a fifth of the mean cost of a chance match (of each pixel's costs, the one a
    /// quarter of the way up). Unit: squared grey levels. Source: Kolmogorov, Monasse, Tan 2014; OpenCV 2
    /// (stereogc).
    pub lambda: f32,
    /// Cost of a left pixel without a match, above that of one with a perfect match. Unit: lambda. Source:
    /// Kolmogorov and Zabih 2001 (5).
    pub occlusion_penalty: usize,
    /// Penalty where only one of two neighbours with similar grey levels in both images has a disparity.
    /// Unit: lambda. Source: Kolmogorov and Zabih 2001 (3).
    pub smoothness: usize,
    /// Penalty where only one of two neighbours has a disparity and their grey levels differ in either image.
    /// Unit: lambda. Source: Kolmogorov and Zabih 2001 (1).
    pub smoothness_at_edges: usize,
    /// Difference of neighbouring grey levels, in either image, from which there is an edge. Unit: grey
    /// levels. Source: Kolmogorov and Zabih 2001 (8).
    pub edge: usize,
    /// Rounds over all disparities after which the search ends, if it has not converged. Unit: none. Source:
    /// Kolmogorov, Monasse, Tan 2014 (4); OpenCV 2: 3.
    pub max_rounds: usize,
}

impl Default for GraphCutSettings {
    fn default() -> Self {
        Self {
            cutoff: 30,
            lambda: 0.0,
            occlusion_penalty: 5,
            smoothness: 3,
            smoothness_at_edges: 1,
            edge: 8,
            max_rounds: 4,
        }
    }
}

impl GraphCutSettings {
    /// Checks the settings and gives them back.
    ///
    /// # Errors
    /// If a setting is outside its domain: cutoff 1 to 255, lambda 0 to 10000, penalties 0 to 100 (for an
    /// occlusion from 1), edge 0 to 256, rounds 1 to 1000.
    pub fn checked(self) -> Result<Self, StereoError> {
        let require =
            |ok, key, expected: &str, found: usize| require_setting(ok, "stereo", key, expected, found);
        let Self { cutoff, lambda, occlusion_penalty: occlusion, edge, max_rounds: rounds, .. } = self;
        require((1..=255).contains(&cutoff), "graph_cuts.cutoff", "a number from 1 to 255", cutoff)?;
        let possible = (0.0..=10000.0).contains(&lambda);
        require_setting(possible, "stereo", "graph_cuts.lambda", "a number from 0 to 10000", lambda)?;
        let possible = (1..=100).contains(&occlusion);
        require(possible, "graph_cuts.occlusion_penalty", "a number from 1 to 100", occlusion)?;
        for (key, penalty) in [
            ("graph_cuts.smoothness", self.smoothness),
            ("graph_cuts.smoothness_at_edges", self.smoothness_at_edges),
        ] {
            require(penalty <= 100, key, "a number from 0 to 100", penalty)?;
        }
        require(edge <= 256, "graph_cuts.edge", "a number from 0 to 256", edge)?;
        let possible = (1..=1000).contains(&rounds);
        require(possible, "graph_cuts.max_rounds", "a number from 1 to 1000", rounds)?;
        Ok(self)
    }
}
