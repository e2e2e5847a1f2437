use evigrid_grid::{GridSpec, LogOddsGrid, Mapper, View, ViewRays, logit};

use crate::blur::Blur;
use crate::filter::Filter;
use crate::gaussian_table::FastModel;
use crate::image_grid::{Fusion, ImageGrid};
use crate::line_drawing::{LineContext, Section};
use crate::line_ends::LineEnds;
use crate::lines::{Descent, ImagePoint, draw_found, draw_image};
use crate::pyramid::{Keep, Pyramid};
use crate::ray_tracing::{RayContext, Search, trace_rays};
use crate::settings::Common;
use crate::slice::level_of;
use crate::window::Projection;
use crate::{
    Counters, GaussianTable, LayerTable, LinePyramidSettings, LineSettings, RayPyramidSettings, RaySettings,
    SensorModel, SettingError, SouzaSettings, Walk, WindowCube,
};

/// A map of drawn disparity images: the four methods of Andert 2009, and that of Souza et al. 2012. They share model, filters
/// and fusion, and differ in how an image gets into the grid.
#[derive(Debug)]
pub struct InverseModelMapper {
    drawing: Drawing,
    common: Common,
    motion: Motion,
    /// Where the camera was in the frame before, metres.
    last_position: Option<[f64; 3]>,
    table: GaussianTable,
    image: ImageGrid,
    map: LogOddsGrid,
    counters: Counters,
    scratch: Scratch,
}

/// How an image gets into the grid.
#[derive(Debug, Clone, Copy)]
enum Drawing {
    /// A line per pixel, or per pixel of a pyramid.
    Lines { walk: Walk, pyramid: Option<LinePyramidSettings> },
    /// Cell by cell, searching so.
    Rays { search: Search, window: WindowCube },
}

/// What Souza et al. add.
#[derive(Debug, Clone, Copy)]
struct Motion {
    /// eps: of every frame, metres, and per metre driven.
    error_m: f64,
    error_per_m: f64,
    /// l_0, log-odds.
    prior: f32,
    /// Whether only the level of the optical centre is mapped.
    slice: bool,
}

impl Motion {
    /// Nothing: Andert's methods.
    const NONE: Self = Self { error_m: 0.0, error_per_m: 0.0, prior: 0.0, slice: false };
}

/// Buffers that are kept from image to image.
#[derive(Debug, Default)]
struct Scratch {
    ends: LineEnds,
    sections: Vec<Section>,
    points: Vec<ImagePoint>,
    pyramid: Pyramid,
    blur: Blur,
}

