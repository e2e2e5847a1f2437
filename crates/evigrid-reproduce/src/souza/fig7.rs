//! Fig. 7: the level of cells at the height of the optical centre, in a corridor and outdoors.

use anyhow::{Context, Result};
use evigrid_eval::{Mapped, Recording, map_together};
use evigrid_inverse_model::{Slice, horizontal_slice};
use evigrid_synth::World;
use plotters::prelude::RGBColor;

use super::matchers::{MATCHERS, Matcher};
use super::robot::{CELL_M, DRIVES, Drive, FRAMES, STRIDE, Surfaces};
use crate::cells::{Patches, blend};
use crate::chart::{Axis, Marks, ORANGE, Panel, Series, Sheet, rectangle};
use crate::job::Job;
use crate::table::rounded;

const UNSEEN: RGBColor = RGBColor(206, 222, 236);
/// The part of the world that is shown: so far to both sides, and up to so far ahead, metres.
const HALF_M: f64 = 4.0;
const END_M: f64 = 24.0;

/// One level of a map, with the laser's.
struct Level {
    world: &'static str,
    matcher: &'static str,
    origin_m: [f64; 2],
    slice: Slice,
    occupied: Vec<bool>,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut levels = Vec::new();
    for drive in &DRIVES {
        for matcher in &MATCHERS {
            levels.push(Level::new(job, drive, matcher)?);
        }
    }
    let header = ["world", "matcher", "x_m", "y_m", "log_odds", "laser_occupied"];
    job.write_table(&header, levels.iter().flat_map(Level::rows))?;
    job.write_more(
        "scores",
        &["world", "matcher", "hits", "mistakes", "missed", "precision", "recall", "paper"],
        levels.iter().map(Level::scores),
    )?;
    job.write_picture(&Sheet {
        title: "Fig. 7: one level of the map, at the height of the camera".into(),
        notes: vec![
            format!(
                "black: occupied, white: free, blue: not seen, orange: the laser's surfaces; cells of \
                 {CELL_M} m"
            ),
            format!("frames {FRAMES}, every {STRIDE}th, exact poses; the paper shows pictures only"),
        ],
        columns: 1,
        panel: (1160, 440),
        panels: levels.iter().map(Level::panel).collect(),
    })
}

impl Level {
    fn new(job: &mut Job<'_, '_>, drive: &Drive, matcher: &Matcher) -> Result<Self> {
        job.say(&format!("synth:{}, {}", drive.exact, matcher.name));
        let recording = Recording::from(World::builtin(drive.exact)?);
        let look = |mapped: &Mapped<'_>| {
            let map = mapped.voxels()?;
            let spec = map.spec();
            let slice = horizontal_slice(map, 0.0).context("the grid does not hold the camera")?;
            let level = spec.to_cells([0.0; 3])[2] as usize;
            let surfaces = Surfaces::of(mapped).context("a world without a laser")?;
            let occupied = surfaces.occupied.iter().skip(level).step_by(spec.shape()[2]).copied().collect();
            let [x0, y0, _] = spec.origin_m();
            let (world, matcher) = (drive.exact, matcher.name);
            Ok(Self { world, matcher, origin_m: [x0, y0], slice, occupied })
        };
        let config = drive.config(matcher, &["souza.slice=true".to_owned()])?;
        let found = map_together(&recording, vec![config], job.tools.clock, &look, &mut || {})?;
        found.into_iter().next().context("no map")
    }

    fn rows(&self) -> impl Iterator<Item = [String; 6]> + '_ {
        let ny = self.slice.shape[1];
        self.slice.log_odds.iter().zip(&self.occupied).enumerate().map(move |(n, (l, laser))| {
            let centre = |a: usize, i: usize| rounded(self.origin_m[a] + (i as f64 + 0.5) * CELL_M, 3);
            [
                self.world.to_owned(),
                self.matcher.to_owned(),
                centre(0, n / ny),
                centre(1, n % ny),
                rounded(f64::from(*l), 4),
                usize::from(*laser).to_string(),
            ]
        })
    }

    fn scores(&self) -> [String; 8] {
        let pairs = || self.slice.log_odds.iter().zip(&self.occupied);
        let of =
            |found: bool, real: bool| pairs().filter(|(l, t)| (**l > 0.0) == found && **t == real).count();
        let [hits, mistakes, missed] = [of(true, true), of(true, false), of(false, true)];
        [
            self.world.to_owned(),
            self.matcher.to_owned(),
            hits.to_string(),
            mistakes.to_string(),
            missed.to_string(),
            rounded(hits as f64 / (hits + mistakes) as f64, 4),
            rounded(hits as f64 / (hits + missed) as f64, 4),
            "a picture, no numbers".to_owned(),
        ]
    }

    fn panel(&self) -> Panel {
        let [nx, ny] = self.slice.shape;
        let patches = Patches { shape: [nx, ny], origin_m: self.origin_m, edge_m: CELL_M };
        let is_shown = |j: usize| {
            let y = self.origin_m[1] + j as f64 * CELL_M;
            y > -HALF_M - 1e-9 && y + CELL_M < HALF_M + 1e-9
        };
        let value = |i: usize, j: usize| {
            let l = f64::from(self.slice.log_odds[i * ny + j]);
            (is_shown(j) && !l.is_nan()).then_some((l + 2.0) / 4.0)
        };
        let all = Marks::Areas(vec![rectangle([0.0, END_M], [-HALF_M, HALF_M])]);
        let mut series = vec![Series::new("", UNSEEN, all)];
        series.extend(patches.shaded(value, |v| blend(RGBColor(255, 255, 255), RGBColor(0, 0, 0), v)));
        let cells = (0..nx * ny).filter(|&n| self.occupied[n] && is_shown(n % ny));
        let centre = |a: usize, i: usize| self.origin_m[a] + (i as f64 + 0.5) * CELL_M;
        let laser = cells.map(|n| (centre(0, n / ny), centre(1, n % ny))).collect();
        series.push(Series::new("", ORANGE, Marks::Dots(laser, 1)));
        Panel {
            title: format!("{}, {}", self.world, self.matcher),
            x: Axis::new("metres ahead of the first frame", 0.0, END_M),
            y: Axis::new("metres to the left", -HALF_M, HALF_M),
            series,
            legend: None,
        }
    }
}
