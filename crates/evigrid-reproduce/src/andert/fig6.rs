//! Fig. 6: the test picture, what stands there, and the maps of all algorithms in all cell sizes.

use anyhow::Result;
use evigrid_core::Matching;
use evigrid_grid::LogOddsGrid;
use evigrid_synth::{Track, VoxelState, VoxelTruth};

use super::algorithms::{ALL, Algorithm};
use super::objects::{is_found, objects, outline};
use super::plan::{PANEL, Plan, SHOWN_M, plan_panel};
use super::scene::{CELLS_M, Scene, WORLD, grid};
use crate::chart::{BLUE, Marks, ORANGE, Panel, Series, Sheet};
use crate::image_view::{disparity_panel, grey_panel};
use crate::job::Job;
use crate::table::rounded;

/// Log-odds above which a cell of one image is occupied (section VIII).
const OCCUPIED: f32 = 0.1;

/// One map with what it is worth.
struct ImageMap {
    algorithm: Algorithm,
    cell_size_m: f64,
    plan: Plan,
    found: Vec<String>,
    missed: Vec<String>,
    /// Cells over the limit, those of them that hold a surface, and cells that are free.
    occupied: usize,
    right: usize,
    free: usize,
    touched: usize,
}

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let scene = Scene::new()?;
    let objects = objects(&scene);
    let mut maps = Vec::new();
    for cell_size_m in CELLS_M {
        job.say(&format!("cells of {cell_size_m} m"));
        let truth = VoxelTruth::new(&scene.world, grid(cell_size_m)?, &scene.map_from_world, &[0]);
        for algorithm in ALL {
            let (map, _) = algorithm.mapper(grid(cell_size_m)?)?.single_image(&scene.view(&scene.exact));
            maps.push(ImageMap::new(algorithm, &map, &objects, &truth));
        }
    }
    let header = [
        "cell_size_m",
        "algorithm",
        "objects",
        "objects_found",
        "objects_missed",
        "touched_cells",
        "free_cells",
        "occupied_cells",
        "of_these_on_a_surface",
        "precision",
        "occupied_columns_above_0.8_m",
        "paper",
    ];
    job.write_table(&header, maps.iter().map(ImageMap::row))?;
    job.write_picture(&picture(&scene, &objects, &maps))
}

impl ImageMap {
    fn new(algorithm: Algorithm, map: &LogOddsGrid, objects: &[Track], truth: &VoxelTruth) -> Self {
        let occupied = || map.touched().filter(|(_, l)| *l > OCCUPIED);
        let (found, missed): (Vec<&Track>, Vec<&Track>) =
            objects.iter().partition(|object| is_found(object, map, OCCUPIED));
        let names = |objects: Vec<&Track>| objects.into_iter().map(|o| o.name.clone()).collect();
        Self {
            algorithm,
            cell_size_m: map.spec().cell_size_m(),
            plan: Plan::new(map, SHOWN_M),
            found: names(found),
            missed: names(missed),
            occupied: occupied().count(),
            right: occupied().filter(|(cell, _)| truth.state(*cell) == VoxelState::Occupied).count(),
            free: map.touched().filter(|(_, l)| *l < 0.0).count(),
            touched: map.touched().count(),
        }
    }

    fn row(&self) -> [String; 12] {
        [
            self.cell_size_m.to_string(),
            self.algorithm.name().to_owned(),
            (self.found.len() + self.missed.len()).to_string(),
            self.found.len().to_string(),
            self.missed.join(" "),
            self.touched.to_string(),
            self.free.to_string(),
            self.occupied.to_string(),
            self.right.to_string(),
            rounded(self.right as f64 / self.occupied as f64, 4),
            self.plan.columns().filter(|[_, _, l]| *l > f64::from(OCCUPIED)).count().to_string(),
            if self.algorithm.draws_lines() { "all objects found" } else { "all found, drawn larger" }
                .to_owned(),
        ]
    }

    fn panel(&self) -> Panel {
        let all = self.found.len() + self.missed.len();
        let (name, c) = (self.algorithm.name(), self.cell_size_m);
        self.plan.panel(format!("{name}, cells of {c} m: {} of {all} objects", self.found.len()))
    }
}

fn picture(scene: &Scene, objects: &[Track], maps: &[ImageMap]) -> Sheet {
    let size = [scene.frame.rig().width, scene.frame.rig().height];
    let most_px = scene.frame.rig().disparity_px(6.0);
    let shown = |title: &str, matching: &Matching| {
        disparity_panel(title, size, most_px, matching.matches.disparity.values())
    };
    let left = scene.frame.left();
    let areas = Marks::Areas(objects.iter().map(outline).collect());
    let camera = Series::new("", ORANGE, Marks::Dots(vec![(0.2, 0.0)], 5));
    let mut panels = vec![
        grey_panel("the left image", size, |x, y| left.row(y)[x]),
        shown("true disparities to 25 m, which are drawn below", &scene.exact),
        shown("block matching, before filters", &scene.matched),
        plan_panel("what stands there", vec![Series::new("", BLUE, areas), camera]),
    ];
    panels.extend(maps.iter().map(ImageMap::panel));
    Sheet {
        title: format!("Fig. 6: one image of the world {WORLD} drawn by four algorithms in three cell sizes"),
        notes: vec![
            "from above; black: occupied, white: free, blue: not seen; orange: the camera, looking right"
                .into(),
            "the paper: all objects are found by all algorithms; lines alias, rays draw objects larger"
                .into(),
        ],
        columns: ALL.len(),
        panel: PANEL,
        panels,
    }
}
