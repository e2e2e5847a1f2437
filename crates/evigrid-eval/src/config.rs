use std::path::Path;

use evigrid_core::name_hint;
use evigrid_cost_curve::{CostCurveBayesSettings, CostCurveSettings, WinnerTakeAllSettings};
use evigrid_grid::GridSettings;
use evigrid_inverse_model::{
    LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings, SouzaSettings,
};
use evigrid_stereo::StereoSettings;
use evigrid_truth::TruthSettings;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use toml::{Table, Value};

/// All settings of a run. What a file or `--set` does not name keeps its default.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct Config {
    /// What is run on what.
    pub run: RunSettings,
    /// Where disparities come from, if not from the built-in matcher.
    pub input: InputSettings,
    /// What is written besides tables and maps.
    pub output: OutputSettings,
    /// Where the voxel grid lies.
    pub grid: GridSettings,
    /// Matching.
    pub stereo: StereoSettings,
    /// The laser reference.
    pub truth: TruthSettings,
    /// How maps are scored.
    pub score: ScoreSettings,
    /// Method `winner-take-all`.
    #[serde(rename = "winner-take-all")]
    pub winner_take_all: WinnerTakeAllSettings,
    /// Method `cost-curve`.
    #[serde(rename = "cost-curve")]
    pub cost_curve: CostCurveSettings,
    /// Method `cost-curve-bayes`.
    #[serde(rename = "cost-curve-bayes")]
    pub cost_curve_bayes: CostCurveBayesSettings,
    /// Method `line`.
    pub line: LineSettings,
    /// Method `line-pyramid`.
    #[serde(rename = "line-pyramid")]
    pub line_pyramid: LinePyramidSettings,
    /// Method `ray`.
    pub ray: RaySettings,
    /// Method `ray-pyramid`.
    #[serde(rename = "ray-pyramid")]
    pub ray_pyramid: RayPyramidSettings,
    /// Method `souza`.
    pub souza: SouzaSettings,
}

/// What is run on what.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RunSettings {
    /// A folder, the name of a known data set, or `synth:NAME` for a synthetic world. Unit: none. Source: user.
    pub dataset: String,
    /// Names of the methods. Unit: none. Source: user.
    pub methods: Vec<String>,
    /// Frames `A..B` (B excluded), `A..` or `..B`. Unit: frame numbers. Source: user.
    pub frames: String,
    /// Use every n-th frame. Unit: frames. Source: user.
    pub stride: usize,
}

impl Default for RunSettings {
    fn default() -> Self {
        Self {
            dataset: "synth:street".into(),
            methods: vec!["winner-take-all".into()],
            frames: "..".into(),
            stride: 1,
        }
    }
}

/// Where disparities come from, if not from the built-in matcher.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct InputSettings {
    /// Folder with a 16-bit KITTI disparity PNG per frame, named as the frame number in ten digits (0000000007.png); empty: match.
    /// Unit: none. Source: KITTI stereo benchmark's format.
    pub disparity_dir: String,
}

/// What is written besides tables and maps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputSettings {
    /// Write the Rerun recording. Unit: none. Source: user.
    pub recording: bool,
    /// Write each frame's disparity as a 16-bit KITTI PNG into disparity/. Unit: none. Source: user.
    pub disparity: bool,
}

impl Default for OutputSettings {
    fn default() -> Self {
        Self { recording: true, disparity: false }
    }
}

/// How maps are scored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ScoreSettings {
    /// Distances to the nearest counterpart that are forgiven in the tolerant scores. Unit: m. Source: one and two cells of the paper's grid.
    pub tolerances_m: Vec<f64>,
}

impl Default for ScoreSettings {
    fn default() -> Self {
        Self { tolerances_m: vec![0.2, 0.4] }
    }
}

/// Why settings could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ConfigError {
    /// A file that cannot be read.
    #[error("cannot read the settings: {source}: {path}")]
    Io {
        /// The file.
        path: String,
        /// What the system said.
        source: std::io::Error,
    },
    /// Something that is no TOML.
    #[error("{origin}: {message}")]
    Syntax {
        /// The file, or `--set`.
        origin: String,
        /// What the parser said, in one line.
        message: String,
    },
    /// A key that does not exist.
    #[error("{origin}: unknown setting `{key}`{hint}")]
    Unknown {
        /// The file, or `--set`.
        origin: String,
        /// The key with its section.
        key: String,
        /// The nearest name.
        hint: String,
    },
    /// A value of the wrong type or outside its domain.
    #[error("{0}")]
    Value(String),
}

