use std::fmt::Write as _;

use anyhow::Result;
use evigrid_eval::{Config, Method};
use serde_json::Value;

use crate::output::print;

/// `evigrid methods`: what there is to set, from the doc comments of the settings themselves.
pub fn methods() -> Result<()> {
    let schema = serde_json::to_value(schemars::schema_for!(Config))?;
    let defaults = serde_json::to_value(Config::default())?;
    let mut text = String::from("Methods (--method NAME)\n\n");
    for method in Method::ALL {
        let _ = writeln!(text, "{}\n  {}\n  Needs {}.", method.name(), method.summary(), method.needs());
        text.push_str(&settings(&schema, &defaults, method.name()));
    }
    text.push_str("\nSettings that all methods share (--set SECTION.KEY=VALUE, or --config FILE)\n");
    let sections = defaults.as_object().into_iter().flatten().map(|(name, _)| name);
    for section in sections.filter(|name| Method::from_name(name).is_none()) {
        let _ = writeln!(text, "\n{section}");
        text.push_str(&settings(&schema, &defaults, section));
    }
    print(&text)
}

/// One block per setting of a section: key, default, unit, meaning and source.
fn settings(schema: &Value, defaults: &Value, section: &str) -> String {
    let mut text = String::new();
    let Some(settings) = section_schema(schema, section)["properties"].as_object() else { return text };
    for (key, about) in settings {
        let words: Vec<_> = about["description"].as_str().unwrap_or("").split_whitespace().collect();
        let words = words.join(" ");
        let (meaning, rest) = words.split_once(" Unit: ").unwrap_or((&words, ""));
        let (unit, source) = rest.split_once(" Source: ").unwrap_or((rest, ""));
        let unit = unit.trim_end_matches('.');
        let unit = if unit == "none" || unit.is_empty() { String::new() } else { format!(" {unit}") };
        let default = &defaults[section][key];
        let _ = writeln!(text, "  {section}.{key} = {default}{unit}\n      {meaning}");
        let _ = writeln!(text, "      Source: {source}");
    }
    text
}

/// The schema of a section, wherever the schema of all settings keeps it.
fn section_schema<'a>(schema: &'a Value, section: &str) -> &'a Value {
    let here = &schema["properties"][section];
    match here["$ref"].as_str() {
        Some(reference) => schema.pointer(reference.trim_start_matches('#')).unwrap_or(here),
        None => here,
    }
}
