use evigrid_grid::{LogOddsGrid, Moments, SafetyMap};

use crate::columns::{Column, Columns};
use crate::labels::label_columns;
use crate::model::{floor_layer, layer_at, layers_below};
use crate::robot::Robot;
use crate::settings::SafetyMapSettings;

/// The safety map of a map of voxels, so that the maps of other methods can be labelled too. A voxel is
/// occupied if its log-odds are above 0; its centre stands for the points in it.
pub fn label_voxels(map: &LogOddsGrid, robot: &Robot, settings: &SafetyMapSettings) -> SafetyMap {
    let spec = map.spec();
    let layers = layers_below(spec, robot.floor_m + settings.robot_height_m);
    let mut columns = Columns::none(spec.plan());
    columns.fill(spec.plan(), robot.at_m, settings.radius_m, |column| {
        let base = column * spec.shape()[2];
        let is_occupied = |w: usize| map.values()[base + w] > 0.0;
        let height = (0..layers).rev().find(|&w| is_occupied(w))?;
        let mut moments = Moments::default();
        (0..=height).filter(|&w| is_occupied(w)).for_each(|w| moments.add(spec.centre_m(base + w)));
        Some(Column { height: height as i32, moments })
    });
    let is_free = |column: usize, height_m: f64| {
        layer_at(spec, height_m).is_some_and(|w| map.values()[column * spec.shape()[2] + w] < 0.0)
    };
    label_columns(&columns, robot, floor_layer(spec, robot.floor_m), settings, &is_free)
}
