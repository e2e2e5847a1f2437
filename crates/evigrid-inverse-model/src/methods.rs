//! The five methods as types, and how a map of each is made.

use evigrid_core::SettingError;
use evigrid_grid::{GridSpec, LayerKind, Mapper, Method, Needs, logit};

use crate::drawing::Drawing;
use crate::mapper::{InverseModelMapper, Motion};
use crate::ray_tracing::Search;
use crate::settings::{LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings, SouzaSettings};
use crate::window::WindowCube;

/// Line drawing (Andert 2009, section V-A).
#[derive(Debug, Clone, Copy)]
pub struct Line;

/// Line drawing from an image pyramid (Andert 2009, section VI-B).
#[derive(Debug, Clone, Copy)]
pub struct LinePyramid;

/// Ray tracing (Andert 2009, section V-B).
#[derive(Debug, Clone, Copy)]
pub struct Ray;

/// Ray tracing in an image pyramid (Andert 2009, section VI-C).
#[derive(Debug, Clone, Copy)]
pub struct RayPyramid;

/// Line drawing under an error of the platform's motion (Souza et al. 2012).
#[derive(Debug, Clone, Copy)]
pub struct Souza;

impl Method for Line {
    const NAME: &'static str = "line";
    const SUMMARY: &'static str =
        "a line per pixel, free up to what was measured and occupied there: Andert 2009";
    const NEEDS: Needs = Needs::MATCHES;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = LineSettings;

    fn check(settings: &LineSettings) -> Result<(), SettingError> {
        settings.shared().check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &LineSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(InverseModelMapper::line(spec, *settings)?))
    }
}

impl Method for LinePyramid {
    const NAME: &'static str = "line-pyramid";
    const SUMMARY: &'static str = "lines, free up to what was measured and occupied there, \
        as few as the cells allow, from an image pyramid: Andert 2009";
    const NEEDS: Needs = Needs::MATCHES;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = LinePyramidSettings;

    fn check(settings: &LinePyramidSettings) -> Result<(), SettingError> {
        settings.shared().check(Self::NAME)?;
        settings.check_layers(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &LinePyramidSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(InverseModelMapper::line_pyramid(spec, *settings)?))
    }
}

impl Method for Ray {
    const NAME: &'static str = "ray";
    const SUMMARY: &'static str =
        "per cell the nearest that is seen in the pixels around its image: Andert 2009";
    const NEEDS: Needs = Needs::MATCHES;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = RaySettings;

    fn check(settings: &RaySettings) -> Result<(), SettingError> {
        settings.shared().check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &RaySettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(InverseModelMapper::ray(spec, *settings)?))
    }
}

impl Method for RayPyramid {
    const NAME: &'static str = "ray-pyramid";
    const SUMMARY: &'static str =
        "per cell the nearest that is seen in four pixels of an image pyramid: Andert 2009";
    const NEEDS: Needs = Needs::MATCHES;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = RayPyramidSettings;

    fn check(settings: &RayPyramidSettings) -> Result<(), SettingError> {
        settings.shared().check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &RayPyramidSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(InverseModelMapper::ray_pyramid(spec, *settings)?))
    }
}

impl Method for Souza {
    const NAME: &'static str = "souza";
    const SUMMARY: &'static str = "lines whose profile is widened by the error of the platform's motion: \
        Souza, Maia, Goncalves 2012";
    const NEEDS: Needs = Needs::MATCHES;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = SouzaSettings;

    fn check(settings: &SouzaSettings) -> Result<(), SettingError> {
        settings.shared().check(Self::NAME)?;
        settings.check_motion(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &SouzaSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(InverseModelMapper::souza(spec, *settings)?))
    }
}

impl InverseModelMapper {
    /// An empty map by line drawing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn line(spec: GridSpec, settings: LineSettings) -> Result<Self, SettingError> {
        Line::check(&settings)?;
        let drawing = Drawing::Lines { walk: settings.walk, pyramid: None };
        Ok(Self::new(spec, drawing, settings.shared(), Motion::NONE))
    }

    /// An empty map by pyramidal line drawing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn line_pyramid(spec: GridSpec, settings: LinePyramidSettings) -> Result<Self, SettingError> {
        LinePyramid::check(&settings)?;
        let drawing = Drawing::Lines { walk: settings.walk, pyramid: Some(settings) };
        Ok(Self::new(spec, drawing, settings.shared(), Motion::NONE))
    }

    /// An empty map by ray tracing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn ray(spec: GridSpec, settings: RaySettings) -> Result<Self, SettingError> {
        Ray::check(&settings)?;
        let drawing = Drawing::Rays { search: Search::Window, window: settings.window };
        Ok(Self::new(spec, drawing, settings.shared(), Motion::NONE))
    }

    /// An empty map by pyramidal ray tracing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn ray_pyramid(spec: GridSpec, settings: RayPyramidSettings) -> Result<Self, SettingError> {
        RayPyramid::check(&settings)?;
        let drawing = Drawing::Rays { search: Search::Pyramid, window: WindowCube::Cell };
        Ok(Self::new(spec, drawing, settings.shared(), Motion::NONE))
    }

    /// An empty map by line drawing under an error of motion.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn souza(spec: GridSpec, settings: SouzaSettings) -> Result<Self, SettingError> {
        Souza::check(&settings)?;
        let motion = Motion {
            error_m: settings.motion_error_m,
            error_per_m: settings.motion_error_per_m,
            prior: logit(settings.prior_probability) as f32,
            slice: settings.slice,
        };
        let drawing = Drawing::Lines { walk: settings.walk, pyramid: None };
        Ok(Self::new(spec, drawing, settings.shared(), motion))
    }
}
