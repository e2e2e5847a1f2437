//! Maps of one drive under many errors of motion.

use anyhow::{Context, Result};
use evigrid_eval::{Clock, Config, Mapped, Recording, map_together};
use evigrid_metrics::Counts;

use super::robot::Surfaces;

/// Assumptions on the error of the motion, and the prior of the map.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Setting {
    /// Every frame, metres, and per metre driven.
    pub eps_m: f64,
    pub eps_per_m: f64,
    pub prior: f64,
}

const CONSTANT_M: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0];
const PER_METRE: [f64; 6] = [0.02, 0.05, 0.1, 0.2, 0.5, 1.0];
/// Priors beside 0.5, and the errors per metre that they are tried with.
const PRIORS: [f64; 2] = [0.3, 0.7];
const WITH_PRIORS: [f64; 2] = [0.0, 0.05];

/// All that are compared; the first is Andert's model.
pub fn settings() -> Vec<Setting> {
    let plain = Setting { eps_m: 0.0, eps_per_m: 0.0, prior: 0.5 };
    let mut all = vec![plain];
    all.extend(CONSTANT_M.map(|eps_m| Setting { eps_m, ..plain }));
    all.extend(PER_METRE.map(|eps_per_m| Setting { eps_per_m, ..plain }));
    for prior in PRIORS {
        all.extend(WITH_PRIORS.map(|eps_per_m| Setting { eps_per_m, prior, ..plain }));
    }
    all
}

/// Those that grow with the way, from Andert's model on: for drives that are made many times.
pub fn growing_settings() -> Vec<Setting> {
    settings().into_iter().filter(|s| s.prior == 0.5 && s.eps_m == 0.0).collect()
}

impl Setting {
    pub fn sets(&self) -> Vec<String> {
        vec![
            format!("souza.motion_error_m={}", self.eps_m),
            format!("souza.motion_error_per_m={}", self.eps_per_m),
            format!("souza.prior_probability={}", self.prior),
        ]
    }
}

/// One map's scores.
#[derive(Debug, Clone)]
pub struct Scored {
    pub setting: Setting,
    pub counts: Counts,
}

/// Some settings on one recording; scored against `surfaces`, or the laser of the recording itself.
/// With them comes that reference.
pub fn sweep(
    settings: Vec<Setting>,
    recording: &Recording,
    config: &dyn Fn(&[String]) -> Result<Config>,
    surfaces: Option<&Surfaces>,
    clock: &dyn Clock,
) -> Result<(Vec<Scored>, Option<Surfaces>)> {
    let configs: Result<Vec<Config>> = settings.iter().map(|setting| config(&setting.sets())).collect();
    let look = |mapped: &Mapped<'_>| {
        let own = Surfaces::of(mapped);
        let reference = surfaces.or(own.as_ref()).context("a recording without a laser")?;
        Ok((reference.counts(mapped.voxels()?), own))
    };
    let found = map_together(recording, configs?, clock, &look, &mut || {})?;
    let mut own = None;
    let scored = settings.into_iter().zip(found).map(|(setting, (counts, surfaces))| {
        own = surfaces;
        Scored { setting, counts }
    });
    let scored = scored.collect();
    Ok((scored, own))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_settings_differ_and_the_first_is_andert() {
        let all = settings();
        assert_eq!(all[0], Setting { eps_m: 0.0, eps_per_m: 0.0, prior: 0.5 });
        assert!((1..all.len()).all(|n| !all[..n].contains(&all[n])));
        assert_eq!(all.len(), 17);
    }
}
