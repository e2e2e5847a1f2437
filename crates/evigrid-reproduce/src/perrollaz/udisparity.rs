//! All counts and probabilities of one frame of three worlds, from true disparities, so that others can check theirs.

use anyhow::Result;

use super::exact::{PAPER, Scene};
use crate::job::Job;
use crate::table::rounded;

/// Worlds and their frames.
const FRAMES: [(&str, usize); 3] = [("box-and-pedestrian", 20), ("crossing", 40), ("parked-row", 50)];

const HEADER: [&str; 10] = [
    "u",
    "d",
    "n_possible",
    "n_visible",
    "n_observed",
    "p_visible",
    "p_confidence",
    "p_road",
    "p_obstacle",
    "p_total",
];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    for (world, frame) in FRAMES {
        job.say(&format!("synth:{world}, frame {frame}"));
        job.write_more(world, &HEADER, rows(world, frame)?)?;
    }
    Ok(())
}

/// Column by column, disparities from 1 on.
fn rows(world: &str, frame: usize) -> Result<Vec<Vec<String>>> {
    let grid = Scene::new(world, frame)?.grid(PAPER);
    let cells = (0..grid.columns()).flat_map(|u| (1..=grid.disparities()).map(move |d| (u, d)));
    let row = |(u, d): (usize, usize)| {
        let (counts, p) = (grid.counts(u, d), grid.probabilities(u, d));
        let whole = [u, d, counts.possible.into(), counts.visible.into(), counts.observed.into()];
        let shares = [p.visible, p.confidence, p.road, p.obstacle, p.total];
        whole.iter().map(usize::to_string).chain(shares.map(|p| rounded(p, 6))).collect()
    };
    Ok(cells.map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Column 200 of the pedestrian's world, counted by an independent transcription of the paper.
    #[test]
    fn a_cell_of_the_box_world() {
        let rows = rows("box-and-pedestrian", 20).unwrap();
        let row = &rows[200 * 64 + 13];
        assert_eq!(row[..6], ["200", "14", "115", "106", "52", "0.921739"]);
        assert_eq!(row[9], "0.935636");
    }
}
