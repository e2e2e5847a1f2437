use std::fmt::Write as _;

use anyhow::Result;
use evigrid_eval::Config;
use serde_json::Value;

use crate::output::print;

/// `evigrid methods`: every setting, from the doc comments of the settings themselves.
pub fn methods() -> Result<()> {
    let config = Config::default();
    let mut text = String::from("Methods (--method NAME)\n\n");
    for method in config.methods.methods().iter() {
        let layers: Vec<_> = method.layers.iter().map(|layer| layer.name()).collect();
        let (name, summary, needs, layers) = (method.name, method.summary, method.needs, layers.join(", "));
        let _ = writeln!(text, "{name}\n  {summary}\n  Shows {layers}. Needs {needs}.");
        let schema = serde_json::to_value((method.schema)())?;
        let defaults = serde_json::to_value(config.methods.table(name))?;
        text.push_str(&settings(&schema, &schema, &defaults, name));
    }
    text.push_str("\nSettings that all methods share (--set SECTION.KEY=VALUE, or --config FILE)\n");
    let schema = serde_json::to_value(schemars::schema_for!(Config))?;
    let defaults = serde_json::to_value(&config)?;
    for section in defaults.as_object().into_iter().flatten().map(|(name, _)| name) {
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

/// The schema that a schema refers to, if it refers to another.
fn resolve<'a>(schema: &'a Value, here: &'a Value) -> &'a Value {
    match here["$ref"].as_str() {
        Some(reference) => schema.pointer(reference.trim_start_matches('#')).unwrap_or(here),
        None => here,
    }
}