impl Config {
    /// The defaults, overridden by a file, overridden by `key=value` pairs (keys with their section, values as in
    /// TOML; a bare word is a string).
    ///
    /// # Errors
    /// If the file cannot be read, a key does not exist (the nearest name is given) or a value has the wrong type.
    pub fn load(file: Option<&Path>, sets: &[String]) -> Result<Self, ConfigError> {
        let mut config = Self::default();
        if let Some(path) = file {
            config = config.with(read_table(path)?, &path.display().to_string())?;
        }
        for set in sets {
            config = config.with(parse_set(set)?, &format!("--set {set}"))?;
        }
        Ok(config)
    }

    /// These settings, overridden by a table of the same sections; `origin` is where that comes from.
    pub(crate) fn with(&self, given: Table, origin: &str) -> Result<Self, ConfigError> {
        let mut table = self.to_table()?;
        overlay(&mut table, given, origin, "")?;
        parse(&table, origin)
    }

    /// The settings as TOML, to be fed back in.
    ///
    /// # Errors
    /// Never for values that TOML can hold.
    pub fn to_toml(&self) -> Result<String, ConfigError> {
        toml::to_string(self).map_err(|e| ConfigError::Value(e.to_string()))
    }

    pub(crate) fn to_table(&self) -> Result<Table, ConfigError> {
        Table::try_from(self).map_err(|e| ConfigError::Value(e.to_string()))
    }
}

/// A TOML file as it is.
pub(crate) fn read_table(path: &Path) -> Result<Table, ConfigError> {
    let origin = path.display().to_string();
    let text =
        std::fs::read_to_string(path).map_err(|source| ConfigError::Io { path: origin.clone(), source })?;
    text.parse::<Table>().map_err(|e| ConfigError::Syntax { message: syntax_error(&text, &e), origin })
}

/// The settings of a table; `origin` is what last changed it.
fn parse(table: &Table, origin: &str) -> Result<Config, ConfigError> {
    let parsed = Value::Table(table.clone()).try_into();
    parsed.map_err(|e: toml::de::Error| ConfigError::Value(format!("{origin}: {}", one_line(&e.to_string()))))
}

/// Puts the values of `given` over those of `base`, whose keys are all there are.
fn overlay(base: &mut Table, given: Table, origin: &str, section: &str) -> Result<(), ConfigError> {
    for (key, value) in given {
        let full = format!("{section}{key}");
        if !base.contains_key(&key) {
            let hint = name_hint(&full, base.keys().map(|k| format!("{section}{k}")));
            return Err(ConfigError::Unknown { origin: origin.into(), key: full, hint });
        }
        match (&mut base[&key], value) {
            (Value::Table(inner), Value::Table(value)) => overlay(inner, value, origin, &format!("{full}."))?,
            (Value::Table(_), _) => {
                return Err(ConfigError::Value(format!("`{full}` is a section, not a value ({origin})")));
            }
            // A whole number is fine where the default has a point.
            (slot @ Value::Float(_), Value::Integer(i)) => *slot = Value::Float(i as f64),
            (slot, value) => *slot = value,
        }
    }
    Ok(())
}

/// `a.b=value` as the table `a = { b = value }`.
fn parse_set(set: &str) -> Result<Table, ConfigError> {
    let syntax =
        |message: &str| ConfigError::Syntax { origin: format!("--set {set}"), message: message.into() };
    let (key, text) =
        set.split_once('=').ok_or_else(|| syntax("expected SECTION.KEY=VALUE, found no `=`"))?;
    let (key, text) = (key.trim(), text.trim());
    if key.is_empty() || key.split('.').any(str::is_empty) {
        return Err(syntax("expected SECTION.KEY before the `=`"));
    }
    let value = match format!("value = {text}").parse::<Table>() {
        Ok(mut table) if table.len() == 1 => {
            table.remove("value").unwrap_or_else(|| Value::String(text.into()))
        }
        // What begins like a list, a table or a quoted string is meant to be one.
        Err(e) if text.starts_with(['[', '{', '"', '\'']) => return Err(syntax(&one_line(e.message()))),
        _ => Value::String(text.into()),
    };
    Ok(nested(key, value))
}

