//! Possible, visible and observed pixels of every cell (Perrollaz et al. 2012, 4.3.1).

use std::ops::Range;

use rayon::prelude::*;

use crate::Pixels;
use crate::level::LevelView;

/// Rows of the image that could show a cell: from the largest height that is looked at down to the ground.
///
/// `v_h(d)` and `v_0(d)` are rounded to the nearest row, halves down the image (within 1e-9 of a half, so that a
/// division's last digit does not decide), and cut to the image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Rows(Vec<Range<usize>>);

impl Rows {
    /// The rows of the disparities 1 to `disparities`.
    pub fn new(view: &LevelView, top_m: f64, disparities: usize) -> Self {
        let rig = &view.rig;
        let row = |height_m: f64, d: usize| {
            let exact = rig.centre_y_px + (view.height_m - height_m) * d as f64 / rig.baseline_m;
            let rounded = (exact + 0.5 + 1e-9).floor();
            rounded.clamp(0.0, rig.height as f64) as usize
        };
        let rows = (1..=disparities).map(|d| row(top_m, d)..row(0.0, d));
        Self(rows.map(|rows| rows.start..rows.end.max(rows.start)).collect())
    }

    /// The rows of a disparity from 1 on.
    pub fn of(&self, disparity: usize) -> Range<usize> {
        self.0[disparity - 1].clone()
    }

    /// N_P: the number of possible pixels of a disparity (eq. 10).
    pub fn possible(&self, disparity: usize) -> u16 {
        self.0[disparity - 1].len() as u16
    }

    /// The largest disparity.
    pub fn disparities(&self) -> usize {
        self.0.len()
    }
}

/// Columns that are counted side by side.
pub(crate) const LANES: usize = 32;
/// Blocks of columns per task.
const BLOCKS_PER_TASK: usize = 4;

/// Visible and observed pixels of every cell, and the cells in which the road is seen.
#[derive(Debug, Default)]
pub struct Counts {
    blocks: Vec<Block>,
}

/// Counts of some neighbouring columns, for the disparities from 0 on.
#[derive(Debug, Default, Clone)]
pub(crate) struct Block {
    pub visible: Vec<[u16; LANES]>,
    pub observed: Vec<[u16; LANES]>,
    pub is_road: Vec<[u8; LANES]>,
    /// Pixels of the current rows by their disparity, and those of the road beyond them.
    obstacles: Vec<[u16; LANES]>,
    road: Vec<[u16; LANES]>,
}

impl Counts {
    /// Counts anew. `count_road`: road pixels farther than a cell count as visible too.
    ///
    /// The rows of a cell grow (or move) with its disparity, so each row enters and leaves once: the work is that of
    /// looking at every pixel once, whatever it shows.
    pub fn fill(&mut self, pixels: &Pixels, rows: &Rows, count_road: bool) {
        self.blocks.resize_with(pixels.width.div_ceil(LANES), Block::default);
        self.blocks
            .par_iter_mut()
            .enumerate()
            .with_min_len(BLOCKS_PER_TASK)
            .for_each(|(number, block)| block.fill(pixels, rows, count_road, number * LANES));
    }

    /// Visible pixels of a cell.
    pub fn visible(&self, column: usize, disparity: usize) -> u16 {
        self.blocks[column / LANES].visible[disparity][column % LANES]
    }

    /// Observed pixels of a cell.
    pub fn observed(&self, column: usize, disparity: usize) -> u16 {
        self.blocks[column / LANES].observed[disparity][column % LANES]
    }

    /// Whether any pixel of a column shows the road at a disparity.
    pub fn is_road(&self, column: usize, disparity: usize) -> bool {
        self.blocks[column / LANES].is_road[disparity][column % LANES] != 0
    }

    pub(crate) fn blocks(&self) -> &[Block] {
        &self.blocks
    }
}

impl Block {
    fn fill(&mut self, pixels: &Pixels, rows: &Rows, count_road: bool, first: usize) {
        let disparities = rows.disparities();
        for counts in [&mut self.visible, &mut self.observed, &mut self.obstacles, &mut self.road] {
            counts.clear();
            // One more for the road, as a pixel at d counts as beyond from d + 1 on, and one for what is nearer.
            counts.resize(disparities + 3, [0; LANES]);
        }
        self.is_road.clear();
        self.is_road.resize(disparities + 3, [0; LANES]);
        let columns = first..(first + LANES).min(pixels.width);
        for row in pixels.road.chunks_exact(pixels.width) {
            for (lane, &road) in row[columns.clone()].iter().enumerate() {
                self.is_road[usize::from(road).min(disparities + 1)][lane] = 1;
            }
        }
        self.is_road[0] = [0; LANES];
        self.is_road[disparities + 1] = [0; LANES];
        if count_road {
            self.count::<true>(pixels, rows, &columns);
        } else {
            self.count::<false>(pixels, rows, &columns);
        }
    }

    fn count<const ROAD: bool>(&mut self, pixels: &Pixels, rows: &Rows, columns: &Range<usize>) {
        let mut visible = [0_u16; LANES];
        let mut current = rows.of(1).start..rows.of(1).start;
        for d in 1..=rows.disparities() {
            // Pixels of the rows so far that show what is at d, or road just beyond it, become visible.
            let new = self.obstacles[d].iter().zip(&self.road[d]);
            visible.iter_mut().zip(new).for_each(|(visible, (obstacle, road))| *visible += obstacle + road);
            let next = rows.of(d);
            for row in next.clone().filter(|row| !current.contains(row)) {
                self.move_row::<ROAD>(pixels, row, columns, d, &mut visible, 1);
            }
            for row in current.filter(|row| !next.contains(row)) {
                self.move_row::<ROAD>(pixels, row, columns, d, &mut visible, u16::MAX);
            }
            current = next;
            self.visible[d] = visible;
            self.observed[d] = self.obstacles[d];
        }
    }

