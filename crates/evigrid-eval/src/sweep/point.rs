use anyhow::{Context, Result, bail};
use evigrid_replay::Sequence;
use toml::Value;

use super::axis::Axis;
use super::plan::SweepPlan;
use crate::config::nested;
use crate::plan::{check_settings, run_info};
use crate::tables::settings_hash;
use crate::{Config, Method, RunInfo};

/// One run's worth of settings.
#[derive(Debug)]
pub(super) struct Point {
    /// The only method.
    pub method: Method,
    /// The value of each key of the sweep; `None` where the method does not have it.
    pub values: Vec<Option<Value>>,
    /// What a run of it would be.
    pub info: RunInfo,
    /// Tells it from all points that find something else; its folder's name.
    pub hash: String,
}

impl Point {
    /// A point of a plan on a recording, all settings checked.
    pub fn new(
        plan: &SweepPlan,
        dataset: &str,
        method: Method,
        values: Vec<Option<Value>>,
        sequence: &dyn Sequence,
    ) -> Result<Self> {
        let mut config = plan.base.clone();
        dataset.clone_into(&mut config.run.dataset);
        config.run.methods = vec![method.name().to_owned()];
        config.output = crate::OutputSettings { recording: false, disparity: false };
        for (axis, value) in plan.axes.iter().zip(&values) {
            if let Some(value) = value {
                let origin = format!("{}: {} = {value}", plan.origin, axis.key);
                config = config.with(nested(&axis.key, value.clone()), &origin)?;
            }
        }
        check_settings(&config).with_context(|| plan.origin.clone())?;
        let info = run_info(config, sequence).with_context(|| plan.origin.clone())?;
        Ok(Self { method, values, hash: settings_hash(&info)?, info })
    }

    /// A run by itself, of one method, all settings checked.
    pub fn of_run(config: Config, sequence: &dyn Sequence) -> Result<Self> {
        let [method] = check_settings(&config)?[..] else {
            bail!("run.methods: expected one method, found {}", config.run.methods.join(", "));
        };
        let info = run_info(config, sequence)?;
        Ok(Self { method, values: Vec::new(), hash: settings_hash(&info)?, info })
    }

    /// Data set, method and values in one line.
    pub fn label(&self, axes: &[Axis]) -> String {
        let values = axes.iter().zip(&self.values);
        let values =
            values.filter_map(|(axis, v)| v.as_ref().map(|v| format!(", {} = {}", axis.key, text(v))));
        format!("{} on {}{}", self.method.name(), self.info.dataset, values.collect::<String>())
    }
}

/// A value as it stands in tables.
pub(super) fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Whether a setting says anything to a method: all but the sections of other methods do.
pub(super) fn applies(key: &str, method: Method) -> bool {
    let section = key.split('.').next().unwrap_or(key);
    Method::from_name(section).is_none_or(|owner| owner == method)
}

/// All combinations of the values of a method's keys, the last key's the fastest.
pub(super) fn combinations(plan: &SweepPlan, method: Method) -> Vec<Vec<Option<Value>>> {
    let mut all = vec![Vec::new()];
    for axis in &plan.axes {
        let values: Vec<Option<Value>> = if applies(&axis.key, method) {
            axis.values.iter().cloned().map(Some).collect()
        } else {
            vec![None]
        };
        all = all
            .iter()
            .flat_map(|before| values.iter().map(|v| [&before[..], std::slice::from_ref(v)].concat()))
            .collect();
    }
    all
}
