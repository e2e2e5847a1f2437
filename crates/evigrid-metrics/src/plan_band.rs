use crate::FrameCell;

/// Probabilities are counted in so many steps: two that fall into one step count as equal.
const STEPS: usize = 10_000;
/// Logarithms are taken of probabilities within these bounds, so that one certain mistake does not decide alone.
const LOG_BOUNDS: [f64; 2] = [0.001, 0.999];

/// Cells counted by probability and by what the laser says.
#[derive(Debug, Clone)]
pub struct PlanBandCounts {
    occupied: Vec<u64>,
    /// Free cells, and those of them that have an occupied one beside them.
    free: Vec<u64>,
    beside: Vec<u64>,
    log_loss: f64,
    squares: f64,
}

/// A bin of the reliability diagram.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reliability {
    /// Where its probabilities begin and end.
    pub range: [f64; 2],
    /// Cells in it.
    pub cells: u64,
    /// Mean of their probabilities; NaN without cells.
    pub mean: f64,
    /// Share of them that is occupied; NaN without cells.
    pub occupied: f64,
}

/// A point of the receiver operating characteristic and of precision and recall: cells of at least this probability
/// are occupied in the plan.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RocPoint {
    /// The threshold.
    pub threshold: f64,
    /// Share of the free cells that are occupied in the plan.
    pub false_positive_rate: f64,
    /// Share of the occupied cells that are so in the plan.
    pub recall: f64,
    /// Share of the plan's occupied cells that are so; NaN if there are none.
    pub precision: f64,
}

impl Default for PlanBandCounts {
    fn default() -> Self {
        let none = || vec![0; STEPS + 1];
        Self { occupied: none(), free: none(), beside: none(), log_loss: 0.0, squares: 0.0 }
    }
}

impl PlanBandCounts {
    pub(crate) fn add(&mut self, cell: &FrameCell) {
        let p = f64::from(cell.probability).clamp(0.0, 1.0);
        let step = (p * STEPS as f64).round() as usize;
        let truth = f64::from(u8::from(cell.occupied));
        if cell.occupied {
            self.occupied[step] += 1;
        } else {
            self.free[step] += 1;
            self.beside[step] += u64::from(cell.beside_occupied);
        }
        let bounded = p.clamp(LOG_BOUNDS[0], LOG_BOUNDS[1]);
        self.log_loss -= if cell.occupied { bounded.ln() } else { (1.0 - bounded).ln() };
        self.squares += (p - truth) * (p - truth);
    }

    pub(crate) fn append(&mut self, other: &Self) {
        let add = |to: &mut [u64], from: &[u64]| to.iter_mut().zip(from).for_each(|(to, from)| *to += from);
        add(&mut self.occupied, &other.occupied);
        add(&mut self.free, &other.free);
        add(&mut self.beside, &other.beside);
        self.log_loss += other.log_loss;
        self.squares += other.squares;
    }

    /// Number of cells, over all frames.
    pub fn cells(&self) -> u64 {
        self.occupied_cells() + self.free.iter().sum::<u64>()
    }

    /// Number of cells that the laser says are occupied.
    pub fn occupied_cells(&self) -> u64 {
        self.occupied.iter().sum()
    }

    /// Area under the receiver operating characteristic: the chance that an occupied cell has a higher probability
    /// than a free one; ties count half. NaN without cells of both kinds.
    pub fn auc(&self) -> f64 {
        area(&self.occupied, self.free.iter().copied())
    }

    /// The same without free cells that have an occupied one beside them: the laser's edge lies anywhere in a cell.
    pub fn auc_off_borders(&self) -> f64 {
        area(&self.occupied, self.free.iter().zip(&self.beside).map(|(free, beside)| free - beside))
    }

    /// Mean logarithm of the probability of what is so, negative; probabilities are kept within 0.001 and 0.999.
    pub fn log_loss(&self) -> f64 {
        self.log_loss / self.cells() as f64
    }

    /// Mean square of the difference between probability and truth (Brier 1950).
    pub fn brier(&self) -> f64 {
        self.squares / self.cells() as f64
    }

