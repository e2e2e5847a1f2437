use evigrid_core::View;
use evigrid_grid::{GridSpec, Layer, LogOddsGrid, MapError, Mapper};

use crate::blur::{Blur, BlurKind, blurred};
use crate::counters::Counters;
use crate::drawing::{Drawing, ImageDrawer};
use crate::image_grid::Fusion;
use crate::settings::SharedSettings;
use crate::slice::level_of;

/// A map of drawn disparity images: the four methods of Andert 2009, and that of Souza et al. 2012. They
/// share model, filters and fusion, and differ in how an image gets into the grid.
#[derive(Debug)]
pub struct InverseModelMapper {
    shared: SharedSettings,
    motion: Motion,
    /// Position of the camera in the frame before, metres.
    last_position: Option<[f64; 3]>,
    drawer: ImageDrawer,
    map: LogOddsGrid,
    counters: Counters,
    blur: Blur,
}

/// The extensions of Souza et al.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Motion {
    /// Error eps of the platform's motion in every frame, metres.
    pub error_m: f64,
    /// Growth of eps per metre driven.
    pub error_per_m: f64,
    /// Log-odds l_0 of a cell before any measurement.
    pub prior: f32,
    /// Whether only the level of the optical centre is mapped.
    pub slice: bool,
}

impl Motion {
    /// No extension: Andert's methods.
    pub const NONE: Self = Self { error_m: 0.0, error_per_m: 0.0, prior: 0.0, slice: false };
}

impl InverseModelMapper {
    /// An empty map of checked settings.
    pub(crate) fn new(spec: GridSpec, drawing: Drawing, shared: SharedSettings, motion: Motion) -> Self {
        Self {
            shared,
            motion,
            last_position: None,
            drawer: ImageDrawer::new(spec, drawing),
            map: LogOddsGrid::unknown(spec),
            counters: Counters::default(),
            blur: Blur::default(),
        }
    }

    /// The map so far.
    pub fn map(&self) -> &LogOddsGrid {
        &self.map
    }

    /// The counts of Andert's Table I for the last image.
    pub fn counters(&self) -> &Counters {
        &self.counters
    }

    /// The grid of a single image, L of Andert's eq. 11 and blurred if the settings say so, with its counts;
    /// NaN where the image says nothing. Neither the map nor [`Self::counters`] change.
    pub fn single_image(&mut self, view: &View<'_>) -> (LogOddsGrid, Counters) {
        let mut counters = self.draw(view);
        let drawn = self.drawer.image.log_odds(self.shared.clamp());
        counters.count(drawn.touched().count() as u64);
        self.drawer.image.clear();
        (self.blurred(drawn, view), counters)
    }

    /// An image's grid of which the part that it adds to the prior is blurred.
    fn blurred(&self, mut drawn: LogOddsGrid, view: &View<'_>) -> LogOddsGrid {
        let prior = self.motion.prior;
        drawn.values_mut().iter_mut().for_each(|l| *l -= prior);
        let mut blurred = blurred(&drawn, position_m(view), &self.shared.pose_deviation());
        blurred.values_mut().iter_mut().for_each(|l| *l += prior);
        blurred
    }

    /// Error eps of the platform's motion in a frame, metres (Souza's eq. 13).
    fn motion_error_m(&self, view: &View<'_>) -> f64 {
        let here = position_m(view);
        let driven = self
            .last_position
            .map_or(0.0, |last| (0..3).map(|a| (here[a] - last[a]).powi(2)).sum::<f64>().sqrt());
        self.motion.error_m + self.motion.error_per_m * driven
    }

    /// Draws one image into the image's grid.
    fn draw(&mut self, view: &View<'_>) -> Counters {
        // The uncertainty of this frame: Andert eq. 4, Souza eq. 13.
        let model = self.shared.model(self.motion_error_m(view));
        self.drawer.draw(view, &model, &self.shared.match_limits(&model, view.rig))
    }

    /// Adds the image's grid to the map; the number of cells of which the image says something.
    fn fuse(&mut self, view: &View<'_>) -> u64 {
        let position = position_m(view);
        let fusion = Fusion {
            evidence: self.shared.clamp(),
            map: self.shared.clamp(),
            prior: self.motion.prior,
            level: self.motion.slice.then(|| level_of(&self.map, position[2]).unwrap_or(usize::MAX)),
        };
        let deviation = self.shared.pose_deviation();
        let image = &mut self.drawer.image;
        match deviation.kind {
            BlurKind::None => image.fuse_into(&mut self.map, &fusion),
            _ => image.fuse_blurred(&mut self.map, &fusion, &mut self.blur, position, &deviation),
        }
    }
}

impl Mapper for InverseModelMapper {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        // The image's own grid (Andert V and VI), by the inverse model (IV).
        let mut counters = self.draw(view);
        // Blurred (VII) and added to the map: log-odds add up (Souza eq. 3).
        counters.count(self.fuse(view));
        self.counters = counters;
        self.last_position = Some(position_m(view));
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.map)]
    }
}

/// Where the left camera is in the map frame, metres.
fn position_m(view: &View<'_>) -> [f64; 3] {
    view.map_from_left.translation.vector.into()
}
