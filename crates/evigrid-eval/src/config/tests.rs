#![allow(clippy::unwrap_used)]
use super::*;
use evigrid_cost_curve::{Deviation, WinnerTakeAll};
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
    let winner_take_all = config.methods.of::<WinnerTakeAll>().unwrap();
    assert_eq!(winner_take_all.peak_ratio, 2.0);
    assert_eq!(winner_take_all.deviation, Deviation::Constant);
    assert_eq!(config.grid.x_m, [0.0, 20.0]);
    assert_eq!(config.run.dataset, "some/folder");
    assert_eq!(config.truth, TruthSettings::default());
}

#[test]
fn written_settings_can_be_read_again() {
    let sets = ["stereo.window=9", "score.tolerances_m=[0.3]", "souza.log_odds_bounds=[-5, 3.3]"];
    let config = load(&sets).unwrap();
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("config.toml");
    std::fs::write(&path, config.to_toml().unwrap()).unwrap();
    assert_eq!(Config::load(Some(&path), &[]).unwrap(), config);
}

#[test]
fn the_mounting_is_a_height_and_a_pitch() {
    let mounting = |text: &str| load(&[&format!("input.mounting={text}")]).unwrap().input.mounting();
    assert_eq!(mounting("[]"), Ok(None));
    let given = mounting("[1.2, 10]").unwrap().unwrap();
    assert!((given.height_m, given.pitch_rad) == (1.2, 10_f64.to_radians()));
    for bad in ["[1.2]", "[0, 0]", "[1, 90]", "[1, 2, 3]"] {
        let message = mounting(bad).unwrap_err().to_string();
        assert!(message.starts_with("input.mounting: expected [] or [height_m above 0"), "{message}");
    }
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
    assert!(Config::load(Some(&dir.path().join("none.toml")), &[]).unwrap_err().to_string().contains("none"));
}

proptest! {
    #[test]
    fn random_settings_never_panic(set in ".{0,40}", key in "[a-z.=_]{0,20}", value in ".{0,20}") {
        let _ = load(&[&set]);
        let _ = load(&[&format!("{key}={value}")]);
    }
}
