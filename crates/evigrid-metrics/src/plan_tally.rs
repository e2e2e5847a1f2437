use crate::plan_band::PlanBandCounts;

/// Plans of many frames, each counted against what the laser of its frame knows, on the cells that the camera of that
/// frame looks at; the same cells for every method.
#[derive(Debug, Clone)]
pub struct PlanTally {
    bands: Vec<PlanBandCounts>,
    /// Frames that were counted.
    pub frames: usize,
}

/// A cell of a plan in one frame.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FrameCell {
    /// P(occupied); 0.5 where the plan knows nothing.
    pub probability: f32,
    /// What the laser says: occupied, else free.
    pub occupied: bool,
    /// Whether one of the eight cells around it is occupied for the laser.
    pub beside_occupied: bool,
    /// Distance from the camera, metres.
    pub range_m: f64,
}

/// Ends of the bands of distances, metres; nothing farther is counted.
pub const PLAN_BANDS_M: [f64; 5] = [0.0, 5.0, 10.0, 15.0, 20.0];

impl Default for PlanTally {
    fn default() -> Self {
        Self { bands: vec![PlanBandCounts::default(); PLAN_BANDS_M.len() - 1], frames: 0 }
    }
}

impl PlanTally {
    /// Adds the cells of one frame.
    pub fn add(&mut self, cells: impl IntoIterator<Item = FrameCell>) {
        self.frames += 1;
        for cell in cells {
            let band = PLAN_BANDS_M[1..].iter().position(|end| cell.range_m < *end);
            if let Some(band) = band {
                self.bands[band].add(&cell);
            }
        }
    }

    /// The bands, near ones first, with where they begin and end, metres.
    pub fn bands(&self) -> impl Iterator<Item = ([f64; 2], &PlanBandCounts)> {
        PLAN_BANDS_M.windows(2).map(|ends| [ends[0], ends[1]]).zip(&self.bands)
    }

    /// All bands together.
    pub fn all(&self) -> PlanBandCounts {
        let mut all = PlanBandCounts::default();
        self.bands.iter().for_each(|band| all.append(band));
        all
    }

    /// Mean over the bands of the best F1 that a threshold of its own gives each; bands without occupied cells are left
    /// out. One threshold for all would hide what is gained near by what is lost far away.
    pub fn band_mean_f1(&self) -> f64 {
        let best: Vec<f64> =
            self.bands.iter().map(|band| band.best_f1()[0]).filter(|f1| !f1.is_nan()).collect();
        best.iter().sum::<f64>() / best.len() as f64
    }
}
