//! Conditions that two comparable runs share, and differences that should be known.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Result, bail};
use evigrid_metrics::{Kind, METRICS};
use serde_json::Value;

use super::run_folder::RunFolder;

/// Sections of the settings that say how maps are measured. They must be the same.
const CONDITIONS: [&str; 3] = ["grid", "truth", "score"];
/// Sections that do not change a score: the place of the recording (its name and frames are compared), the
/// files that are written.
const WITHOUT_EFFECT: [&str; 2] = ["run", "output"];
/// Settings and other facts by name.
type Facts = BTreeMap<String, String>;

/// Nothing, if the two runs were made under the same conditions.
///
/// # Errors
/// Names all conditions that differ.
pub(super) fn check_conditions(base: &RunFolder, new: &RunFolder, defaults: &Value) -> Result<()> {
    let mut found = differences(&conditions(base, defaults), &conditions(new, defaults));
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

/// Differences that do not matter for the comparison: the settings under test, the program, the machine.
pub(super) fn notes(base: &RunFolder, new: &RunFolder, defaults: &Value) -> Vec<String> {
    let under_test = |section: &str| !CONDITIONS.contains(&section) && !WITHOUT_EFFECT.contains(&section);
    let settings = differences(&settings(base, defaults, under_test), &settings(new, defaults, under_test));
    let mut build = [Facts::new(), Facts::new()];
    flatten("", &base.run.build, &mut build[0]);
    flatten("", &new.run.build, &mut build[1]);
    let build = differences(&build[0], &build[1]);
    let line = |about: &str, found: Vec<String>| {
        (!found.is_empty()).then(|| format!("{about}: {}", found.join("; ")))
    };
    line("settings differ", settings).into_iter().chain(line("builds differ", build)).collect()
}

fn conditions(folder: &RunFolder, defaults: &Value) -> Facts {
    let run = &folder.run;
    let frames = &run.frames;
    let mut facts = settings(folder, defaults, |section| CONDITIONS.contains(&section));
    facts.extend([
        ("data set".to_owned(), run.dataset.clone()),
        ("layout".to_owned(), run.layout.clone()),
        ("frames".to_owned(), format!("{} of {} to {}", frames.count, frames.first, frames.last)),
        ("stride".to_owned(), frames.stride.to_string()),
        ("frames without laser".to_owned(), format!("{:?}", frames.without_laser)),
    ]);
    facts
}

/// The settings of some sections. One that a run of an earlier version did not know has its default.
fn settings(folder: &RunFolder, defaults: &Value, wanted: impl Fn(&str) -> bool) -> Facts {
    let mut facts = Facts::new();
    flatten("", defaults, &mut facts);
    flatten("", &folder.run.settings, &mut facts);
    facts.retain(|key, _| wanted(key.split('.').next().unwrap_or_default()));
    facts
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

/// With the same settings the reference differs only if the recording or the making of the reference has
/// changed.
fn reference_differences(base: &RunFolder, new: &RunFolder) -> Vec<String> {
    let mut found = Vec::new();
    for metric in METRICS.iter().filter(|m| m.kind == Kind::Reference) {
        let (Some(before), Some(after)) = (base.value(metric.name), new.value(metric.name)) else { continue };
        if (before - after).abs() > metric.tolerance.limit(before) {
            found.push(format!(
                "{} of the reference {before} in BASE, {after} in NEW \
                 (the recording or the making of its reference has changed)",
                metric.name
            ));
        }
    }
    found
}
