//! Safety labels from files: npz of a run, or the picture that a written world has.

use std::path::Path;

use anyhow::{Context, Result, bail};
use evigrid_grid::{PlanSpec, SafetyLabel, SafetyMap, SafetyPlane};
use nalgebra::Vector3;
use serde::Deserialize;

use crate::npz::{Array, Npz};

/// Reads safety labels: npz in the format of [`crate::write_safety`] (`plane_of` and `planes` may be left out), or
/// a grey PNG with a TOML file of the same name beside it, as `evigrid synth` writes them.
///
/// # Errors
/// If a file cannot be read, lacks something, or holds a number that stands for no label.
pub fn read_labels(path: &Path) -> Result<SafetyMap> {
    let is_picture = path.extension().is_some_and(|ending| ending.eq_ignore_ascii_case("png"));
    let read = if is_picture { read_picture(path) } else { read_npz(path) };
    read.with_context(|| format!("labels {}", path.display()))
}

/// Whether a file is an npz of safety labels.
pub fn is_label_file(path: &Path) -> bool {
    let bytes = std::fs::read(path).unwrap_or_default();
    Npz::new(&bytes).is_ok_and(|mut npz| npz.array("labels").is_ok())
}

/// `Ok` if two safety maps have the same cells.
///
/// # Errors
/// If not: both grids are named, with what they are of.
pub fn check_same_cells(found: (&SafetyMap, &Path), truth: (&SafetyMap, &Path)) -> Result<()> {
    let [a, b] = [found.0.spec(), truth.0.spec()];
    let c = b.cell_size_m();
    let near = |x: f64, y: f64, limit: f64| (x - y).abs() <= limit;
    let same_origin = (0..2).all(|n| near(a.origin_m()[n], b.origin_m()[n], 1e-3 * c));
    if near(a.cell_size_m(), c, 1e-6 * c) && a.shape() == b.shape() && same_origin {
        return Ok(());
    }
    bail!(
        "expected a map on the cells of the truth, {} ({}), found {} ({})",
        cells(b),
        truth.1.display(),
        cells(a),
        found.1.display()
    );
}

fn cells(spec: &PlanSpec) -> String {
    let ([nx, ny], [x, y]) = (spec.shape(), spec.origin_m());
    format!("{nx} x {ny} cells of {} m from [{x}, {y}]", spec.cell_size_m())
}

fn read_npz(path: &Path) -> Result<SafetyMap> {
    let bytes = std::fs::read(path)?;
    let mut npz = Npz::new(&bytes)?;
    let (labels, origin, cell_size) = (npz.array("labels")?, npz.array("origin")?, npz.array("cell_size")?);
    let &[nx, ny] = &labels.shape[..] else {
        bail!("labels: expected shape [nx, ny], found {:?}", labels.shape);
    };
    let (&[x, y], &[c]) = (&origin.values[..], &cell_size.values[..]) else {
        bail!(
            "expected origin of shape [2] and one cell_size, found {:?} and {:?}",
            origin.shape,
            cell_size.shape
        );
    };
    let mut map = SafetyMap::unknown(spec([x, y], [nx as usize, ny as usize], c)?);
    let planes = planes(&mut npz, &mut map, labels.values.len())?;
    for (flat, &value) in labels.values.iter().enumerate() {
        let label = SafetyLabel::ALL.into_iter().find(|label| f64::from(*label as u8) == value);
        let Some(label) = label else {
            bail!(
                "labels: expected numbers from 0 to {}, found {value} at position {flat}",
                SafetyLabel::ALL.len() - 1
            );
        };
        map.set(flat, label, planes[flat]);
    }
    Ok(map)
}

