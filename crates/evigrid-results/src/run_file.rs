use anyhow::Result;
use serde_json::{Value, json};

use crate::{RunInfo, RunResult};

/// Version of the tables of a run, in run.json. It rises when a column or a key changes its meaning or its
/// name; `evigrid compare` refuses runs of another one. New columns and keys leave it as it is.
pub const RESULTS_FORMAT: u64 = 1;

/// The text of run.json: recording, frames, methods and settings of a run, and the build and machine that
/// made it.
///
/// # Errors
/// Never for finite settings.
pub fn run_json(info: &RunInfo, result: &RunResult, build: &Value) -> Result<String> {
    let methods: Vec<&str> = info.methods.iter().map(|m| m.name.as_str()).collect();
    let value = json!({
        "format": RESULTS_FORMAT,
        "build": build,
        "dataset": info.dataset,
        "layout": info.layout,
        "frames": {
            "first": info.frames.first(),
            "last": info.frames.last(),
            "count": info.frames.len(),
            "stride": info.stride,
            "without_laser": result.without_laser,
        },
        "methods": methods,
        "settings_hash": info.settings.hash,
        "settings": info.settings.json,
    });
    Ok(serde_json::to_string_pretty(&value)? + "\n")
}
