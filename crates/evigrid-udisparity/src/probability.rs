//! Probabilities of one cell of the u-disparity grid (eqs 4 to 15).

/// Parameters of the model.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Parameters {
    /// P_FP: an obstacle is matched where there is none.
    pub false_positive: f64,
    /// P_FN: none is matched where there is one.
    pub false_negative: f64,
    /// tau_O.
    pub tau_obstacle: f64,
    /// tau_R.
    pub tau_road: f64,
}

/// Pixels of one cell.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct CellCounts {
    /// Pixels of the column between the ground and the largest height at the cell's disparity (eq. 9).
    pub possible: u16,
    /// Those of them that show something at the cell or behind it.
    pub visible: u16,
    /// Those of them that show an obstacle at the cell.
    pub observed: u16,
    /// Cells with road pixels among the cell and its eight neighbours.
    pub road: u8,
}

/// Probabilities of one cell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CellProbabilities {
    /// P(V): it is visible (eq. 11).
    pub visible: f64,
    /// P(C): an obstacle is seen in it (eq. 13).
    pub confidence: f64,
    /// P(R): it belongs to the road alone (eq. 15).
    pub road: f64,
    /// P(O): it is occupied, by obstacle pixels (eq. 8).
    pub obstacle: f64,
    /// P(T): it is occupied, by all pixels (eq. 14).
    pub total: f64,
}

/// Cells of a 3x3 neighbourhood.
const NEIGHBOURHOOD: f64 = 9.0;

impl Parameters {
    /// P(O) of eq. 8 from P(V) and P(C).
    pub fn p_obstacle(&self, visible: f64, confidence: f64) -> f64 {
        visible * confidence * (1.0 - self.false_positive)
            + visible * (1.0 - confidence) * self.false_negative
            + (1.0 - visible) * 0.5
    }

    /// P(C) of eq. 13 from r_O, the share of the visible pixels that show an obstacle.
    pub fn p_confidence(&self, obstacle_share: f64) -> f64 {
        1.0 - (-obstacle_share / self.tau_obstacle).exp()
    }

    /// P(R) of eq. 15 from r_R, the share of road cells in the neighbourhood, and r_O.
    pub fn p_road(&self, road_share: f64, obstacle_share: f64) -> f64 {
        (-(1.0 - road_share) / self.tau_road).exp() * (-obstacle_share / self.tau_obstacle).exp()
    }

    /// All probabilities of a cell. A ratio over no pixels is 0: a cell without possible pixels is invisible, one
    /// without visible pixels shows no obstacle.
    ///
    /// A cell that is fully invisible has P(T) = 0.5 (1 - P(R)) by eq. 14, which the text rounds to 0.5.
    pub fn cell(&self, counts: CellCounts) -> CellProbabilities {
        let share = |part: u16, all: u16| if all == 0 { 0.0 } else { f64::from(part) / f64::from(all) };
        let visible = share(counts.visible, counts.possible);
        let obstacle_share = share(counts.observed, counts.visible);
        let confidence = self.p_confidence(obstacle_share);
        let road = self.p_road(f64::from(counts.road) / NEIGHBOURHOOD, obstacle_share);
        let obstacle = self.p_obstacle(visible, confidence);
        CellProbabilities { visible, confidence, road, obstacle, total: obstacle * (1.0 - road) }
    }
}

/// [`Parameters::cell`] for many cells: what depends on few values stands in tables, and no exponential is computed
/// for a cell that shows no obstacle.
#[derive(Debug)]
pub(crate) struct Table {
    parameters: Parameters,
    /// First factor of eq. 15 by the number of road cells.
    road: [f64; 10],
    /// 1 / n; 0 for 0.
    inverse: Vec<f64>,
}

