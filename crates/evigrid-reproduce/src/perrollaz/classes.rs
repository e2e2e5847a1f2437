//! How many matched pixels get the right class from double correlation, and what a wrong mounting costs.

use anyhow::Result;
use evigrid_core::{GroundPlane, Mounting};
use evigrid_eval::MatchSource;
use evigrid_grid::Needs;
use evigrid_stereo::GroundSource;
use evigrid_synth::LeftViewTruth;

use super::scene::config;
use crate::job::Job;
use crate::murarka::mapping::Drive;
use crate::table::rounded;

/// Every so many frames of each world.
const WORLDS: [(&str, usize); 3] = [("crossing", 20), ("box-and-pedestrian", 10), ("parked-row", 20)];
/// Where the ground is taken from: the mounting, too high and too low by so much (metres), or the frame.
const GROUNDS: [(&str, GroundSource, f64); 4] = [
    ("mounting", GroundSource::Mounting, 0.0),
    ("mounting + 0.1 m", GroundSource::Mounting, 0.1),
    ("mounting - 0.1 m", GroundSource::Mounting, -0.1),
    ("v-disparity", GroundSource::VDisparity, 0.1),
];
/// Surfaces nearer to the ground are road, metres: kerbs and pavements count as road.
const ROAD_WITHIN_M: f64 = 0.15;

/// Matched pixels by true class: right and wrong.
#[derive(Debug, Default, Clone, Copy)]
struct Counts {
    road: [usize; 2],
    obstacle: [usize; 2],
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut rows = Vec::new();
    for (world, step) in WORLDS {
        job.say(&format!("synth:{world}"));
        let drive = Drive::new(world)?;
        for (name, source, higher_m) in GROUNDS {
            let mounting = Mounting { height_m: drive.mounting.height_m + higher_m, ..drive.mounting };
            let mut matches = MatchSource::new(&config(source), Some(mounting), Some(&drive.world))?;
            let mut counts = Counts::default();
            for frame in drive.frames().step_by(step) {
                counts.add(&drive, &mut matches, frame)?;
            }
            rows.push(counts.row(world, name));
        }
    }
    let header = [
        "world",
        "ground",
        "road_pixels",
        "obstacle_pixels",
        "right_percent",
        "road_right_percent",
        "obstacle_right_percent",
    ];
    job.write_table(&header, rows)
}

impl Counts {
    /// Counts pixels whose match the right image confirms and that show something nearer than the sky.
    fn add(&mut self, drive: &Drive, matches: &mut MatchSource, index: usize) -> Result<()> {
        let frame = drive.frame(index)?;
        let matching = matches.run(&frame, Needs { road: true, ..Needs::MATCHES })?;
        let (truth, ground) = (LeftViewTruth::new(&drive.world, index), GroundPlane::below(&drive.mounting));
        let Some(split) = &matching.road else { return Ok(()) };
        for (n, pixel) in truth.pixels().iter().enumerate() {
            let is_matched = matching.matches.left_right_difference_px[n] <= 1;
            if !is_matched || pixel.depth_m.is_infinite() {
                continue;
            }
            let ray = frame.rig().ray((n % truth.width()) as f64, (n / truth.width()) as f64);
            let is_road = ground.height_of_m(&(ray * pixel.depth_m)).abs() < ROAD_WITHIN_M;
            let says_road = !split.road.values()[n].is_nan();
            let counts = if is_road { &mut self.road } else { &mut self.obstacle };
            counts[usize::from(is_road != says_road)] += 1;
        }
        matches.recycle(matching);
        Ok(())
    }

    fn row(&self, world: &str, ground: &str) -> Vec<String> {
        let percent = |[right, wrong]: [usize; 2]| rounded(100.0 * right as f64 / (right + wrong) as f64, 2);
        let all = [0, 1].map(|n| self.road[n] + self.obstacle[n]);
        let pixels = [self.road, self.obstacle].map(|counts| (counts[0] + counts[1]).to_string());
        let names = [world, ground].map(str::to_owned);
        names.into_iter().chain(pixels).chain([all, self.road, self.obstacle].map(percent)).collect()
    }
}