/// Adds the planes of a file to a map; the plane of each cell.
fn planes(npz: &mut Npz<'_>, map: &mut SafetyMap, cells: usize) -> Result<Vec<Option<u32>>> {
    let (Ok(planes), Ok(plane_of)) = (npz.array("planes"), npz.array("plane_of")) else {
        return Ok(vec![None; cells]);
    };
    let Array { shape, values, .. } = planes;
    if shape.get(1) != Some(&4) || plane_of.values.len() != cells {
        bail!(
            "expected planes of shape [P, 4] and a plane_of per cell, found {shape:?} and {:?}",
            plane_of.shape
        );
    }
    for plane in values.chunks_exact(4) {
        map.add_plane(SafetyPlane { normal: Vector3::new(plane[0], plane[1], plane[2]), offset_m: plane[3] });
    }
    let count = values.len() / 4;
    let number = |&value: &f64| match value {
        -1.0 => Ok(None),
        v if v >= 0.0 && v < count as f64 && v.fract() == 0.0 => Ok(Some(v as u32)),
        v => bail!("plane_of: expected -1, or the number of one of {count} planes, found {v}"),
    };
    plane_of.values.iter().map(number).collect()
}

/// The file beside a picture of labels.
#[derive(Deserialize)]
struct PictureTable {
    origin_m: [f64; 2],
    cell_size_m: f64,
    cells: [usize; 2],
    labels: GreyLevels,
}

/// The grey level of each label. Unknown and unexamined share one: a truth has looked everywhere.
#[derive(Deserialize)]
struct GreyLevels {
    level: u8,
    inclined: u8,
    non_ground: u8,
    unknown: u8,
}

impl GreyLevels {
    fn label(&self, grey: u8) -> Option<SafetyLabel> {
        let levels = [
            (self.level, SafetyLabel::Level),
            (self.inclined, SafetyLabel::Inclined),
            (self.non_ground, SafetyLabel::NonGround),
            (self.unknown, SafetyLabel::Unknown),
        ];
        levels.into_iter().find(|(level, _)| *level == grey).map(|(_, label)| label)
    }
}

fn read_picture(path: &Path) -> Result<SafetyMap> {
    let beside = path.with_extension("toml");
    let at_beside = || beside.display().to_string();
    let text = std::fs::read_to_string(&beside).with_context(at_beside)?;
    let table: PictureTable = toml::from_str(&text).with_context(at_beside)?;
    let picture = image::open(path)?;
    let image::DynamicImage::ImageLuma8(picture) = picture else {
        bail!("expected a grey picture of 8 bits, found {:?}", picture.color());
    };
    let [nx, ny] = table.cells;
    if (picture.width() as usize, picture.height() as usize) != (ny, nx) {
        let (width, height) = picture.dimensions();
        bail!("expected {ny} x {nx} pixels ({}), found {width} x {height}", at_beside());
    }
    let mut map = SafetyMap::unknown(spec(table.origin_m, table.cells, table.cell_size_m)?);
    // Seen from above, forward up: the first pixel is the last cell.
    for (flat, pixel) in picture.pixels().rev().enumerate() {
        let grey = pixel.0[0];
        let Some(label) = table.labels.label(grey) else {
            let (row, column) = (nx - 1 - flat / ny, ny - 1 - flat % ny);
            bail!(
                "expected the grey level of a label ({}), found {grey} in row {row}, column {column}",
                at_beside()
            );
        };
        map.set(flat, label, None);
    }
    Ok(map)
}

fn spec(origin_m: [f64; 2], shape: [usize; 2], cell_size_m: f64) -> Result<PlanSpec> {
    let possible = cell_size_m.is_finite() && cell_size_m > 0.0 && origin_m.iter().all(|v| v.is_finite());
    if !possible || shape.contains(&0) {
        bail!(
            "expected a finite origin, a positive cell size and cells, found {origin_m:?}, {cell_size_m} and {shape:?}"
        );
    }
    let to = |a: usize| origin_m[a] + shape[a] as f64 * cell_size_m;
    Ok(PlanSpec::of_area([origin_m[0], to(0)], [origin_m[1], to(1)], cell_size_m)?)
}

#[cfg(test)]
#[path = "label_file_tests.rs"]
mod tests;
