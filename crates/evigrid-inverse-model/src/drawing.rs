//! From one disparity image to the image's own grid, by any of the methods.

use evigrid_core::{MatchFilter, MatchLimits, View};
use evigrid_grid::{GridSpec, ViewRays};

use crate::counters::Counters;
use crate::gaussian_table::{FastModel, GaussianTable};
use crate::image_grid::ImageGrid;
use crate::layers::LayerTable;
use crate::line_drawing::{LineContext, Section};
use crate::line_ends::LineEnds;
use crate::lines::{Descent, ImagePoint, draw_found, draw_image};
use crate::model::SensorModel;
use crate::pyramid::{Keep, Pyramid};
use crate::ray_tracing::{RayContext, Search, trace_rays};
use crate::settings::{LinePyramidSettings, Walk};
use crate::window::{WindowCube, WindowProjection};

/// How an image gets into the grid.
#[derive(Debug, Clone, Copy)]
pub(crate) enum Drawing {
    /// A line per pixel, or per pixel of a pyramid.
    Lines { walk: Walk, pyramid: Option<LinePyramidSettings> },
    /// Cell by cell, each searching for the largest disparity around its image.
    Rays { search: Search, window: WindowCube },
}

/// A view as it is drawn.
#[derive(Clone, Copy)]
struct Shot<'a> {
    view: &'a View<'a>,
    model: &'a SensorModel,
    /// The matches that count.
    filter: MatchFilter<'a>,
}

impl<'a> Shot<'a> {
    /// The camera's rays over a grid.
    fn rays(self, spec: &'a GridSpec) -> ViewRays<'a> {
        ViewRays::new(spec, self.view.rig, self.view.map_from_left, self.model.max_depth_m)
    }

    /// The model for cells of a grid.
    fn fast_model(self, spec: &GridSpec) -> FastModel {
        let rig = self.view.rig;
        FastModel::new(self.model, rig.baseline_m * rig.focal_px, spec.cell_size_m())
    }
}

/// Draws images one after the other, with buffers that are kept from image to image.
#[derive(Debug)]
pub(crate) struct ImageDrawer {
    drawing: Drawing,
    table: GaussianTable,
    /// The grid of the image that was drawn last.
    pub image: ImageGrid,
    ends: LineEnds,
    sections: Vec<Section>,
    points: Vec<ImagePoint>,
    pyramid: Pyramid,
}

impl ImageDrawer {
    /// A drawer over a grid.
    pub fn new(spec: GridSpec, drawing: Drawing) -> Self {
        Self {
            drawing,
            table: GaussianTable::default(),
            image: ImageGrid::new(spec),
            ends: LineEnds::default(),
            sections: Vec::new(),
            points: Vec::new(),
            pyramid: Pyramid::default(),
        }
    }

    /// Draws the matches of a view that keep the limits.
    pub fn draw(&mut self, view: &View<'_>, model: &SensorModel, limits: &MatchLimits) -> Counters {
        self.image.begin(model.min_probability as f32);
        let shot = Shot { view, model, filter: MatchFilter::new(view.matches, limits) };
        match self.drawing {
            Drawing::Lines { walk, pyramid } => self.draw_lines(shot, walk, pyramid.as_ref()),
            Drawing::Rays { search, window } => self.draw_rays(shot, search, window),
        }
    }

    /// Draws lines (sections V-A and VI-B).
    fn draw_lines(
        &mut self,
        shot: Shot<'_>,
        walk: Walk,
        pyramid_settings: Option<&LinePyramidSettings>,
    ) -> Counters {
        let Shot { view, model, filter } = shot;
        let spec = *self.image.spec();
        let camera = shot.rays(&spec);
        let Self { ends, sections, points, pyramid, .. } = self;
        ends.reset(&camera.sensor_box());
        let context = LineContext {
            camera,
            model: shot.fast_model(&spec),
            table: &self.table,
            free: model.min_probability as f32,
            ends,
            image: &self.image,
        };
        let Some(settings) = pyramid_settings else {
            return draw_image(&context, filter, walk, sections);
        };
        // Eq. 14, up to where a single pixel is left; then the recursion of section VI-B.
        let table = LayerTable::new(view.rig.baseline_m, spec.cell_size_m());
        let far_px = view.rig.disparity_px(model.max_depth_m);
        let finer = settings.finer_layers;
        let lowest = settings.lowest_layer.max(table.layer(far_px) - finer);
        pyramid.build(filter, view.rig.width, view.rig.height, Keep::Smallest, lowest);
        let block_point = settings.block_point;
        let mut descent =
            Descent { pyramid, table: &table, far_px, lowest, block_point, finer, points, used: 0 };
        descent.run();
        let used = descent.used;
        draw_found(&context, points, used, walk, sections)
    }

    /// Traces rays (sections V-B and VI-C).
    fn draw_rays(&mut self, shot: Shot<'_>, search: Search, window: WindowCube) -> Counters {
        let Shot { view, model, filter } = shot;
        let spec = *self.image.spec();
        let camera = shot.rays(&spec);
        let edge_cells = match window {
            WindowCube::Cell => 1.0,
            WindowCube::Metre => 1.0 / spec.cell_size_m(),
        };
        // Eq. 16. Ray tracing without a pyramid looks at the image alone.
        self.pyramid.build(filter, view.rig.width, view.rig.height, Keep::Largest, 0);
        let context = RayContext {
            camera,
            model: shot.fast_model(&spec),
            table: &self.table,
            free: model.min_probability as f32,
            projection: WindowProjection::new(&camera, edge_cells),
            pyramid: &self.pyramid,
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
}
