//! The true safety maps of the worlds for Murarka and Kuipers 2009, side by side.

use std::io::Cursor;

use anyhow::Result;
use evigrid_grid::SafetyLabel;
use evigrid_grid::safe_ground::SafetyRules;
use evigrid_replay::map_from_world;

use evigrid_synth::{SafetyTruth, World};
use image::{GrayImage, ImageFormat, Luma};

/// Edge of a cell in the picture, pixels.
const CELL: u32 = 2;
const GAP: u32 = 8;

/// A PNG: white level, light grey inclined, black non-ground, dark grey unknown; each robot
/// starts at the bottom and looks up.
pub fn safety_maps() -> Result<Vec<u8>> {
    let maps = World::builtin_names().filter(|name| name.starts_with("safety-")).map(safety_map);
    let maps = maps.collect::<Result<Vec<_>>>()?;
    let width: u32 = maps.iter().map(|map| map.width() + GAP).sum::<u32>().saturating_sub(GAP);
    let height = maps.iter().map(GrayImage::height).max().unwrap_or(0);
    let mut sheet = GrayImage::from_pixel(width, height, Luma([255]));
    let mut left = 0;
    for map in &maps {
        image::imageops::replace(&mut sheet, map, left, 0);
        left += i64::from(map.width() + GAP);
    }
    let mut bytes = Cursor::new(Vec::new());
    sheet.write_to(&mut bytes, ImageFormat::Png)?;
    Ok(bytes.into_inner())
}

fn safety_map(name: &str) -> Result<GrayImage> {
    let world = World::builtin(name)?;
    let map_from_world = map_from_world(&world.true_world_from_left(0));
    let spec = world.truth_grid();
    let truth = SafetyTruth::new(&world, spec, &map_from_world, 0, &SafetyRules::default())?;
    let [nx, ny] = [0, 1].map(|a| spec.shape()[a] as u32);
    Ok(GrayImage::from_fn(ny * CELL, nx * CELL, |x, y| {
        let (i, j) = (nx - 1 - y / CELL, ny - 1 - x / CELL);
        Luma([match truth.labels()[(i * ny + j) as usize] {
            SafetyLabel::Level => 255,
            SafetyLabel::Inclined => 200,
            SafetyLabel::Unknown | SafetyLabel::Unexamined => 128,
            SafetyLabel::NonGround => 0,
        }])
    }))
}
