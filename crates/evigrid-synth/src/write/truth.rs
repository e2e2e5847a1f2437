//! The exact truth of all frames together.

use std::io;
use std::ops::Range;
use std::path::Path;

use evigrid_core::Pose;
use evigrid_grid::safe_ground::SafetyRules;
use evigrid_grid::{GridSpec, SafetyLabel, SafetyMap};
use evigrid_results::npz::NpzWriter;

use super::error::WriteError;
use super::files::{write_file, write_grey_png};
use super::tables::{self, HAZARDS_HEADING, OBJECTS_HEADING, PLANES_HEADING};
use crate::World;
use crate::exact::{
    SafetyTruth, TerrainTruth, VoxelTruth, ground_planes, hazards, hazards_or_nothing, tracks,
};

/// The labels from dark to light in safety_map.png.
const LABELS: [SafetyLabel; 4] =
    [SafetyLabel::NonGround, SafetyLabel::Unknown, SafetyLabel::Inclined, SafetyLabel::Level];

/// Writes the exact truth that does not belong to a single frame.
pub fn write_truth(
    world: &World,
    frames: &Range<usize>,
    map_from_world: &Pose,
    dir: &Path,
) -> Result<(), WriteError> {
    let dir = dir.join("ground_truth");
    // First what may be impossible.
    if world.robot.is_some() {
        write_ground(world, frames.start, map_from_world, &dir)?;
        write_safety(world, frames.start, map_from_world, &dir)?;
    }
    write_voxels(world, frames, map_from_world, &dir)?;
    let planes = tables::planes(&ground_planes(world, map_from_world));
    write_file("planes", &dir.join("planes.csv"), [PLANES_HEADING, &planes].concat().as_bytes())?;
    let rows = |(number, frame)| tables::objects(number, &tracks(world, map_from_world, frame));
    let objects: String = frames.clone().enumerate().map(rows).collect();
    write_file("objects", &dir.join("objects.csv"), [OBJECTS_HEADING, &objects].concat().as_bytes())
}

fn write_voxels(
    world: &World,
    frames: &Range<usize>,
    map_from_world: &Pose,
    dir: &Path,
) -> Result<(), WriteError> {
    let frames: Vec<usize> = frames.clone().collect();
    let truth = VoxelTruth::new(world, world.truth_grid, map_from_world, &frames);
    write_npz("voxels", &dir.join("voxels.npz"), truth.spec(), |npz| {
        for (name, voxels) in [("occupied", truth.occupied()), ("hidden", truth.hidden())] {
            npz.array(name, &[voxels.len() as u64, 3], voxels.as_flattened())?;
        }
        Ok(())
    })
}

fn write_ground(
    world: &World,
    first_frame: usize,
    map_from_world: &Pose,
    dir: &Path,
) -> Result<(), WriteError> {
    let truth = TerrainTruth::new(world, world.truth_grid, map_from_world, first_frame)?;
    let [nx, ny, _] = truth.spec().shape().map(|n| n as u64);
    write_npz("ground", &dir.join("ground.npz"), truth.spec(), |npz| {
        npz.array("height", &[nx, ny], &truth.heights_m())?;
        npz.array("slope", &[nx, ny], &truth.slopes_deg())
    })
}

/// An npz of arrays that lie on a grid.
fn write_npz(
    what: &'static str,
    path: &Path,
    spec: &GridSpec,
    fill: impl FnOnce(&mut NpzWriter) -> io::Result<()>,
) -> Result<(), WriteError> {
    let bytes = || {
        let mut npz = NpzWriter::default();
        fill(&mut npz)?;
        npz.array("origin", &[3], &spec.origin_m())?;
        npz.array("cell_size", &[], &[spec.cell_size_m()])?;
        npz.finish()
    };
    let failed = |source| WriteError::Io { what, path: path.to_owned(), source };
    write_file(what, path, &bytes().map_err(failed)?)
}

fn write_safety(
    world: &World,
    first_frame: usize,
    map_from_world: &Pose,
    dir: &Path,
) -> Result<(), WriteError> {
    let settings = SafetyRules::default();
    let truth = SafetyTruth::new(world, world.truth_grid, map_from_world, first_frame, &settings)?;
    let [nx, ny, _] = truth.spec().shape();
    // Seen from above, forward up: the last row of cells comes first, and in it the leftmost cell.
    let pixels: Vec<u8> = truth.labels().iter().rev().map(|label| grey(*label)).collect();
    write_grey_png("safety map", &dir.join("safety_map.png"), ny, nx, &pixels)?;
    write_file("safety map", &dir.join("safety_map.toml"), safety_table(truth.spec()).as_bytes())?;
    write_hazards(world, first_frame, map_from_world, &truth.map(), dir)
}

fn write_hazards(
    world: &World,
    first_frame: usize,
    map_from_world: &Pose,
    truth: &SafetyMap,
    dir: &Path,
) -> Result<(), WriteError> {
    // The grid begins where the robot does: a drive that starts later may have left a hazard behind.
    let hazards = match first_frame {
        0 => hazards(world, map_from_world, truth)?,
        _ => hazards_or_nothing(world, map_from_world, truth),
    };
    let rows = tables::hazards(&hazards, truth.spec());
    write_file("hazards", &dir.join("hazards.csv"), [HAZARDS_HEADING, &rows].concat().as_bytes())
}

/// Grey level of a label in safety_map.png.
fn grey(label: SafetyLabel) -> u8 {
    match label {
        SafetyLabel::NonGround => 0,
        SafetyLabel::Unknown | SafetyLabel::Unexamined => 128,
        SafetyLabel::Inclined => 200,
        SafetyLabel::Level => 255,
    }
}

fn safety_table(spec: &GridSpec) -> String {
    let ([x, y, _], [nx, ny, _]) = (spec.origin_m(), spec.shape());
    let labels: String =
        LABELS.iter().map(|&label| format!("{} = {}\n", label.name(), grey(label))).collect();
    format!(
        "# safety_map.png: one pixel for each cell of the ground plan, seen from above, x of the map frame \
         up, y to\n\
         # the left. The pixel in row r and column c is the cell (i, j) = ({last_i} - r, {last_j} - c), \
         which covers\n\
         # origin_m + [i, i+1) x [j, j+1) cells.\n\
         origin_m = [{x:?}, {y:?}]\n\
         cell_size_m = {:?}\n\
         cells = [{nx}, {ny}]\n\n\
         # Grey levels of the labels.\n\
         [labels]\n\
         {labels}",
        spec.cell_size_m(),
        last_i = nx - 1,
        last_j = ny - 1,
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::GridSettings;

    #[test]
    fn the_table_of_the_safety_map_is_toml() {
        let settings = GridSettings { x_m: [-1.0, 2.0], y_m: [-0.5, 0.5], ..GridSettings::default() };
        let text = safety_table(&GridSpec::new(&settings).unwrap());
        let table: toml::Table = text.parse().unwrap();
        assert_eq!(table["origin_m"].as_array().unwrap()[0].as_float(), Some(-1.0));
        assert_eq!(table["cell_size_m"].as_float(), Some(0.2));
        assert_eq!(table["cells"].as_array().unwrap()[1].as_integer(), Some(5));
        assert_eq!(table["labels"]["inclined"].as_integer(), Some(i64::from(grey(SafetyLabel::Inclined))));
    }
}
