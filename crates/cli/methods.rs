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
        let defaults = &defaults[method.name()];
        text.push_str(&settings(&schema, section_schema(&schema, method.name()), defaults, method.name()));
    }
    text.push_str("\nSettings that all methods share (--set SECTION.KEY=VALUE, or --config FILE)\n");
    let sections = defaults.as_object().into_iter().flatten().map(|(name, _)| name);
    for section in sections.filter(|name| Method::from_name(name).is_none()) {
        let _ = writeln!(text, "\n{section}");
        text.push_str(&settings(&schema, section_schema(&schema, section), &defaults[section], section));
    }
    print(&text)
}

/// One block per setting of a section: key, default, unit, meaning and source. Sections within it follow.
fn settings(schema: &Value, here: &Value, defaults: &Value, section: &str) -> String {
    let mut text = String::new();
    let Some(properties) = here["properties"].as_object() else { return text };
    for (key, about) in properties {
        let default = &defaults[key];
        let name = format!("{section}.{key}");
        if default.is_object() {
            text.push_str(&settings(schema, resolve(schema, about), default, &name));
            continue;
        }
        let words: Vec<_> = about["description"].as_str().unwrap_or("").split_whitespace().collect();
        let words = words.join(" ");
        let (meaning, rest) = words.split_once(" Unit: ").unwrap_or((&words, ""));
        let (unit, source) = rest.split_once(" Source: ").unwrap_or((rest, ""));
        let unit = unit.trim_end_matches('.');
        let unit = if unit == "none" || unit.is_empty() { String::new() } else { format!(" {unit}") };
        let _ = writeln!(text, "  {name} = {default}{unit}\n      {meaning}");
        let _ = writeln!(text, "      Source: {source}");
    }
    text
}

/// The schema of a section, wherever the schema of all settings keeps it.
fn section_schema<'a>(schema: &'a Value, section: &str) -> &'a Value {
    resolve(schema, &schema["properties"][section])
}

/// What a schema refers to, if it refers to another.
fn resolve<'a>(schema: &'a Value, here: &'a Value) -> &'a Value {
    match here["$ref"].as_str() {
        Some(reference) => schema.pointer(reference.trim_start_matches('#')).unwrap_or(here),
        None => here,
    }
}