impl Table {
    /// The table for images of so many rows.
    pub fn new(parameters: Parameters, rows: usize) -> Self {
        let inverse = |n: usize| if n == 0 { 0.0 } else { 1.0 / n as f64 };
        Self {
            parameters,
            road: std::array::from_fn(|n| parameters.p_road(n as f64 / NEIGHBOURHOOD, 0.0)),
            inverse: (0..=rows).map(inverse).collect(),
        }
    }

    /// What the cells of one disparity have in common.
    pub fn row(&self, possible: u16) -> TableRow<'_> {
        let inverse_possible = self.inverse[usize::from(possible)];
        let empty = |n: u16| self.parameters.p_obstacle(f64::from(n) * inverse_possible, 0.0) as f32;
        let free = self.road.map(|road| (1.0 - road) as f32);
        TableRow { table: self, inverse_possible, empty: (0..=possible).map(empty).collect(), free }
    }
}

/// The table for cells with one number of possible pixels.
pub(crate) struct TableRow<'a> {
    table: &'a Table,
    inverse_possible: f64,
    /// P(O) of a cell that shows no obstacle, by the number of visible pixels.
    empty: Vec<f32>,
    /// 1 - P(R) of such a cell, by the number of road cells.
    free: [f32; 10],
}

impl TableRow<'_> {
    /// P(T) of a cell.
    #[inline(always)]
    pub fn total(&self, visible: u16, observed: u16, road: u8) -> f32 {
        let (visible, road) = (usize::from(visible), usize::from(road.min(9)));
        if observed == 0 {
            return self.empty[visible] * self.free[road];
        }
        let p = &self.table.parameters;
        let nothing = (-f64::from(observed) * self.table.inverse[visible] / p.tau_obstacle).exp();
        let obstacle = p.p_obstacle(visible as f64 * self.inverse_possible, 1.0 - nothing);
        (obstacle * (1.0 - self.table.road[road] * nothing)) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const PAPER: Parameters =
        Parameters { false_positive: 0.02, false_negative: 0.02, tau_obstacle: 0.1, tau_road: 0.1 };

    /// Computed by hand from eqs 8, 13, 14 and 15.
    #[test]
    fn values_of_the_equations() {
        let close = |a: f64, b: f64| assert!((a - b).abs() < 5e-7, "{a} {b}");
        for (share, expected) in [(0.1, 0.632_121), (0.2, 0.864_665), (0.5, 0.993_262), (1.0, 0.999_955)] {
            close(PAPER.p_confidence(share), expected);
        }
        for (share, expected) in [(0.0, 0.02), (0.1, 0.626_836), (1.0, 0.979_956)] {
            close(PAPER.p_obstacle(1.0, PAPER.p_confidence(share)), expected);
        }
        let road = |road| PAPER.cell(CellCounts { possible: 50, visible: 50, observed: 0, road });
        assert_eq!((road(9).road, road(9).total), (1.0, 0.0));
        let invisible = |road| PAPER.cell(CellCounts { possible: 50, visible: 0, observed: 0, road }).total;
        for (road, expected) in [(0, 0.499_977), (3, 0.499_364), (8, 0.335_404), (9, 0.0)] {
            close(invisible(road), expected);
        }
        // 115 possible, 106 visible, 52 observed.
        let cell = PAPER.cell(CellCounts { possible: 115, visible: 106, observed: 52, road: 0 });
        close(cell.visible, 0.921_739);
        assert_eq!(PAPER.cell(CellCounts::default()).obstacle, 0.5);
    }

    #[test]
    fn the_table_says_what_the_equations_say() {
        let table = Table::new(PAPER, 60);
        for possible in [0, 1, 7, 60] {
            for (visible, road) in (0..=possible).flat_map(|v| (0..=9).map(move |r| (v, r))) {
                for observed in 0..=visible {
                    let exact = PAPER.cell(CellCounts { possible, visible, observed, road }).total;
                    let fast = table.row(possible).total(visible, observed, road);
                    assert!((f64::from(fast) - exact).abs() < 1e-7, "{possible} {visible} {observed} {road}");
                }
            }
        }
    }
}
