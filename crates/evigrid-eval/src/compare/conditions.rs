//! What must be the same for two runs to be comparable, and what may differ but should be known.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Result, bail};
use serde_json::Value;

use super::run_folder::RunFolder;
use crate::Config;

/// Sections of the settings that say what maps are measured by. They must be the same.
const CONDITIONS: [&str; 3] = ["grid", "truth", "score"];
/// Sections that do not change a score: where the recording lies (its name and frames are compared), what is written.
const WITHOUT_EFFECT: [&str; 2] = ["run", "output"];
/// Share of the reference's cells that may differ: not every machine rounds a synthetic world alike.
const REFERENCE_TOLERANCE: f64 = 0.001;

type Facts = BTreeMap<String, String>;

/// Nothing, if the two runs were made under the same conditions.
///
/// # Errors
/// Names all conditions that differ.
pub(super) fn check_conditions(base: &RunFolder, new: &RunFolder) -> Result<()> {
    let mut found = differences(&conditions(base)?, &conditions(new)?);
    if found.is_empty() {
        found = reference_differences(base, new);
    }
    if !found.is_empty() {
        bail!(
            "expected two runs under the same conditions, found: {}: {} and {}",
            found.join("; "),
            base.dir.display(),
            new.dir.display()
        );
    }
    Ok(())
}

/// What differs and may: the settings under test, the program, the machine.
///
/// # Errors
/// Never.
pub(super) fn notes(base: &RunFolder, new: &RunFolder) -> Result<Vec<String>> {
    let under_test = |section: &str| !CONDITIONS.contains(&section) && !WITHOUT_EFFECT.contains(&section);
    let settings = differences(&settings(base, under_test)?, &settings(new, under_test)?);
    let mut build = [Facts::new(), Facts::new()];
    flatten("", &base.run.build, &mut build[0]);
    flatten("", &new.run.build, &mut build[1]);
    let build = differences(&build[0], &build[1]);
    let line = |about: &str, found: Vec<String>| {
        (!found.is_empty()).then(|| format!("{about}: {}", found.join("; ")))
    };
    Ok(line("settings differ", settings).into_iter().chain(line("builds differ", build)).collect())
}

fn conditions(folder: &RunFolder) -> Result<Facts> {
    let run = &folder.run;
    let frames = &run.frames;
    let mut facts = settings(folder, |section| CONDITIONS.contains(&section))?;
    facts.extend([
        ("data set".to_owned(), run.dataset.clone()),
        ("layout".to_owned(), run.layout.clone()),
        ("frames".to_owned(), format!("{} of {} to {}", frames.count, frames.first, frames.last)),
        ("stride".to_owned(), frames.stride.to_string()),
        ("frames without laser".to_owned(), format!("{:?}", frames.without_laser)),
    ]);
    Ok(facts)
}

/// The settings of some sections. One that a run of an earlier version did not know has its default.
fn settings(folder: &RunFolder, wanted: impl Fn(&str) -> bool) -> Result<Facts> {
    let mut facts = Facts::new();
    flatten("", &serde_json::to_value(Config::default())?, &mut facts);
    flatten("", &folder.run.settings, &mut facts);
    facts.retain(|key, _| wanted(key.split('.').next().unwrap_or_default()));
    Ok(facts)
}

/// `{ a: { b: 1 } }` as `a.b` = `1`.
fn flatten(prefix: &str, value: &Value, facts: &mut Facts) {
    match value.as_object() {
        Some(object) => {
            for (key, value) in object {
                let dot = if prefix.is_empty() { "" } else { "." };
                flatten(&format!("{prefix}{dot}{key}"), value, facts);
            }
        }
        None => {
            facts.insert(prefix.to_owned(), value.to_string());
        }
    }
}

fn differences(base: &Facts, new: &Facts) -> Vec<String> {
    let keys: BTreeSet<_> = base.keys().chain(new.keys()).collect();
    let text = |facts: &Facts, key: &String| facts.get(key).map_or("none", String::as_str).to_owned();
    let differs = |key: &&String| base.get(*key) != new.get(*key);
    keys.into_iter()
        .filter(differs)
        .map(|key| format!("{key} {} in BASE, {} in NEW", text(base, key), text(new, key)))
        .collect()
}

/// With the same settings the reference differs only if the recording or the making of the reference has changed.
fn reference_differences(base: &RunFolder, new: &RunFolder) -> Vec<String> {
    let count = |folder: &RunFolder, column: &str| {
        folder.methods.iter().find_map(|m| m.values.get(column).copied().flatten()).unwrap_or(0.0)
    };
    ["true_cells", "observed_cells"]
        .into_iter()
        .map(|column| (column, count(base, column), count(new, column)))
        .filter(|(_, base, new)| (base - new).abs() > REFERENCE_TOLERANCE * base)
        .map(|(column, base, new)| {
            format!(
                "{column} of the reference {base} in BASE, {new} in NEW \
                 (the recording or the making of its reference has changed)"
            )
        })
        .collect()
}
