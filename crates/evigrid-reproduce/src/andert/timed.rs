//! Rows of Table I: what an algorithm counts, how long it takes, and what must be true of its counts.

use anyhow::Result;
use evigrid_core::{MatchFilter, MatchLimits, Matching};
use evigrid_grid::Mapper;
use evigrid_inverse_model::Counters;

use super::algorithms::{ALL, Algorithm};
use super::published::{PUBLISHED, Published};
use super::scene::{CELLS_M, Scene, grid};
use crate::job::Job;
use crate::stopwatch::Stopwatch;
use crate::table::rounded;

/// The pictures: true disparities up to 25 m, and what block matching finds.
pub const EXACT: &str = "exact";
pub const MATCHED: &str = "matched";

/// One row of ours.
pub struct Timed {
    pub image: &'static str,
    pub cell_size_m: f64,
    pub algorithm: Algorithm,
    pub valid_pixels: u64,
    pub counters: Counters,
    pub median_ms: f64,
    pub fastest_ms: f64,
    pub paper: Published,
}

/// All algorithms on both pictures in all cell sizes.
pub fn measure(job: &mut Job<'_, '_>, scene: &Scene, repetitions: usize) -> Result<Vec<Timed>> {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    let mut rows = Vec::new();
    for (image, matching) in [(EXACT, &scene.exact), (MATCHED, &scene.matched)] {
        for (cell_size_m, published) in CELLS_M.into_iter().zip(&PUBLISHED) {
            job.say(&format!("{image} disparities, cells of {cell_size_m} m"));
            let watch = Stopwatch { clock: job.tools.clock, repetitions };
            let of_paper = ALL.into_iter().zip(published.iter().copied());
            for (algorithm, paper) in of_paper.chain([(Algorithm::RayMetre, published[2])]) {
                let picture = Picture { image, matching };
                rows.push(pool.install(|| time(&watch, scene, picture, cell_size_m, algorithm, paper))?);
            }
        }
    }
    Ok(rows)
}

fn time(
    watch: &Stopwatch<'_>,
    scene: &Scene,
    picture: Picture<'_>,
    cell_size_m: f64,
    algorithm: Algorithm,
    paper: Published,
) -> Result<Timed> {
    let mut mapper = algorithm.mapper(grid(cell_size_m)?)?;
    let view = scene.view(picture.matching);
    let [median_s, fastest_s] = watch.time(|| Ok(mapper.integrate(&view)?))?;
    Ok(Timed {
        image: picture.image,
        cell_size_m,
        algorithm,
        valid_pixels: believed(picture.matching)?,
        counters: *mapper.counters(),
        median_ms: 1e3 * median_s,
        fastest_ms: 1e3 * fastest_s,
        paper,
    })
}

/// A picture's name and what was matched in it.
#[derive(Clone, Copy)]
struct Picture<'a> {
    image: &'static str,
    matching: &'a Matching,
}

/// The filters of the methods' defaults: peak ratio 1.5, left-right difference up to 1 px.
pub const BELIEVED: MatchLimits =
    MatchLimits { peak_ratio: 1.5, left_right_px: Some(1), too_near_px: f64::INFINITY };

/// Pixels that pass them.
fn believed(matching: &Matching) -> Result<u64> {
    Ok(MatchFilter::new(&matching.matches, &BELIEVED).disparity()?.valid_count() as u64)
}

