//! Names and settings of the methods: impossible settings are refused by the error that names them.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use common::spec;
use evigrid_core::SettingError;
use evigrid_grid::{LayerKind, Method, Needs};
use evigrid_inverse_model::{
    InverseModelMapper, Line, LinePyramid, LinePyramidSettings, LineSettings, Ray, RayPyramid,
    RayPyramidSettings, RaySettings, Souza, SouzaSettings,
};

/// A method's name, if its map of default settings shows the layers that it declares.
fn name_of<M: Method>() -> &'static str {
    let mapper = M::build(spec(), &M::Settings::default()).unwrap();
    let kinds: Vec<LayerKind> = mapper.layers().iter().map(|layer| layer.kind()).collect();
    assert_eq!(kinds, M::LAYERS);
    assert_eq!(M::NEEDS, Needs::MATCHES);
    M::NAME
}

#[test]
fn methods_have_their_published_names() {
    let names = [
        name_of::<Line>(),
        name_of::<LinePyramid>(),
        name_of::<Ray>(),
        name_of::<RayPyramid>(),
        name_of::<Souza>(),
    ];
    assert_eq!(names, ["line", "line-pyramid", "ray", "ray-pyramid", "souza"]);
}

fn refused(result: Result<InverseModelMapper, SettingError>, start: &str, value: &str) {
    let error = result.unwrap_err().to_string();
    assert!(error.starts_with(start) && error.ends_with(&format!("found {value}")), "{error}");
}

#[test]
fn impossible_settings_are_refused_with_bound_and_value() {
    let base = LineSettings::default();
    for (bad, key, value) in [
        (LineSettings { k: 0.0, ..base }, "k", "0"),
        (LineSettings { k: f64::NAN, ..base }, "k", "NaN"),
        (LineSettings { min_probability: 0.5, ..base }, "min_probability", "0.5"),
        (LineSettings { min_probability: 0.0, ..base }, "min_probability", "0"),
        (LineSettings { max_depth_m: -1.0, ..base }, "max_depth_m", "-1"),
        (LineSettings { max_depth_m: f64::INFINITY, ..base }, "max_depth_m", "inf"),
        (LineSettings { disparity_error_px: 0.0, ..base }, "disparity_error_px", "0"),
        (LineSettings { peak_ratio: 0.9, ..base }, "peak_ratio", "0.9"),
        (LineSettings { blur_angle_deg: -1.0, ..base }, "blur_angle_deg", "-1"),
        (LineSettings { log_odds_bounds: [1.0, 5.0], ..base }, "log_odds_bounds", "[1, 5]"),
    ] {
        refused(InverseModelMapper::line(spec(), bad), &format!("line.{key}: expected "), value);
    }
    let layer = LinePyramidSettings { lowest_layer: -9, ..LinePyramidSettings::default() };
    refused(InverseModelMapper::line_pyramid(spec(), layer), "line-pyramid.lowest_layer: ", "-9");
    let k = RaySettings { k: -1.0, ..RaySettings::default() };
    refused(InverseModelMapper::ray(spec(), k), "ray.k: ", "-1");
    let k = RayPyramidSettings { k: -1.0, ..RayPyramidSettings::default() };
    refused(InverseModelMapper::ray_pyramid(spec(), k), "ray-pyramid.k: ", "-1");
    let base = SouzaSettings::default();
    let eps = SouzaSettings { motion_error_m: -0.1, ..base };
    refused(InverseModelMapper::souza(spec(), eps), "souza.motion_error_m: ", "-0.1");
    let eps = SouzaSettings { motion_error_per_m: -0.1, ..base };
    refused(InverseModelMapper::souza(spec(), eps), "souza.motion_error_per_m: ", "-0.1");
    let prior = SouzaSettings { prior_probability: 1.0, ..base };
    refused(InverseModelMapper::souza(spec(), prior), "souza.prior_probability: ", "1");
    let prior = SouzaSettings { prior_probability: 0.2, ..base };
    refused(InverseModelMapper::souza(spec(), prior), "souza.prior_probability: ", "0.2");
    let finer = LinePyramidSettings { finer_layers: 4, ..LinePyramidSettings::default() };
    refused(InverseModelMapper::line_pyramid(spec(), finer), "line-pyramid.finer_layers: ", "4");
    let depth = LineSettings { max_depth_m: 1e9, ..LineSettings::default() };
    refused(InverseModelMapper::line(spec(), depth), "line.max_depth_m: ", "1000000000");
}
