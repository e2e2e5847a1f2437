use crate::{VoxelReference, ratio};

/// Thresholds of the curve: log-odds from -5 to 5 (P from 0.0067 to 0.9933) in steps of a tenth.
const STEPS: usize = 100;

/// One point of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CurvePoint {
    /// Cells above this many log-odds count as occupied.
    pub log_odds: f32,
    /// Occupied above the threshold in the map, and occupied in the reference.
    pub hits: usize,
    /// Occupied above the threshold in the map, not in the reference.
    pub mistakes: usize,
}

/// Hits against mistakes over the probability threshold.
#[derive(Debug, Clone, PartialEq)]
pub struct Curve {
    /// Points by falling threshold, so hits and mistakes rise.
    pub points: Vec<CurvePoint>,
    /// Occupied cells of the reference.
    pub true_cells: usize,
}

/// The curve of a map given as log-odds by flat index.
pub fn curve(log_odds: &[f32], reference: &VoxelReference<'_>) -> Curve {
    let thresholds: [f32; STEPS + 1] = std::array::from_fn(|k| (STEPS as f32 / 2.0 - k as f32) / 10.0);
    let mut hits = [0; STEPS + 1];
    let mut mistakes = [0; STEPS + 1];
    let mut true_cells = 0;
    for (&l, &truth) in log_odds.iter().zip(reference.occupied) {
        true_cells += usize::from(truth);
        // The first (highest) threshold that the cell exceeds. NaN exceeds none.
        let first = thresholds.partition_point(|t| l.partial_cmp(t) != Some(std::cmp::Ordering::Greater));
        if first <= STEPS {
            (if truth { &mut hits } else { &mut mistakes })[first] += 1;
        }
    }
    let (mut hit_sum, mut mistake_sum) = (0, 0);
    let points = (0..=STEPS)
        .map(|k| {
            hit_sum += hits[k];
            mistake_sum += mistakes[k];
            CurvePoint { log_odds: thresholds[k], hits: hit_sum, mistakes: mistake_sum }
        })
        .collect();
    Curve { points, true_cells }
}

impl Curve {
    /// Area under hits over mistakes, from no mistake to as many mistakes as there are true cells, divided by
    /// the square of that number: 1 for a map that finds everything before its first mistake. The curve
    /// starts at (0, 0), is straight between thresholds and level behind the last one. NaN without true
    /// cells.
    pub fn area(&self) -> f64 {
        let end = self.true_cells as f64;
        let (mut area, mut m0, mut h0) = (0.0, 0.0, 0.0);
        for point in &self.points {
            let (m, h) = (point.mistakes as f64, point.hits as f64);
            if m > end {
                let h_at_end = h0 + (h - h0) * (end - m0) / (m - m0);
                area += (end - m0) * 0.5 * (h0 + h_at_end);
                return area / (end * end);
            }
            area += (m - m0) * 0.5 * (h0 + h);
            (m0, h0) = (m, h);
        }
        (area + (end - m0) * h0) / (end * end)
    }

    /// Average precision: sum over the thresholds of the rise in recall times the precision there.
    pub fn average_precision(&self) -> f64 {
        let mut before = 0;
        let sum: f64 = self
            .points
            .iter()
            .filter(|p| p.hits > 0)
            .map(|p| {
                let rise = p.hits - before;
                before = p.hits;
                rise as f64 * ratio(p.hits, p.hits + p.mistakes)
            })
            .sum();
        sum / self.true_cells as f64
    }
}
