use std::path::Path;

use anyhow::{Context, Result, bail};
use evigrid_core::name_hint;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

use super::axis::{Axis, is_range};
use super::plan::SweepPlan;
use crate::config::{nested, one_line, read_table};
use crate::{Config, RunSettings};

/// The part of a plan before the sections of settings.
#[derive(Debug, Serialize, Deserialize)]
#[serde(default)]
struct Head {
    name: String,
    datasets: Vec<String>,
    methods: Vec<String>,
    frames: String,
    stride: usize,
    maps: bool,
    sweep: Table,
}

impl Default for Head {
    fn default() -> Self {
        let RunSettings { dataset, methods, frames, stride } = RunSettings::default();
        Self {
            name: String::new(),
            datasets: vec![dataset],
            methods,
            frames,
            stride,
            maps: false,
            sweep: Table::new(),
        }
    }
}

/// The sections of a run that a plan does without: it has lists of its own, and records nothing.
const NOT_IN_PLANS: [&str; 2] = ["run", "output"];

impl SweepPlan {
    /// Reads a plan. Its name is that of the file, unless it has one.
    ///
    /// # Errors
    /// If the file cannot be read, is no TOML, has a key that does not exist or an empty range.
    pub fn read(path: &Path) -> Result<Self> {
        let origin = path.display().to_string();
        let (head, sections) = split(read_table(path)?, &origin)?;
        let base = Config::default().with(sections, &origin)?;
        let head: Head = Value::Table(head)
            .try_into()
            .map_err(|e: toml::de::Error| anyhow::anyhow!("{origin}: {}", one_line(&e.to_string())))?;
        let stem = || path.file_stem().map(|s| s.to_string_lossy().into_owned()).unwrap_or_default();
        let name = if head.name.is_empty() { stem() } else { head.name };
        if name.starts_with('.') || name.contains(['/', '\\']) {
            bail!("{origin}: name: expected a name for a folder, found `{name}`");
        }
        let mut axes = Vec::new();
        collect_axes(head.sweep, "", &origin, &mut axes)?;
        axes.sort_by(|a: &Axis, b| a.key.cmp(&b.key));
        if let Some(pair) = axes.windows(2).find(|pair| pair[0].key == pair[1].key) {
            bail!("{origin}: sweep: expected every setting once, found `{}` twice", pair[0].key);
        }
        let run = RunSettings { methods: head.methods, frames: head.frames, stride: head.stride, ..base.run };
        Ok(Self {
            origin,
            name,
            datasets: head.datasets,
            maps: head.maps,
            base: Config { run, ..base },
            axes,
        })
    }

    /// The plan with every setting and every value, to be read again.
    pub(super) fn to_toml(&self) -> Result<String> {
        let run = &self.base.run;
        let head = Head {
            name: self.name.clone(),
            datasets: self.datasets.clone(),
            methods: run.methods.clone(),
            frames: run.frames.clone(),
            stride: run.stride,
            maps: self.maps,
            sweep: self.axes.iter().map(|a| (a.key.clone(), Value::Array(a.values.clone()))).collect(),
        };
        let mut table = Table::try_from(head).context("cannot write the plan as TOML")?;
        let settings = self.base.to_table()?;
        table.extend(settings.into_iter().filter(|(name, _)| !NOT_IN_PLANS.contains(&name.as_str())));
        Ok(toml::to_string(&table)?)
    }
}

/// The head of a plan and its sections of settings; no other key is allowed.
fn split(plan: Table, origin: &str) -> Result<(Table, Table)> {
    let head_keys = Table::try_from(Head::default())?;
    let mut sections = Config::default().to_table()?;
    sections.retain(|name, _| !NOT_IN_PLANS.contains(&name));
    if let Some(key) = plan.keys().find(|k| !head_keys.contains_key(*k) && !sections.contains_key(*k)) {
        let hint = name_hint(key, head_keys.keys().chain(sections.keys()));
        bail!("{origin}: unknown key `{key}`{hint}");
    }
    Ok(plan.into_iter().partition(|(key, _)| head_keys.contains_key(key)))
}

