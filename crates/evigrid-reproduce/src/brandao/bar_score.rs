//! Whether a map has the bars, and what it has that is not there.

use evigrid_synth::VoxelState;

use super::bars::Bars;

/// An occupied cell is an outlier if nothing but air is within so many cells of it. A bar's level is held if
/// an occupied cell lies within this of it too.
pub const NEAR_CELLS: i64 = 1;

/// Score of a map of the bars.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct BarScore {
    /// True cells of bars, and those of them that are occupied.
    pub bar_cells: usize,
    pub bar_cells_found: usize,
    /// Share of the levels that are held, of each bar.
    pub held: Vec<f64>,
    /// Runs of levels that are not held, over all bars, and the length of the longest, cells.
    pub gaps: usize,
    pub longest_gap: usize,
    /// Occupied cells.
    pub occupied: usize,
    /// Occupied cells that hold nothing but air, in the whole grid.
    pub in_air: usize,
    /// Those of them with nothing but air around them too, in the whole grid and
    /// in the region around the bars.
    pub outliers: usize,
    pub outliers_around: usize,
}

impl BarScore {
    pub fn new(bars: &Bars, log_odds: &[f32]) -> Self {
        let occupied = |cell: usize| log_odds[cell] > 0.0;
        let mut score = Self::default();
        for bar in &bars.cells {
            let cells = || bar.iter().flatten().copied();
            score.bar_cells += cells().count();
            score.bar_cells_found += cells().filter(|&cell| occupied(cell)).count();
            let held: Vec<bool> = bar.iter().map(|level| is_held(bars, level, &occupied)).collect();
            score.held.push(held.iter().filter(|held| **held).count() as f64 / held.len().max(1) as f64);
            let gaps = held.split(|held| *held).filter(|gap| !gap.is_empty()).map(<[bool]>::len);
            for gap in gaps {
                score.gaps += 1;
                score.longest_gap = score.longest_gap.max(gap);
            }
        }
        for cell in (0..log_odds.len()).filter(|&cell| occupied(cell)) {
            score.occupied += 1;
            let in_air = bars.truth.state(cell) == VoxelState::Free;
            let outlier = in_air && bars.is_far_from_surfaces(cell, NEAR_CELLS);
            score.in_air += usize::from(in_air);
            score.outliers += usize::from(outlier);
            score.outliers_around += usize::from(outlier && bars.is_around(cell));
        }
        score
    }

    /// The smallest share of a bar's levels that are held.
    pub fn worst_bar(&self) -> f64 {
        self.held.iter().copied().fold(1.0, f64::min)
    }

    /// Whether all bars are whole.
    pub fn is_complete(&self) -> bool {
        self.gaps == 0
    }

    /// Whether the region around the bars is free of outliers.
    pub fn is_clean(&self) -> bool {
        self.outliers_around == 0
    }
}

/// Whether an occupied cell lies within [`NEAR_CELLS`] of a level's cells, at the same height.
pub fn is_held(bars: &Bars, level: &[usize], occupied: &dyn Fn(usize) -> bool) -> bool {
    let reach = || -NEAR_CELLS..=NEAR_CELLS;
    level.iter().any(|&cell| {
        let [i, j, k] = bars.spec.voxel(cell).map(|v| v as i64);
        reach()
            .flat_map(|di| reach().map(move |dj| [i + di, j + dj, k]))
            .any(|voxel| bars.spec.flat(voxel).is_some_and(occupied))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scores_by_hand() {
        // Coarser cells would have two bars within one cell of each other.
        let bars = Bars::new(0.05).unwrap();
        let mut map = vec![f32::NAN; bars.spec.cell_count()];
        let all: Vec<usize> = bars.cells.iter().flatten().flatten().copied().collect();
        all.iter().for_each(|&cell| map[cell] = 1.0);
        let perfect = BarScore::new(&bars, &map);
        assert!(perfect.is_complete() && perfect.is_clean(), "{perfect:?}");
        assert_eq!((perfect.bar_cells_found, perfect.bar_cells), (all.len(), all.len()));
        assert_eq!((perfect.occupied, perfect.in_air), (all.len(), 0));

        // Two levels of the first bar are lost, and three cells float in the air,
        // one of them in front of the bars.
        let lost = &bars.cells[0][3..5];
        lost.iter().flatten().for_each(|&cell| map[cell] = -1.0);
        let floating = |cell: &usize| bars.is_far_from_surfaces(*cell, 3);
        let around: Vec<usize> =
            (0..map.len()).filter(|&c| bars.is_around(c)).filter(floating).take(1).collect();
        let elsewhere: Vec<usize> =
            (0..map.len()).filter(|&c| !bars.is_around(c)).filter(floating).take(2).collect();
        around.iter().chain(&elsewhere).for_each(|&cell| map[cell] = 1.0);
        let score = BarScore::new(&bars, &map);
        assert_eq!((score.gaps, score.longest_gap), (1, 2));
        assert!((score.worst_bar() - (1.0 - 2.0 / bars.cells[0].len() as f64)).abs() < 1e-12);
        assert_eq!((score.in_air, score.outliers, score.outliers_around), (3, 3, 1));
        assert!(!score.is_complete() && !score.is_clean());
    }
}