    /// Average precision: sum over the thresholds of the rise in recall times the precision there.
    pub fn average_precision(&self) -> f64 {
        let (all, mut hits, mut found, mut sum) = (self.occupied_cells(), 0, 0, 0.0);
        for (occupied, free) in self.occupied.iter().zip(&self.free).rev() {
            hits += occupied;
            found += occupied + free;
            if found > 0 {
                sum += *occupied as f64 * hits as f64 / found as f64;
            }
        }
        sum / all as f64
    }

    /// The best F1 of any threshold, and that threshold. NaN without occupied cells.
    pub fn best_f1(&self) -> [f64; 2] {
        let (all, mut hits, mut mistakes) = (self.occupied_cells(), 0, 0);
        let mut best = [f64::NAN; 2];
        for (step, (occupied, free)) in self.occupied.iter().zip(&self.free).enumerate().rev() {
            (hits, mistakes) = (hits + occupied, mistakes + free);
            let f1 = 2.0 * hits as f64 / (all + hits + mistakes) as f64;
            if all > 0 && (f1 > best[0] || best[0].is_nan()) {
                best = [f1, step as f64 / STEPS as f64];
            }
        }
        best
    }

    /// The reliability diagram in ten bins.
    pub fn reliability(&self) -> Vec<Reliability> {
        let bin = |number: usize| {
            let size = STEPS / 10;
            let end = if number == 9 { STEPS + 1 } else { (number + 1) * size };
            let steps = number * size..end;
            let (mut cells, mut occupied, mut sum) = (0, 0, 0.0);
            for step in steps {
                let here = self.occupied[step] + self.free[step];
                cells += here;
                occupied += self.occupied[step];
                sum += here as f64 * step as f64 / STEPS as f64;
            }
            let range = [number as f64 / 10.0, (number + 1) as f64 / 10.0];
            let share = |part: f64| part / cells as f64;
            Reliability { range, cells, mean: share(sum), occupied: share(occupied as f64) }
        };
        (0..10).map(bin).collect()
    }

    /// The characteristic at every hundredth, from 1 down to 0.
    pub fn roc(&self) -> Vec<RocPoint> {
        let all = [self.occupied_cells() as f64, self.free.iter().sum::<u64>() as f64];
        let point = |hundredth: usize| {
            let from = hundredth * STEPS / 100;
            let [hits, mistakes] =
                [&self.occupied, &self.free].map(|counts| counts[from..].iter().sum::<u64>() as f64);
            RocPoint {
                threshold: hundredth as f64 / 100.0,
                false_positive_rate: mistakes / all[1],
                recall: hits / all[0],
                precision: hits / (hits + mistakes),
            }
        };
        (0..=100).rev().map(point).collect()
    }
}

fn area(occupied: &[u64], free: impl Iterator<Item = u64>) -> f64 {
    let (mut below, mut ordered, mut all) = (0.0, 0.0, 0.0);
    for (&occupied, free) in occupied.iter().zip(free) {
        let (occupied, free) = (occupied as f64, free as f64);
        ordered += occupied * (below + 0.5 * free);
        below += free;
        all += occupied;
    }
    ordered / (all * below)
}

#[cfg(test)]
mod tests {
    use crate::{FrameCell, PlanTally};

