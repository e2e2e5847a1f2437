//! Grids from above, as in the paper: the darker the more occupied.

use evigrid_grid::LogOddsGrid;
use plotters::prelude::RGBColor;

use super::scene::{CAMERA_M, RANGE_M};
use crate::cells::{Patches, blend};
use crate::chart::{Axis, Marks, ORANGE, Panel, Series, rectangle};

/// Heights that are shown, so that the meadow does not hide what stands on it: metres above it.
pub const SHOWN_M: [f64; 2] = [0.8, 6.5];
/// Log-odds that are white and black.
const WHITE: f64 = -0.62;
const BLACK: f64 = 0.6;
/// Half the width of what is shown, metres.
const HALF_M: f64 = 12.0;
const UNSEEN: RGBColor = RGBColor(206, 222, 236);
/// Width and height, so that a metre is as long along both axes.
pub const PANEL: (u32, u32) = (420, 402);

/// The largest log-odds of every column of a grid between two heights above the meadow.
pub struct Plan {
    patches: Patches,
    values: Vec<f64>,
}

impl Plan {
    pub fn new(map: &LogOddsGrid, shown_m: [f64; 2]) -> Self {
        let spec = map.spec();
        let [nx, ny, nz] = spec.shape();
        let shown = |k: usize| {
            let height_m = spec.centre_m(k)[2] + CAMERA_M;
            (shown_m[0]..shown_m[1]).contains(&height_m)
        };
        let largest = |column: &[f32]| {
            let levels = column.iter().enumerate().filter(|(k, _)| shown(*k));
            levels.map(|(_, l)| f64::from(*l)).fold(f64::NAN, f64::max)
        };
        let [x0, y0, _] = spec.origin_m();
        Self {
            patches: Patches { shape: [nx, ny], origin_m: [x0, y0], edge_m: spec.cell_size_m() },
            values: map.values().chunks_exact(nz).map(largest).collect(),
        }
    }

    /// Centre (x, y) of every column with its value; NaN where nothing is said.
    pub fn columns(&self) -> impl Iterator<Item = [f64; 3]> + '_ {
        let ([_, ny], [x0, y0], c) = (self.patches.shape, self.patches.origin_m, self.patches.edge_m);
        let at = move |n: usize| [x0 + ((n / ny) as f64 + 0.5) * c, y0 + ((n % ny) as f64 + 0.5) * c];
        self.values.iter().enumerate().map(move |(n, l)| [at(n)[0], at(n)[1], *l])
    }

    pub fn panel(&self, title: String) -> Panel {
        let ny = self.patches.shape[1];
        let value = |i: usize, j: usize| {
            let ([x0, y0], c) = (self.patches.origin_m, self.patches.edge_m);
            let (x, y) = (x0 + i as f64 * c, y0 + j as f64 * c);
            let inside = (0.0..RANGE_M).contains(&x) && y >= -HALF_M && y + c <= HALF_M;
            let l = self.values[i * ny + j];
            (inside && !l.is_nan()).then_some((l - WHITE) / (BLACK - WHITE))
        };
        let mut series =
            vec![Series::new("", UNSEEN, Marks::Areas(vec![rectangle([0.0, RANGE_M], [-HALF_M, HALF_M])]))];
        series.extend(self.patches.shaded(value, |v| blend(RGBColor(255, 255, 255), RGBColor(0, 0, 0), v)));
        series.push(Series::new("", ORANGE, Marks::Dots(vec![(0.2, 0.0)], 5)));
        plan_panel(title, series)
    }
}

/// A panel that shows the sensor's range from above.
pub fn plan_panel(title: impl Into<String>, series: Vec<Series>) -> Panel {
    Panel {
        title: title.into(),
        x: Axis::new("metres ahead of the camera", 0.0, RANGE_M),
        y: Axis::new("metres to the left", -HALF_M, HALF_M),
        series,
        legend: None,
    }
}