impl InverseModelMapper {
    /// An empty map by line drawing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn line(spec: GridSpec, settings: LineSettings) -> Result<Self, SettingError> {
        let settings = settings.checked()?;
        let drawing = Drawing::Lines { walk: settings.walk, pyramid: None };
        Ok(Self::new(spec, drawing, settings.common(), Motion::NONE))
    }

    /// An empty map by pyramidal line drawing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn line_pyramid(spec: GridSpec, settings: LinePyramidSettings) -> Result<Self, SettingError> {
        let settings = settings.checked()?;
        let drawing = Drawing::Lines { walk: settings.walk, pyramid: Some(settings) };
        Ok(Self::new(spec, drawing, settings.common(), Motion::NONE))
    }

    /// An empty map by ray tracing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn ray(spec: GridSpec, settings: RaySettings) -> Result<Self, SettingError> {
        let settings = settings.checked()?;
        let drawing = Drawing::Rays { search: Search::Window, window: settings.window };
        Ok(Self::new(spec, drawing, settings.common(), Motion::NONE))
    }

    /// An empty map by pyramidal ray tracing.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn ray_pyramid(spec: GridSpec, settings: RayPyramidSettings) -> Result<Self, SettingError> {
        let settings = settings.checked()?;
        let drawing = Drawing::Rays { search: Search::Pyramid, window: WindowCube::Cell };
        Ok(Self::new(spec, drawing, settings.common(), Motion::NONE))
    }

    /// An empty map by line drawing under an error of motion.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn souza(spec: GridSpec, settings: SouzaSettings) -> Result<Self, SettingError> {
        let settings = settings.checked()?;
        let motion = Motion {
            error_m: settings.motion_error_m,
            error_per_m: settings.motion_error_per_m,
            prior: logit(settings.prior_probability) as f32,
            slice: settings.slice,
        };
        let drawing = Drawing::Lines { walk: settings.walk, pyramid: None };
        Ok(Self::new(spec, drawing, settings.common(), motion))
    }

    fn new(spec: GridSpec, drawing: Drawing, common: Common, motion: Motion) -> Self {
        Self {
            drawing,
            common,
            motion,
            last_position: None,
            table: GaussianTable::default(),
            image: ImageGrid::new(spec),
            map: LogOddsGrid::unknown(spec),
            counters: Counters::default(),
            scratch: Scratch::default(),
        }
    }

    /// The counts of Table I for the last image.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The grid of a single image, L of eq. 11 and blurred if the settings say so, with its counts; NaN where the image
    /// says nothing. Neither the map nor [`Self::counters`] change.
    pub fn single_image(&mut self, view: &View<'_>) -> (LogOddsGrid, Counters) {
        let model = self.common.model(self.motion_error_m(view));
        let mut counters = self.draw(view, &model);
        let drawn = self.image.log_odds(self.common.clamp());
        counters.count(drawn.touched().count() as u64);
        self.image.clear();
        (self.blurred(drawn, view), counters)
    }

    /// What an image's grid adds to the prior, blurred, and the prior.
    fn blurred(&self, mut drawn: LogOddsGrid, view: &View<'_>) -> LogOddsGrid {
        let prior = self.motion.prior;
        drawn.values_mut().iter_mut().for_each(|l| *l -= prior);
        let vehicle_m = view.map_from_left.translation.vector.into();
        let mut blurred = crate::blurred(&drawn, vehicle_m, &self.common.pose_deviation());
        blurred.values_mut().iter_mut().for_each(|l| *l += prior);
        blurred
    }

    /// eps of Souza's eq. 13 for a frame, metres.
    fn motion_error_m(&self, view: &View<'_>) -> f64 {
        let here: [f64; 3] = view.map_from_left.translation.vector.into();
        let driven = self
            .last_position
            .map_or(0.0, |last| (0..3).map(|a| (here[a] - last[a]).powi(2)).sum::<f64>().sqrt());
        self.motion.error_m + self.motion.error_per_m * driven
    }

    /// Draws one image into the image's grid.
    fn draw(&mut self, view: &View<'_>, model: &SensorModel) -> Counters {
        self.image.begin(model.min_probability as f32);
        match self.drawing {
            Drawing::Lines { walk, pyramid } => self.draw_lines(view, model, walk, pyramid.as_ref()),
            Drawing::Rays { search, window } => self.draw_rays(view, model, search, window),
        }
    }

    /// Sections V-A and VI-B.
    fn draw_lines(
        &mut self,
        view: &View<'_>,
        model: &SensorModel,
        walk: Walk,
        pyramid_settings: Option<&LinePyramidSettings>,
    ) -> Counters {
        let spec = *self.image.spec();
        let camera = ViewRays::new(&spec, view.rig, view.map_from_left, model.max_depth_m);
        let filter = Filter::new(view.matches, &self.common.limits(model, view.rig));
        let Scratch { ends, sections, points, pyramid, .. } = &mut self.scratch;
        ends.reset(&camera.sensor_box());
        let context = LineContext {
            camera,
            model: FastModel::new(model, view.rig.baseline_m * view.rig.focal_px, spec.cell_size_m()),
            table: &self.table,
            free: model.min_probability as f32,
            ends,
            image: &self.image,
        };
        let Some(settings) = pyramid_settings else {
            return draw_image(&context, &filter, walk, sections);
        };
        // Eq. 14, up to where a single pixel is left; then the recursion of section VI-B.
        let table = LayerTable::new(view.rig.baseline_m, spec.cell_size_m());
        let far_px = view.rig.disparity_px(model.max_depth_m);
        let finer = settings.finer_layers;
        let lowest = settings.lowest_layer.max(table.layer(far_px) - finer);
        pyramid.build(&filter, (view.rig.width, view.rig.height), Keep::Smallest, lowest);
        let block_point = settings.block_point;
        let mut descent =
            Descent { pyramid, table: &table, far_px, lowest, block_point, finer, points, used: 0 };
        descent.run();
        let used = descent.used;
        draw_found(&context, points, used, walk, sections)
    }

    /// Sections V-B and VI-C.
    fn draw_rays(
        &mut self,
        view: &View<'_>,
        model: &SensorModel,
        search: Search,
        window: WindowCube,
    ) -> Counters {
        let spec = *self.image.spec();
        let cell_size_m = spec.cell_size_m();
        let camera = ViewRays::new(&spec, view.rig, view.map_from_left, model.max_depth_m);
        let filter = Filter::new(view.matches, &self.common.limits(model, view.rig));
        let edge = match window {
            WindowCube::Cell => 1.0,
            WindowCube::Metre => 1.0 / cell_size_m,
        };
        let pyramid = &mut self.scratch.pyramid;
        // Eq. 16. Ray tracing without a pyramid looks at the image alone.
        pyramid.build(&filter, (view.rig.width, view.rig.height), Keep::Largest, 0);
        let context = RayContext {
            camera,
            model: FastModel::new(model, view.rig.baseline_m * view.rig.focal_px, cell_size_m),
            table: &self.table,
            free: model.min_probability as f32,
            projection: Projection::new(&camera, edge),
            pyramid,
            search,
            image: &self.image,
        };
        let used_pixels = trace_rays(&context);
        let cells = camera.box_in_grid().iter().map(|range| range.len() as u64).product();
        Counters {
            coordinate_transfers: cells + 5,
            used_pixels,
            cells_drawn: cells,
            different_cells: cells,
            ..Counters::default()
        }
    }

    /// Adds the image's grid to the map; the number of cells of which the image says something.
    fn fuse(&mut self, view: &View<'_>) -> u64 {
        let position: [f64; 3] = view.map_from_left.translation.vector.into();
        let fusion = Fusion {
            evidence: self.common.clamp(),
            map: self.common.clamp(),
            prior: self.motion.prior,
            level: self.motion.slice.then(|| level_of(&self.map, position[2]).unwrap_or(usize::MAX)),
        };
        let deviation = self.common.pose_deviation();
        match deviation.kind {
            crate::BlurKind::None => self.image.fuse_into(&mut self.map, &fusion),
            _ => {
                let blur = &mut self.scratch.blur;
                self.image.fuse_blurred(&mut self.map, &fusion, blur, position, &deviation)
            }
        }
    }
}

impl Mapper for InverseModelMapper {
    fn integrate(&mut self, view: &View<'_>) {
        // Nothing can be drawn from nowhere.
        if !view.map_from_left.to_homogeneous().iter().all(|v| v.is_finite()) {
            return;
        }
        // The uncertainty of this frame: Andert eq. 4, Souza eq. 13.
        let model = self.common.model(self.motion_error_m(view));
        // The image's own grid (Andert V and VI), by the inverse model (IV).
        let mut counters = self.draw(view, &model);
        // Blurred (VII) and added to the map: log-odds add up (Souza eq. 3).
        counters.count(self.fuse(view));
        self.counters = counters;
        self.last_position = Some(view.map_from_left.translation.vector.into());
    }

    fn map(&self) -> &LogOddsGrid {
        &self.map
    }
}
