//! Fig. 9: the occupied cells of one scene as cubes.

use anyhow::Result;
use evigrid_core::{Frame, View};
use evigrid_eval::Config;
use evigrid_grid::{GridSpec, LogOddsGrid};
use evigrid_inverse_model::{InverseModelMapper, Souza};
use evigrid_replay::{Sequence, map_from_world};
use evigrid_stereo::{Extras, PairTask};
use evigrid_synth::{SyntheticSequence, VoxelState, VoxelTruth, World};
use nalgebra::Point3;
use plotters::prelude::RGBColor;

use super::matchers::{MATCHERS, Matcher};
use super::robot::{CELL_M, DRIVES};
use crate::chart::{Axis, Marks, ORANGE, Panel, Series, Sheet};
use crate::cubes::{Corner, Slant, cubes};
use crate::image_view::grey_panel;
use crate::job::Job;
use crate::table::rounded;

/// The frame of the corridor that is shown.
const FRAME: usize = 30;
/// The picture ends this far from the camera, metres.
const END_M: f64 = 5.0;
/// How a metre ahead is drawn: a third of it to the right, a fifth of it up.
const SLANT: Slant = Slant([0.3, 0.22]);
const NEAR: RGBColor = RGBColor(30, 90, 200);
const FAR: RGBColor = RGBColor(150, 190, 235);

/// A map of one image.
struct Shot {
    matcher: &'static str,
    map: LogOddsGrid,
    /// Occupied cells, and those of them that hold a surface.
    occupied: usize,
    right: usize,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let world = World::builtin(DRIVES[0].exact)?;
    let here = map_from_world(&world.true_world_from_left(FRAME));
    let frame = SyntheticSequence::new(world.clone()).frame(FRAME, &here)?;
    let mut shots = Vec::new();
    for matcher in &MATCHERS {
        let config = DRIVES[0].config(matcher, &[])?;
        let truth = VoxelTruth::new(&world, GridSpec::new(&config.grid)?, &here, &[FRAME]);
        shots.push(Shot::new(&frame, matcher, &config, &truth)?);
    }
    let header = ["matcher", "x_m", "y_m", "z_m", "log_odds"];
    job.write_table(&header, shots.iter().flat_map(Shot::rows))?;
    let header = ["matcher", "occupied_cells", "of_these_on_a_surface", "precision", "paper"];
    job.write_more("scores", &header, shots.iter().map(Shot::scores))?;
    let size = [frame.rig().width, frame.rig().height];
    let left = frame.left();
    let mut panels = vec![grey_panel("the left image", size, |x, y| left.row(y)[x])];
    panels.extend(shots.iter().map(Shot::panel));
    job.write_picture(&Sheet {
        title: format!("Fig. 9: the occupied cells of one image of the corridor, cells of {CELL_M} m"),
        notes: vec![
            format!(
                "seen from behind the camera (orange), slanted; the paler the farther, up to {END_M} m; \
                 floor and ceiling left out"
            ),
            "the paper shows a picture only".into(),
        ],
        columns: panels.len(),
        panel: (640, 500),
        panels,
    })
}

impl Shot {
    fn new(frame: &Frame, matcher: &Matcher, config: &Config, truth: &VoxelTruth) -> Result<Self> {
        let mut matching = evigrid_stereo::Matcher::new(config.stereo)?;
        let matching = matching.run(PairTask::new(frame.left(), frame.right(), Extras::default()))?;
        let (spec, settings) = (GridSpec::new(&config.grid)?, config.methods.of::<Souza>()?);
        let view = View::new(frame, None, &matching);
        let (map, _) = InverseModelMapper::souza(spec, settings)?.single_image(&view);
        let occupied = || map.touched().filter(|(_, l)| *l > 0.0);
        let right = occupied().filter(|(cell, _)| truth.state(*cell) == VoxelState::Occupied).count();
        let occupied = occupied().count();
        Ok(Self { matcher: matcher.name, map, occupied, right })
    }

    fn rows(&self) -> impl Iterator<Item = [String; 5]> + '_ {
        self.map.touched().filter(|(_, l)| *l > 0.0).map(|(cell, l)| {
            let [x, y, z] = self.map.spec().centre_m(cell).map(|v| rounded(v, 3));
            [self.matcher.to_owned(), x, y, z, rounded(f64::from(l), 4)]
        })
    }

    fn scores(&self) -> [String; 5] {
        [
            self.matcher.to_owned(),
            self.occupied.to_string(),
            self.right.to_string(),
            rounded(self.right as f64 / self.occupied as f64, 4),
            "a picture, no numbers".to_owned(),
        ]
    }

    fn panel(&self) -> Panel {
        // The floor is 0.5 m below the camera, the ceiling 2.2 m above it.
        let shown = |c: &Corner| c[0] < END_M && c[2] > -0.4 && c[2] < 2.0;
        let cells = self.map.touched().filter(|(_, l)| *l > 0.0);
        let corners: Vec<Corner> = cells
            .map(|(cell, _)| self.map.spec().centre_m(cell).map(|v| v - 0.5 * CELL_M))
            .filter(shown)
            .collect();
        let mut series = cubes(SLANT, corners, CELL_M, NEAR, FAR);
        series.push(Series::new("", ORANGE, Marks::Areas(vec![camera()])));
        Panel {
            title: format!(
                "{}: {} of {} occupied cells hold a surface",
                self.matcher, self.right, self.occupied
            ),
            x: Axis::new("metres to the right, and a third of the metres ahead", -2.0, 3.5),
            y: Axis::new("metres up, and a fifth of those ahead", -0.8, 3.4),
            series,
            legend: None,
        }
    }
}

/// The camera as a small triangle that points ahead.
fn camera() -> Vec<(f64, f64)> {
    let corners = [Point3::new(0.0, 0.2, 0.0), Point3::new(0.0, -0.2, 0.0), Point3::new(0.9, 0.0, 0.0)];
    corners.map(|p| SLANT.place([p.x, p.y, p.z])).to_vec()
}