    /// A row enters the rows of disparity `d` (`by` = 1) or leaves them (-1, wrapped).
    #[inline(always)]
    fn move_row<const ROAD: bool>(
        &mut self,
        pixels: &Pixels,
        row: usize,
        columns: &Range<usize>,
        d: usize,
        visible: &mut [u16; LANES],
        by: u16,
    ) {
        let nearest = self.obstacles.len() - 1;
        let range = row * pixels.width + columns.start..row * pixels.width + columns.end;
        let obstacles = &pixels.obstacles[range.clone()];
        for (lane, &obstacle) in obstacles.iter().enumerate() {
            // Those without a disparity are counted at 0, where nobody looks.
            let count = &mut self.obstacles[usize::from(obstacle).min(nearest)][lane];
            *count = count.wrapping_add(by);
        }
        let most = d as u16;
        for (visible, &obstacle) in visible.iter_mut().zip(obstacles) {
            // 0 becomes the largest number, so that one comparison tells.
            let is_visible = obstacle.wrapping_sub(1) < most;
            *visible = visible.wrapping_add(if is_visible { by } else { 0 });
        }
        if ROAD {
            let values = pixels.road[range].iter().zip(obstacles).enumerate();
            for (lane, (&road, _)) in values.filter(|(_, (road, obstacle))| **road != 0 && **obstacle == 0) {
                let road = usize::from(road);
                let count = &mut self.road[(road + 1).min(nearest)][lane];
                *count = count.wrapping_add(by);
                visible[lane] = visible[lane].wrapping_add(if road < d { by } else { 0 });
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::{GroundPlane, Mounting, StereoRig};

    fn view(height_m: f64) -> LevelView {
        let rig = StereoRig {
            width: 512,
            height: 320,
            focal_px: 410.0,
            centre_x_px: 255.5,
            centre_y_px: 159.5,
            baseline_m: 0.22,
        };
        let ground = GroundPlane::below(&Mounting::over_middle(height_m, 0.0)).disparities(&rig);
        LevelView::new(&rig, &ground).unwrap()
    }

    /// H = 1.2 m, h = 1.8 m: v_0 = 159.5 + 60 d / 11, v_h = 159.5 - 30 d / 11.
    #[test]
    fn rows_of_the_papers_camera() {
        let rows = Rows::new(&view(1.2), 1.8, 64);
        assert_eq!([rows.possible(5), rows.possible(45), rows.possible(14)], [41, 283, 115]);
        assert_eq!(rows.of(14), 121..236);
        // Ties: 219.5 and 129.5 at d = 11, 99.5 at d = 22; 339.5 is below the image.
        assert_eq!([rows.of(11), rows.of(22), rows.of(33)], [130..220, 100..280, 70..320]);
    }

    #[test]
    fn a_low_ceiling_has_its_rows_below_the_horizon() {
        let rows = Rows::new(&view(3.0), 1.0, 64);
        // v_h = 159.5 + 2 / 0.22 d, v_0 = 159.5 + 3 / 0.22 d.
        assert_eq!(rows.of(5), 205..228);
        assert_eq!(rows.of(64), 320..320);
    }

    fn random_pixels(width: usize, height: usize, largest: u16, seed: u64) -> Pixels {
        let mut state = seed | 1;
        let mut random = move || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 33) as u16
        };
        let mut pixels = Pixels { width, height, obstacles: vec![], road: vec![] };
        for _ in 0..width * height {
            let (kind, disparity) = (random() % 3, random() % (largest + 1));
            pixels.obstacles.push(if kind == 0 { disparity } else { 0 });
            pixels.road.push(if kind == 1 { disparity } else { 0 });
        }
        pixels
    }

    /// Every cell by itself, as the paper says it.
    #[test]
    fn counts_are_those_of_the_definition() {
        for (height_m, top_m, width, seed) in
            [(1.2, 1.8, 70, 3), (3.0, 1.0, 33, 4), (1.6, 5.0, 5, 9), (0.4, 0.1, 64, 8)]
        {
            let pixels = random_pixels(width, 320, 30, seed);
            let rows = Rows::new(&view(height_m), top_m, 25);
            for count_road in [false, true] {
                let mut counts = Counts::default();
                counts.fill(&pixels, &rows, count_road);
                for (u, d) in (0..width).flat_map(|u| (1..=25).map(move |d| (u, d))) {
                    let column = |row: usize| row * width + u;
                    let obstacle = |row: usize| usize::from(pixels.obstacles[column(row)]);
                    let road = |row: usize| usize::from(pixels.road[column(row)]);
                    let is_visible = |row: &usize| {
                        let beyond = count_road && obstacle(*row) == 0 && (1..d).contains(&road(*row));
                        (1..=d).contains(&obstacle(*row)) || beyond
                    };
                    let visible = rows.of(d).filter(is_visible).count();
                    let observed = rows.of(d).filter(|row| obstacle(*row) == d).count();
                    assert_eq!(usize::from(counts.visible(u, d)), visible, "{u} {d}");
                    assert_eq!(usize::from(counts.observed(u, d)), observed, "{u} {d}");
                    assert_eq!(counts.is_road(u, d), (0..320).any(|row| road(row) == d));
                }
            }
        }
    }
}
