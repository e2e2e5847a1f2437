//! Blurring of an image's grid by the uncertainty of the vehicle's pose (Andert 2009, section VII).

use std::ops::Range;

use evigrid_grid::{GridSpec, LogOddsGrid};
use rayon::prelude::*;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// How far a grid is blurred.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum BlurKind {
    /// No blur.
    None,
    /// One kernel everywhere.
    Constant,
    /// Kernels that grow with the distance from the vehicle (Andert 2009, eq. 17).
    Distance,
}

/// Largest standard deviation of a kernel, in cells, so that the cost stays bounded: a kernel of 97 cells.
pub const MAX_DEVIATION_CELLS: u32 = 16;

/// The uncertainty of a vehicle's pose.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseDeviation {
    /// How far grids are blurred.
    pub kind: BlurKind,
    /// Standard deviation of the position, metres.
    pub translation_m: f64,
    /// Standard deviation of the attitude, radians.
    pub angle: f64,
}

impl PoseDeviation {
    /// Standard deviation of the kernel of a cell at a distance from the vehicle in metres, rounded to whole
    /// cells; 0: the cell keeps its value (Andert 2009, eq. 17; Fig. 4 shows kernel sizes, 6 times as much
    /// plus 1).
    pub fn cells(&self, distance_m: f64, cell_size_m: f64) -> u32 {
        let angle = match self.kind {
            BlurKind::None => return 0,
            BlurKind::Constant => 0.0,
            BlurKind::Distance => self.angle,
        };
        let deviation_m = self.translation_m.hypot(distance_m * angle);
        (deviation_m / cell_size_m).round().min(f64::from(MAX_DEVIATION_CELLS)) as u32
    }

    /// How many cells beyond a box of cells, from..to per axis, its values can reach.
    pub(crate) fn margin(&self, spec: &GridSpec, vehicle_m: [f64; 3], around: &[Range<usize>; 3]) -> usize {
        let (vehicle, cell_size_m) = (spec.to_cells(vehicle_m), spec.cell_size_m());
        let farthest = |margin: usize| {
            let axis = |a: usize| {
                let (low, high) = (around[a].start as f64 - vehicle[a], around[a].end as f64 - vehicle[a]);
                low.abs().max(high.abs()) + margin as f64
            };
            (0..3).map(|a| axis(a).powi(2)).sum::<f64>().sqrt() * cell_size_m
        };
        // Cells farther out have larger kernels, up to a bound: the farthest out that still has one that
        // reaches the box.
        let reach = |margin: usize| 3 * self.cells(farthest(margin), cell_size_m) as usize;
        (0..=3 * MAX_DEVIATION_CELLS as usize).rev().find(|&margin| reach(margin) >= margin).unwrap_or(0)
    }
}

/// An image's grid, blurred (Andert 2009, section VII): each cell becomes the mean of the log-odds around it,
/// weighted by a Gaussian of its own deviation, cut at three deviations along each axis. Cells of which
/// nothing is said, and those outside the grid, count as L = 0; a cell has a value if any cell within its
/// kernel has. `vehicle_m` is in the map frame, metres.
pub fn blurred(grid: &LogOddsGrid, vehicle_m: [f64; 3], deviation: &PoseDeviation) -> LogOddsGrid {
    let spec = grid.spec();
    let mut blur = Blur::default();
    blur.values.extend(grid.values().iter().map(|l| if l.is_nan() { 0.0 } else { *l }));
    blur.touched.extend(grid.values().iter().map(|l| u8::from(!l.is_nan())));
    let mut result = LogOddsGrid::unknown(*spec);
    blur.run(spec, [0; 3], spec.shape(), vehicle_m, deviation, |cell, l| result.values_mut()[cell] = l);
    result
}