/// `a.b` and a value as the table `a = { b = value }`.
pub(crate) fn nested(key: &str, value: Value) -> Table {
    let (sections, name) = key.rsplit_once('.').map_or(("", key), |(s, n)| (s, n));
    let mut table = Table::from_iter([(name.to_owned(), value)]);
    for section in sections.split('.').rev().filter(|s| !s.is_empty()) {
        table = Table::from_iter([(section.to_owned(), Value::Table(table))]);
    }
    table
}

fn syntax_error(text: &str, error: &toml::de::Error) -> String {
    let line = error.span().map_or(0, |span| text[..span.start.min(text.len())].lines().count().max(1));
    format!("line {line}: {}", one_line(error.message()))
}

pub(crate) fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use proptest::prelude::*;

    fn load(sets: &[&str]) -> Result<Config, ConfigError> {
        Config::load(None, &sets.iter().map(|s| (*s).to_owned()).collect::<Vec<_>>())
    }

    #[test]
    fn settings_override_defaults() {
        let config = load(&[
            "stereo.window=9",
            "winner-take-all.peak_ratio = 2",
            "winner-take-all.deviation=constant",
            "run.methods=[\"winner-take-all\"]",
            "grid.x_m=[0, 20]",
            "run.dataset=some/folder",
        ])
        .unwrap();
        assert_eq!(config.stereo.window, 9);
        assert_eq!(config.winner_take_all.peak_ratio, 2.0);
        assert_eq!(config.winner_take_all.deviation, evigrid_cost_curve::Deviation::Constant);
        assert_eq!(config.grid.x_m, [0.0, 20.0]);
        assert_eq!(config.run.dataset, "some/folder");
        assert_eq!(config.truth, TruthSettings::default());
    }

    #[test]
    fn what_is_written_can_be_read_again() {
        let config = load(&["stereo.window=9", "score.tolerances_m=[0.3]"]).unwrap();
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("config.toml");
        std::fs::write(&path, config.to_toml().unwrap()).unwrap();
        assert_eq!(Config::load(Some(&path), &[]).unwrap(), config);
    }

    #[test]
    fn wrong_settings_are_named_in_one_line() {
        let message = |set: &str| load(&[set]).unwrap_err().to_string();
        assert_eq!(
            message("stereo.windw=9"),
            "--set stereo.windw=9: unknown setting `stereo.windw` (did you mean `stereo.window`?)"
        );
        assert!(message("sterio.window=9").contains("did you mean `stereo`?"));
        assert!(message("stereo=9").contains("`stereo` is a section"));
        assert!(message("stereo.window").contains("found no `=`"));
        assert!(message("=9").contains("before the `=`"));
        let wrong_type = message("stereo.window=wide");
        assert!(wrong_type.contains("window") && !wrong_type.contains('\n'), "{wrong_type}");
        assert!(wrong_type.starts_with("--set stereo.window=wide: "), "{wrong_type}");
        assert!(message("a=b").contains("there are"), "nothing is similar to `a`");
        assert!(message("grid.x_m=[0, 1").starts_with("--set grid.x_m=[0, 1: "));
        assert!(message("winner-take-all.deviation=sometimes").contains("sometimes"));
    }

    #[test]
    fn a_broken_file_is_named_with_its_line() {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("my.toml");
        std::fs::write(&path, "[stereo]\nwindow = \n").unwrap();
        let message = Config::load(Some(&path), &[]).unwrap_err().to_string();
        assert!(message.contains("my.toml: line 2"), "{message}");
        assert!(
            Config::load(Some(&dir.path().join("none.toml")), &[]).unwrap_err().to_string().contains("none")
        );
    }

    proptest! {
        #[test]
        fn random_settings_never_panic(set in ".{0,40}", key in "[a-z.=_]{0,20}", value in ".{0,20}") {
            let _ = load(&[&set]);
            let _ = load(&[&format!("{key}={value}")]);
        }
    }
}
