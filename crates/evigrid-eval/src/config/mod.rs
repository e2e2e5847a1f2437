//! The settings of a run: sections that all methods share, and one section per method.

mod error;
mod overlay;
mod sections;
#[cfg(test)]
mod tests;

use std::path::Path;

use evigrid_grid::GridSettings;
use evigrid_methods::{MethodSettings, Methods};
use evigrid_stereo::StereoSettings;
use evigrid_truth::TruthSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

pub use error::ConfigError;
pub use sections::{InputSettings, OutputSettings, RunSettings, ScoreSettings};

pub(crate) use overlay::{nested, one_line, read_table};
use overlay::{overlay, parse_set};

/// All settings of a run. A setting that neither a file nor `--set` names keeps its default.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// Which methods run on which frames of which recording.
    pub run: RunSettings,
    /// Data that does not come with the recording.
    pub input: InputSettings,
    /// Files that are written besides tables and maps.
    pub output: OutputSettings,
    /// Where the voxel grid lies.
    pub grid: GridSettings,
    /// Matching.
    pub stereo: StereoSettings,
    /// The truth that maps are scored against.
    pub truth: TruthSettings,
    /// How maps are scored.
    pub score: ScoreSettings,
    /// One section per method, by its name.
    #[serde(skip)]
    pub methods: MethodSettings,
}

impl Config {
    /// The defaults of a program that offers these methods.
    pub fn of(methods: Methods) -> Self {
        Self { methods: MethodSettings::defaults(methods), ..Self::default() }
    }

    /// The defaults of the built-in methods, overridden as by [`Self::loaded`].
    ///
    /// # Errors
    /// As [`Self::loaded`].
    pub fn load(file: Option<&Path>, sets: &[String]) -> Result<Self, ConfigError> {
        Self::default().loaded(file, sets)
    }

    /// These settings, overridden by a file, overridden by `key=value` pairs (keys with their section, values
    /// as in TOML; a bare word is a string).
    ///
    /// # Errors
    /// If the file cannot be read, a key does not exist (the nearest name is given) or a value has the wrong
    /// type.
    pub fn loaded(mut self, file: Option<&Path>, sets: &[String]) -> Result<Self, ConfigError> {
        if let Some(path) = file {
            self = self.with(read_table(path)?, &path.display().to_string())?;
        }
        for set in sets {
            self = self.with(parse_set(set)?, &format!("--set {set}"))?;
        }
        Ok(self)
    }

    /// These settings, overridden by a table of the same sections; `origin` is the place it comes from, for
    /// errors.
    pub(crate) fn with(&self, given: Table, origin: &str) -> Result<Self, ConfigError> {
        let mut table = self.to_table()?;
        overlay(&mut table, given, origin, "")?;
        self.parsed(table, origin)
    }

    /// The settings of a whole table, with the methods of this one.
    fn parsed(&self, mut table: Table, origin: &str) -> Result<Self, ConfigError> {
        let wrong = |message: &str| ConfigError::Value(format!("{origin}: {}", one_line(message)));
        let mut methods = self.methods.clone();
        methods.take(&mut table).map_err(|e| wrong(&e.to_string()))?;
        let shared: Self =
            Value::Table(table).try_into().map_err(|e: toml::de::Error| wrong(&e.to_string()))?;
        Ok(Self { methods, ..shared })
    }

    /// The settings as TOML, to be fed back in.
    ///
    /// # Errors
    /// Never for values that TOML can hold.
    pub fn to_toml(&self) -> Result<String, ConfigError> {
        let failed = |e: &dyn std::fmt::Display| ConfigError::Value(e.to_string());
        let shared = toml::to_string(self).map_err(|e| failed(&e))?;
        Ok(shared + &self.methods.to_toml().map_err(|e| failed(&e))?)
    }

    /// The settings as JSON, by section.
    ///
    /// # Errors
    /// Never for finite values.
    pub fn to_json(&self) -> serde_json::Result<serde_json::Value> {
        let mut sections = Table::new();
        self.methods.put(&mut sections);
        let mut all = serde_json::to_value(self)?;
        if let (Some(all), serde_json::Value::Object(sections)) =
            (all.as_object_mut(), serde_json::to_value(sections)?)
        {
            all.extend(sections);
        }
        Ok(all)
    }

    pub(crate) fn to_table(&self) -> Result<Table, ConfigError> {
        let mut table = Table::try_from(self).map_err(|e| ConfigError::Value(e.to_string()))?;
        self.methods.put(&mut table);
        Ok(table)
    }
}