/// The buffers that blurring needs, kept from image to image.
#[derive(Debug, Default)]
pub(crate) struct Blur {
    /// Log-odds L of a box of cells, 0 where nothing is said.
    pub values: Vec<f32>,
    /// 1 for cells of that box of which something is said, else 0.
    pub touched: Vec<u8>,
    passes: [(Vec<f32>, Vec<u8>); 2],
    deviations: Vec<u8>,
}

impl Blur {
    /// Blurs the box of cells in the buffers, which begins at cell `low` of the grid, and shows every cell
    /// that has a value. All cells with kernels of one size are done together, by three passes along the
    /// axes.
    pub fn run(
        &mut self,
        spec: &GridSpec,
        low: [usize; 3],
        shape: [usize; 3],
        vehicle_m: [f64; 3],
        deviation: &PoseDeviation,
        mut show: impl FnMut(usize, f32),
    ) {
        let flat_of = |cell: usize| {
            let [_, ny, nz] = shape;
            let place = [cell / (ny * nz), cell / nz % ny, cell % nz];
            (0..3).map(|a| (low[a] + place[a]) * spec.strides()[a]).sum::<usize>()
        };
        let deviation_of = |cell: usize| {
            let centre = spec.centre_m(flat_of(cell));
            let square: f64 = (0..3).map(|a| (centre[a] - vehicle_m[a]).powi(2)).sum();
            deviation.cells(square.sqrt(), spec.cell_size_m()) as u8
        };
        (0..self.values.len()).into_par_iter().map(deviation_of).collect_into_vec(&mut self.deviations);
        let mut sizes = [false; MAX_DEVIATION_CELLS as usize + 1];
        self.deviations.iter().for_each(|&size| sizes[usize::from(size)] = true);
        for size in (0..=MAX_DEVIATION_CELLS).filter(|&size| sizes[size as usize]) {
            self.convolve(shape, size);
            let (values, touched) = &self.passes[0];
            for (cell, &l) in values.iter().enumerate() {
                if u32::from(self.deviations[cell]) == size && touched[cell] != 0 {
                    show(flat_of(cell), l);
                }
            }
        }
    }

    /// Blurs the whole box by one kernel, into the first pass's buffers.
    fn convolve(&mut self, shape: [usize; 3], deviation: u32) {
        let weights = kernel(deviation);
        let [(values, touched), spare] = &mut self.passes;
        values.clone_from(&self.values);
        touched.clone_from(&self.touched);
        if deviation == 0 {
            return;
        }
        let mut inner = shape.iter().product::<usize>();
        for length in shape {
            inner /= length;
            spare.0.resize(values.len(), 0.0);
            spare.1.resize(values.len(), 0);
            let rows = spare.0.par_chunks_mut(inner).zip(spare.1.par_chunks_mut(inner)).with_min_len(64);
            rows.enumerate().for_each(|(row, (to, to_touched))| {
                let reach = weights.len() / 2;
                let place = row % length;
                let (first, last) = (place.saturating_sub(reach), (place + reach).min(length - 1));
                to.fill(0.0);
                to_touched.fill(0);
                for from in first..=last {
                    let weight = weights[from + reach - place];
                    let start = (row - place + from) * inner;
                    let (from, from_touched) =
                        (&values[start..start + inner], &touched[start..start + inner]);
                    to.iter_mut().zip(from).for_each(|(to, from)| *to += weight * from);
                    to_touched.iter_mut().zip(from_touched).for_each(|(to, from)| *to |= from);
                }
            });
            std::mem::swap(values, &mut spare.0);
            std::mem::swap(touched, &mut spare.1);
        }
    }
}

/// The normalised Gaussian from -3 to 3 deviations.
fn kernel(deviation: u32) -> Vec<f32> {
    let reach = 3 * i64::from(deviation);
    let weight = |k: i64| (-0.5 * (k as f64 / f64::from(deviation.max(1))).powi(2)).exp();
    let total: f64 = (-reach..=reach).map(weight).sum();
    (-reach..=reach).map(|k| (weight(k) / total) as f32).collect()
}