/// The swept settings of a table whose keys may hold their section or stand below it.
fn collect_axes(table: Table, section: &str, origin: &str, axes: &mut Vec<Axis>) -> Result<()> {
    for (key, value) in table {
        let key = format!("{section}{key}");
        match value {
            Value::Table(inner) if !is_range(&inner) => {
                collect_axes(inner, &format!("{key}."), origin, axes)?
            }
            values => {
                let origin = format!("{origin}: sweep.{key}");
                let axis = Axis::new(key, values, &origin)?;
                // A key that does not exist is found here, before a data set is opened.
                let with_first = nested(&axis.key, axis.values[0].clone());
                Config::default().with(with_first, &origin)?;
                axes.push(axis);
            }
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn read(text: &str) -> Result<SweepPlan> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("my.toml");
        std::fs::write(&path, text).unwrap();
        SweepPlan::read(&path)
    }

    const PLAN: &str = r#"
        datasets = ["synth:street", "synth:yard"]
        frames = "0..3"
        [stereo]
        disparities = 64
        [sweep]
        winner-take-all.peak_ratio = { from = 1.5, to = 12, step = 0.5 }
        "stereo.window" = [5, 7]
        [sweep.winner-take-all]
    "#;

    #[test]
    fn a_plan_has_a_grid_over_its_base() {
        let plan = read(PLAN.trim_end().trim_end_matches("[sweep.winner-take-all]")).unwrap();
        assert_eq!((plan.name.as_str(), plan.datasets.len(), plan.base.stereo.disparities), ("my", 2, 64));
        assert_eq!(plan.base.run.frames, "0..3");
        let sizes: Vec<_> = plan.axes.iter().map(|a| (a.key.as_str(), a.values.len())).collect();
        assert_eq!(sizes, [("stereo.window", 2), ("winner-take-all.peak_ratio", 22)]);
    }

    #[test]
    fn what_is_written_can_be_read_again() {
        let plan = read(PLAN.trim_end().trim_end_matches("[sweep.winner-take-all]")).unwrap();
        let again = read(&plan.to_toml().unwrap()).unwrap();
        assert_eq!(SweepPlan { origin: plan.origin.clone(), ..again }, plan);
    }

    #[test]
    fn wrong_plans_are_named_in_one_line() {
        for (text, part) in [
            ("dataset = 3", "my.toml: unknown key `dataset` (did you mean `datasets`?)"),
            ("datasets = 3", "my.toml: "),
            ("[run]\nstride = 2", "unknown key `run`"),
            ("[stereo]\nwindw = 3", "my.toml: unknown setting `stereo.windw`"),
            ("[sweep]\n\"stereo.windw\" = [3]", "sweep.stereo.windw: unknown setting"),
            ("[sweep]\nstereo.window = [wide]", "line 2"),
            ("[sweep]\nstereo.window = [\"wide\"]", "sweep.stereo.window: "),
            ("[sweep]\nstereo.window = []", "sweep.stereo.window: expected at least one value"),
            ("[sweep]\nstereo.window = 7", "sweep.stereo.window: expected a list of values"),
            ("[sweep]\nstereo.window = { from = 3, to = 1, step = 1 }", "at least one value, found 3..1"),
            ("[sweep]\nstereo.window = { from = 3, to = 7, step = 0 }", "a step above 0, found 0"),
            ("[sweep]\nstereo.window = { from = 3, too = 7, step = 1 }", "found `too`"),
            ("[sweep]\nstereo.window = { from = 3, to = 7 }", "step is missing"),
            ("[sweep]\nstereo = [3]", "`stereo` is a section"),
            ("name = \"../x\"", "expected a name for a folder"),
            ("[sweep]\n\"stereo.window\" = [3]\nstereo.window = [5]", "`stereo.window` twice"),
        ] {
            let message = format!("{:#}", read(text).unwrap_err());
            assert!(
                message.contains(part) && message.contains("my.toml") && !message.contains('\n'),
                "{message}"
            );
        }
    }
}