impl Timed {
    /// Identities of the published table that our counts break; empty if all hold.
    pub fn broken_identities(&self) -> Vec<&'static str> {
        let Counters { coordinate_transfers, used_pixels, cells_drawn, different_cells, .. } = self.counters;
        let all = if self.algorithm.draws_lines() {
            vec![
                (coordinate_transfers == used_pixels + 1, "transfers = used pixels + 1"),
                (
                    self.algorithm != Algorithm::Line || used_pixels == self.valid_pixels,
                    "used pixels = valid pixels",
                ),
                (different_cells <= cells_drawn, "different cells <= cells drawn"),
            ]
        } else {
            vec![
                (coordinate_transfers == cells_drawn + 5, "transfers = cells + 5"),
                (different_cells == cells_drawn, "different cells = cells drawn"),
                (
                    self.algorithm != Algorithm::RayPyramid || used_pixels.is_multiple_of(4),
                    "used pixels = 4 x visible cells",
                ),
            ]
        };
        all.into_iter().filter(|(holds, _)| !holds).map(|(_, name)| name).collect()
    }

    /// The row as it is written.
    pub fn row(&self) -> [String; 18] {
        let (counters, paper) = (&self.counters, &self.paper);
        let broken = self.broken_identities();
        [
            self.image.to_owned(),
            self.cell_size_m.to_string(),
            self.algorithm.name().to_owned(),
            self.valid_pixels.to_string(),
            counters.coordinate_transfers.to_string(),
            counters.used_pixels.to_string(),
            counters.lines.to_string(),
            counters.cells_drawn.to_string(),
            counters.different_cells.to_string(),
            counters.touched_cells.to_string(),
            rounded(self.median_ms, 3),
            rounded(self.fastest_ms, 3),
            if broken.is_empty() { "met".to_owned() } else { format!("broken: {}", broken.join(", ")) },
            paper.transfers.to_string(),
            paper.used_pixels.to_string(),
            paper.cells_drawn.to_string(),
            paper.different_cells.to_string(),
            paper.ms.to_string(),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Counts that no image changes, computed independently from the geometry alone: cells of the box, cells
    /// whose centre is seen, pixels in the windows.
    #[test]
    fn counts_of_rays_are_those_of_the_geometry() {
        let scene = Scene::new().unwrap();
        let counts = |c: f64, algorithm: Algorithm| {
            algorithm.mapper(grid(c).unwrap()).unwrap().single_image(&scene.view(&scene.exact)).1
        };
        for (c, cells, visible, window, metre) in
            [(1.0, 11_232, 3_684, 10_289_894, 10_289_894), (0.5, 84_456, 27_744, 22_030_312, 81_147_601)]
        {
            let [ray, pyramid, wide] =
                [Algorithm::Ray, Algorithm::RayPyramid, Algorithm::RayMetre].map(|a| counts(c, a));
            assert_eq!([ray.cells_drawn, pyramid.cells_drawn], [cells; 2]);
            assert_eq!(pyramid.used_pixels, 4 * visible);
            assert_eq!([ray.used_pixels, wide.used_pixels], [window, metre]);
        }
    }

    #[test]
    fn identities_of_the_published_table_hold_for_both() {
        let scene = Scene::new().unwrap();
        for (c, published) in CELLS_M.into_iter().zip(PUBLISHED) {
            for (algorithm, paper) in ALL.into_iter().zip(published) {
                let counters =
                    algorithm.mapper(grid(c).unwrap()).unwrap().single_image(&scene.view(&scene.exact)).1;
                let valid_pixels = scene.exact.matches.disparity.valid_count() as u64;
                let ours = Timed {
                    image: EXACT,
                    cell_size_m: c,
                    algorithm,
                    valid_pixels,
                    counters,
                    median_ms: 1.0,
                    fastest_ms: 1.0,
                    paper,
                };
                assert!(ours.broken_identities().is_empty(), "{:?}", ours.broken_identities());
                let counters = Counters {
                    coordinate_transfers: paper.transfers,
                    used_pixels: paper.used_pixels,
                    cells_drawn: paper.cells_drawn,
                    different_cells: paper.different_cells,
                    ..counters
                };
                let theirs = Timed { valid_pixels: 194_047, counters, ..ours };
                assert!(theirs.broken_identities().is_empty());
            }
        }
        // As many valid pixels as in the paper, to 0.3 % of the image.
        assert!((scene.exact.matches.disparity.valid_count() as f64 - 194_047.0).abs() < 0.003 * 307_200.0);
    }
}