    fn cells() -> Vec<FrameCell> {
        let mut state = 3_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / f64::from(1 << 24)
        };
        let cell = |_| {
            let occupied = random() < 0.3;
            let shift = if occupied { 0.3 } else { 0.0 };
            // Whole thousandths, so that there are ties and steps are exact.
            let probability = ((0.7 * random() + shift) * 1000.0).round() as f32 / 1000.0;
            FrameCell { probability, occupied, beside_occupied: random() < 0.2, range_m: 22.0 * random() }
        };
        (0..900).map(cell).collect()
    }

    /// Every pair by itself.
    #[test]
    fn areas_and_losses_are_those_of_their_definitions() {
        let cells = cells();
        let mut tally = PlanTally::default();
        tally.add(cells[..400].iter().copied());
        tally.add(cells[400..].iter().copied());
        assert_eq!(tally.frames, 2);
        let near: Vec<&FrameCell> = cells.iter().filter(|cell| cell.range_m < 20.0).collect();
        let all = tally.all();
        assert_eq!(all.cells() as usize, near.len());
        let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-9, "{a} {b}");
        let area = |is_counted: &dyn Fn(&FrameCell) -> bool| {
            let occupied: Vec<_> = near.iter().filter(|cell| cell.occupied).collect();
            let free: Vec<_> = near.iter().filter(|cell| !cell.occupied && is_counted(cell)).collect();
            let order = |a: f32, b: f32| {
                if a > b {
                    1.0
                } else if a == b {
                    0.5
                } else {
                    0.0
                }
            };
            let pairs = occupied.iter().flat_map(|o| free.iter().map(move |f| (o, f)));
            let sum: f64 = pairs.map(|(o, f)| order(o.probability, f.probability)).sum();
            sum / (occupied.len() * free.len()) as f64
        };
        close(all.auc(), area(&|_| true));
        close(all.auc_off_borders(), area(&|cell| !cell.beside_occupied));
        let mean = |of: &dyn Fn(f64, bool) -> f64| {
            near.iter().map(|cell| of(f64::from(cell.probability), cell.occupied)).sum::<f64>()
                / near.len() as f64
        };
        close(all.brier(), mean(&|p, occupied| (p - f64::from(u8::from(occupied))).powi(2)));
        close(
            all.log_loss(),
            mean(&|p, occupied| {
                let p = p.clamp(0.001, 0.999);
                if occupied { -p.ln() } else { -(1.0 - p).ln() }
            }),
        );
    }

    #[test]
    fn thresholds_are_tried_one_by_one() {
        let cells = cells();
        let mut tally = PlanTally::default();
        tally.add(cells.iter().copied());
        let ends = [0.0, 5.0, 10.0, 15.0, 20.0];
        let mut best = Vec::new();
        for (n, ([from, to], band)) in tally.bands().enumerate() {
            assert_eq!([from, to], [ends[n], ends[n + 1]]);
            let own: Vec<_> = cells.iter().filter(|c| (from..to).contains(&c.range_m)).collect();
            let f1 = |threshold: f32| {
                let found = |c: &&&FrameCell| c.probability >= threshold;
                let hits = own.iter().filter(found).filter(|c| c.occupied).count();
                let all = own.iter().filter(|c| c.occupied).count() + own.iter().filter(found).count();
                2.0 * hits as f64 / all as f64
            };
            let expected = own.iter().map(|c| f1(c.probability)).fold(0.0, f64::max);
            assert!((band.best_f1()[0] - expected).abs() < 1e-9);
            best.push(expected);
        }
        assert!((tally.band_mean_f1() - best.iter().sum::<f64>() / 4.0).abs() < 1e-9);
        let all = tally.all();
        let roc = all.roc();
        assert_eq!((roc[100].false_positive_rate, roc[100].recall), (1.0, 1.0));
        let sum: u64 = all.reliability().iter().map(|bin| bin.cells).sum();
        assert_eq!(sum, all.cells());
    }

    #[test]
    fn a_plan_that_knows_nothing_or_all() {
        let of = |p: fn(bool) -> f32| {
            let mut tally = PlanTally::default();
            tally.add([true, false, false, true, false].map(|occupied| FrameCell {
                probability: p(occupied),
                occupied,
                beside_occupied: false,
                range_m: 3.0,
            }));
            tally.all()
        };
        let nothing = of(|_| 0.5);
        assert_eq!((nothing.auc(), nothing.brier()), (0.5, 0.25));
        assert!((nothing.log_loss() - 2_f64.ln()).abs() < 1e-12);
        let perfect = of(|occupied| f32::from(u8::from(occupied)));
        assert_eq!((perfect.auc(), perfect.brier(), perfect.average_precision()), (1.0, 0.0, 1.0));
        assert_eq!(perfect.best_f1(), [1.0, 1.0]);
        assert!(PlanTally::default().all().auc().is_nan());
    }
}
