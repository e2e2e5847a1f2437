//! Whether a run can give a method everything that it needs.

use anyhow::{Result, bail};
use evigrid_core::Mounting;
use evigrid_methods::Entry;
use evigrid_stereo::{Extras, MatcherKind};

use crate::{Config, Recording};

/// `Ok` if the matcher of these settings gives a method what it needs.
pub(crate) fn check_matcher(config: &Config, method: &Entry) -> Result<()> {
    let (needs, name) = (method.needs, method.name);
    check_extra(config, name, "which needs matching costs", needs.costs, |offers| offers.costs)?;
    check_extra(config, name, "which tells road from obstacles by it", needs.road, |offers| offers.road)
}

fn check_extra(
    config: &Config,
    name: &str,
    why: &str,
    is_needed: bool,
    is_offered: fn(Extras) -> bool,
) -> Result<()> {
    let (elsewhere, matcher) = (&config.input.disparity_dir, config.stereo.matcher);
    if !is_needed {
        return Ok(());
    }
    if !elsewhere.is_empty() {
        bail!("input.disparity_dir: expected none for `{name}`, {why}, found `{elsewhere}`");
    }
    if !is_offered(matcher.offers()) {
        let able = MatcherKind::ALL.into_iter().filter(|m| is_offered(m.offers())).map(MatcherKind::name);
        let able: Vec<_> = able.collect();
        let able = if able.is_empty() { "another (none can)".to_owned() } else { able.join(" or ") };
        bail!("stereo.matcher: expected {able} for `{name}`, {why}, found {}", matcher.name());
    }
    Ok(())
}

/// How the camera of a recording stands over the ground: as the user says, else as the data set tells.
///
/// # Errors
/// If neither tells and one of the methods needs it.
pub(crate) fn mounting<'a>(
    config: &Config,
    recording: &Recording,
    methods: impl IntoIterator<Item = &'a Entry>,
) -> Result<Option<Mounting>> {
    let info = recording.sequence().info();
    let mounting = config.input.mounting()?.or(info.mounting);
    if let (None, Some(method)) = (mounting, methods.into_iter().find(|m| m.needs.mounting)) {
        let (name, id) = (method.name, &info.id);
        bail!(
            "input.mounting: expected [height_m, pitch_deg] for `{name}`, which needs the camera's mounting, \
             found none (data set {id} does not tell it)"
        );
    }
    if mounting.is_none() && config.stereo.needs_mounting() {
        let id = &info.id;
        bail!(
            "input.mounting: expected [height_m, pitch_deg] for stereo.matcher double-correlation, found none (data \
             set {id} does not tell it; stereo.double_correlation.ground=v-disparity finds it in the frames)"
        );
    }
    Ok(mounting)
}
