use anyhow::{Context, Result, bail};
use evigrid_methods::{Entry, Methods};
use toml::Value;

use super::axis::Axis;
use super::plan::SweepPlan;
use crate::config::nested;
use crate::pass::Entrant;
use crate::plan::{RunJob, check_settings};
use crate::{Config, OutputSettings, Recording};

/// One run's worth of settings.
#[derive(Debug)]
pub(super) struct Point {
    /// The value of each key of the sweep; `None` where the method does not have it.
    pub values: Vec<Option<Value>>,
    /// The run of this point, with one method.
    pub job: RunJob,
}

impl Point {
    /// A point of a plan on a recording, all settings checked.
    ///
    /// # Errors
    /// If a setting is outside its domain, or the recording lacks what it asks for.
    pub fn new(
        plan: &SweepPlan,
        dataset: &str,
        method: &Entry,
        values: Vec<Option<Value>>,
        recording: &Recording,
    ) -> Result<Self> {
        let mut config = plan.base.clone();
        dataset.clone_into(&mut config.run.dataset);
        config.run.methods = vec![method.name.to_owned()];
        config.output = OutputSettings { recording: false, disparity: false };
        for (axis, value) in plan.axes.iter().zip(&values) {
            if let Some(value) = value {
                let origin = format!("{}: {} = {value}", plan.origin, axis.key);
                config = config.with(nested(&axis.key, value.clone()), &origin)?;
            }
        }
        let methods = check_settings(&config).with_context(|| plan.origin.clone())?;
        let job = RunJob::new(config, methods, recording).with_context(|| plan.origin.clone())?;
        Ok(Self { values, job })
    }

    /// A run by itself, of one method, all settings checked.
    ///
    /// # Errors
    /// As [`Self::new`], or if there is more than one method.
    pub fn of_run(config: Config, recording: &Recording) -> Result<Self> {
        let methods = check_settings(&config)?;
        if methods.len() != 1 {
            bail!("run.methods: expected one method, found {}", config.run.methods.join(", "));
        }
        Ok(Self { values: Vec::new(), job: RunJob::new(config, methods, recording)? })
    }

    /// The map of this point in a pass.
    pub fn entrant(&self) -> Entrant<'_> {
        Entrant { job: &self.job, method: 0 }
    }

    /// Name of the method.
    pub fn method(&self) -> &'static str {
        self.entrant().name()
    }

    /// The name of its folder: it tells the point from all that use other settings.
    pub fn hash(&self) -> &str {
        &self.job.info.settings.hash
    }

    /// Data set, method and values in one line.
    pub fn label(&self, axes: &[Axis]) -> String {
        let values = axes.iter().zip(&self.values);
        let values =
            values.filter_map(|(axis, v)| v.as_ref().map(|v| format!(", {} = {}", axis.key, text(v))));
        format!("{} on {}{}", self.method(), self.job.info.dataset, values.collect::<String>())
    }
}

/// A value as it stands in tables.
pub(super) fn text(value: &Value) -> String {
    value.as_str().map_or_else(|| value.to_string(), str::to_owned)
}

/// Whether a setting says anything to a method: all but the sections of other methods do.
pub(super) fn applies(key: &str, method: &Entry, all: &Methods) -> bool {
    let section = key.split('.').next().unwrap_or(key);
    all.find(section).is_none_or(|owner| owner.name == method.name)
}

/// All combinations of the values of a method's keys, the last key's the fastest.
pub(super) fn combinations(plan: &SweepPlan, method: &Entry) -> Vec<Vec<Option<Value>>> {
    let mut all = vec![Vec::new()];
    for axis in &plan.axes {
        let values: Vec<Option<Value>> = if applies(&axis.key, method, plan.base.methods.methods()) {
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
