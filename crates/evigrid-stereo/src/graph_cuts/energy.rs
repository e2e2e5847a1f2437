//! The energy that is minimised (Kolmogorov and Zabih 2001, section 3). The unknowns are assignments of a
//! left pixel to a right one, each active or not; a pixel of either image has at most one active assignment.
//! An active one costs its data term less the occlusion penalty; two assignments of neighbours at the same
//! disparity, of which one is active, cost smoothness.

use evigrid_core::GrayImage;
use rayon::prelude::*;

use super::settings::GraphCutSettings;
use crate::buffers::Shape;

/// Costs are whole numbers of this part of a squared grey level.
const SCALE: i32 = 16;
/// The label of a pixel without a match.
pub(super) const OCCLUDED: u16 = u16::MAX;

/// The energy of one pair. Pixels are numbered row by row; labels count the disparities from the smallest on.
#[derive(Debug)]
pub(super) struct Energy {
    pub shape: Shape,
    left: Vec<Pixel>,
    right: Vec<Pixel>,
    max_data: i32,
    /// Gain of a left pixel that has a match at all.
    occlusion: i32,
    smoothness: i32,
    smoothness_at_edges: i32,
    edge: u8,
    has_edges: bool,
}

/// A grey level, and the lowest and highest half-way to the four neighbours (Birchfield and Tomasi 1998, in
/// both directions).
#[derive(Debug, Clone, Copy)]
struct Pixel {
    grey: u8,
    low: u8,
    high: u8,
}

impl Energy {
    pub fn new(settings: &GraphCutSettings, shape: Shape, left: &GrayImage, right: &GrayImage) -> Self {
        let (left, right) = (pixels(left), pixels(right));
        let cutoff = settings.cutoff as i32;
        let mut energy = Self {
            shape,
            left,
            right,
            max_data: SCALE * cutoff * cutoff,
            occlusion: 0,
            smoothness: 0,
            smoothness_at_edges: 0,
            edge: settings.edge.min(255) as u8,
            has_edges: settings.edge <= 255,
        };
        let lambda = match settings.lambda {
            0.0 => energy.chance_cost() / 5,
            given => (given * SCALE as f32).round() as i32,
        };
        let times = |factor: usize| lambda.max(1) * factor as i32;
        energy.occlusion = times(settings.occlusion_penalty);
        energy.smoothness = times(settings.smoothness);
        energy.smoothness_at_edges = times(settings.smoothness_at_edges);
        energy
    }

    /// The disparity of a label.
    pub fn shift(&self, label: u16) -> usize {
        self.shape.min_disparity + usize::from(label)
    }

    /// Whether left pixel `i` has an assignment at a disparity: whether its right pixel is in the image.
    pub fn exists(&self, i: usize, shift: usize) -> bool {
        i % self.shape.width >= shift
    }

    /// The cost of an active assignment without its neighbours.
    pub fn active_cost(&self, i: usize, shift: usize) -> i32 {
        self.data(i, shift) - self.occlusion
    }

    /// The data term.
    fn data(&self, i: usize, shift: usize) -> i32 {
        let (l, r) = (self.left[i], self.right[i - shift]);
        let outside = |grey: u8, of: Pixel| grey.saturating_sub(of.high).max(of.low.saturating_sub(grey));
        let difference = i32::from(outside(l.grey, r).min(outside(r.grey, l)));
        (SCALE * difference * difference).min(self.max_data)
    }

    /// Gives the neighbours of left pixel `i` that have an assignment at the disparity of one of its own,
    /// with the smoothness penalty between the two.
    #[inline(always)]
    pub fn for_neighbours(&self, i: usize, shift: usize, mut visit: impl FnMut(usize, i32)) {
        let Shape { width, height, .. } = self.shape;
        let x = i % width;
        let mut visit = |j: usize| visit(j, self.penalty(i, j, shift));
        if x > shift {
            visit(i - 1);
        }
        if i >= width {
            visit(i - width);
        }
        if x + 1 < width {
            visit(i + 1);
        }
        if i + width < width * height {
            visit(i + width);
        }
    }

    #[inline(always)]
    fn penalty(&self, i: usize, j: usize, shift: usize) -> i32 {
        let step = |image: &[Pixel], i: usize, j: usize| image[i].grey.abs_diff(image[j].grey);
        let step = step(&self.left, i, j).max(step(&self.right, i - shift, j - shift));
        if self.has_edges && step >= self.edge { self.smoothness_at_edges } else { self.smoothness }
    }

    /// The energy of a labelling of the left pixels; 0 if all are occluded.
    pub fn of(&self, labels: &[u16]) -> i64 {
        let of_pixel = |(i, &label): (usize, &u16)| {
            if label == OCCLUDED {
                return 0;
            }
            let shift = self.shift(label);
            let mut cost = i64::from(self.active_cost(i, shift));
            self.for_neighbours(i, shift, |j, penalty| {
                if labels[j] != label {
                    cost += i64::from(penalty);
                }
            });
            cost
        };
        labels.par_iter().enumerate().map(of_pixel).sum()
    }

    /// Cost of a match by chance: of the data terms of each pixel, the one a quarter of the way from the
    /// lowest to the highest; the mean over the pixels.
    fn chance_cost(&self) -> i32 {
        let Shape { width, height, min_disparity, disparities } = self.shape;
        let quarter = disparities.div_ceil(4).max(3).min(disparities);
        let of_row = |y: usize| {
            let (mut sum, mut count) = (0_i64, 0_i64);
            let mut costs = Vec::new();
            for x in min_disparity..width {
                let shifts = min_disparity..=x.min(min_disparity + disparities - 1);
                costs.clear();
                costs.extend(shifts.map(|shift| self.data(y * width + x, shift)));
                let at = quarter.min(costs.len()) - 1;
                sum += i64::from(*costs.select_nth_unstable(at).1);
                count += 1;
            }
            (sum, count)
        };
        let (sum, count) =
            (0..height).into_par_iter().map(of_row).reduce(|| (0, 0), |a, b| (a.0 + b.0, a.1 + b.1));
        (sum / count.max(1)) as i32
    }
}

fn pixels(image: &GrayImage) -> Vec<Pixel> {
    let (width, height) = (image.width(), image.height());
    let pixel = |i: usize| {
        let (x, y) = (i % width, i / width);
        let grey = image.row(y)[x];
        let beside = [(x.saturating_sub(1), y), ((x + 1).min(width - 1), y)];
        let above = [(x, y.saturating_sub(1)), (x, (y + 1).min(height - 1))];
        let half_way =
            |(x, y): (usize, usize)| u16::midpoint(u16::from(grey), u16::from(image.row(y)[x])) as u8;
        let bounds = beside.into_iter().chain(above).map(half_way);
        bounds.fold(Pixel { grey, low: grey, high: grey }, |p, value| Pixel {
            low: p.low.min(value),
            high: p.high.max(value),
            ..p
        })
    };
    (0..width * height).map(pixel).collect()
}
