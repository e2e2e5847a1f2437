//! The five worlds, and maps of them.

use anyhow::{Context, Result};
use evigrid_eval::Config;
use evigrid_synth::World;

/// The worlds that stand for the paper's five data sets.
pub const WORLDS: [&str; 5] = ["safety-1", "safety-2", "safety-3", "safety-4", "safety-5"];

/// How the pairs are matched. The paper uses correlation at several scales, the matcher of Videre, without its
/// settings. Those here are the defaults of ROS's stereo_image_proc, whose block matcher descends from Videre's (a
/// left-right check of 1 px and speckles by steps of 1 px are this program's); with several scales the limits on
/// uniqueness and texture are those of that matcher.
pub const MATCHERS: [(&str, &[&str]); 3] = [
    (
        "multi-scale",
        &[
            "stereo.matcher=multi-scale",
            "stereo.disparities=64",
            "stereo.pre_filter=sobel-x",
            "stereo.window=15",
            "stereo.speckle_pixels=100",
        ],
    ),
    (
        "block",
        &[
            "stereo.disparities=64",
            "stereo.pre_filter=sobel-x",
            "stereo.window=15",
            "stereo.uniqueness_percent=15",
            "stereo.texture_threshold=10",
            "stereo.speckle_pixels=100",
        ],
    ),
    ("exact", &["stereo.matcher=exact"]),
];

/// A map to be made: the name of the matcher, the method, settings of the method, and by how many cells its grid,
/// and that of the truth, is moved along x and y.
#[derive(Debug, Clone, PartialEq)]
pub struct Entry {
    pub matcher: &'static str,
    pub method: &'static str,
    pub sets: Vec<String>,
    pub shift_cells: [f64; 2],
}

impl Entry {
    /// A map on the grid of the world.
    pub fn new(matcher: &'static str, method: &'static str, sets: Vec<String>) -> Self {
        Self { matcher, method, sets, shift_cells: [0.0; 2] }
    }

    /// A map with the paper's settings, decr 1.
    pub fn plain(matcher: &'static str, method: &'static str) -> Self {
        Self::new(matcher, method, vec!["decrement=1".to_owned()])
    }

    /// The settings of a run that makes it.
    pub fn config(&self, world: &World) -> Result<Config> {
        let matcher = MATCHERS.iter().find(|(name, _)| *name == self.matcher);
        let matcher = matcher.with_context(|| format!("no matcher {}", self.matcher))?.1;
        let spec = world.truth_grid();
        let (origin, shape, c) = (spec.origin_m(), spec.shape(), spec.cell_size_m());
        let grid = ["x", "y", "z"].into_iter().enumerate().map(|(a, axis)| {
            let from = origin[a] + self.shift_cells.get(a).map_or(0.0, |cells| cells * c);
            format!("grid.{axis}_m=[{from}, {}]", from + shape[a] as f64 * c)
        });
        let fixed = [format!("grid.cell_size_m={c}"), "truth.source=exact".to_owned()];
        let matcher = matcher.iter().map(|&set| set.to_owned());
        let own = self.sets.iter().map(|set| format!("{}.{set}", self.method));
        let sets: Vec<String> = grid.chain(fixed).chain(matcher).chain(own).collect();
        let mut config = Config::load(None, &sets)?;
        config.run.methods = vec![self.method.to_owned()];
        Ok(config)
    }
}

/// Mean and population deviation.
pub fn mean_and_deviation(values: &[f64]) -> [f64; 2] {
    let count = values.len() as f64;
    let mean = values.iter().sum::<f64>() / count;
    let variance = values.iter().map(|v| (v - mean) * (v - mean)).sum::<f64>() / count;
    [mean, variance.sqrt()]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_are_those_of_the_population() {
        assert_eq!(mean_and_deviation(&[1.0, 3.0]), [2.0, 1.0]);
    }

    #[test]
    fn every_entry_has_a_configuration_on_the_grid_of_its_world() {
        for name in WORLDS {
            let world = World::builtin(name).unwrap();
            for (matcher, _) in MATCHERS {
                let sets = vec!["decrement=3".to_owned()];
                let entry = Entry::new(matcher, "safety-map-plus", sets);
                let config = entry.config(&world).unwrap();
                let spec = evigrid_grid::GridSpec::new(&config.grid).unwrap();
                assert_eq!(
                    (spec.shape(), spec.origin_m()),
                    (world.truth_grid().shape(), world.truth_grid().origin_m())
                );
                assert_eq!(config.methods.table("safety-map-plus")["decrement"].as_integer(), Some(3));
            }
        }
    }
}
