use anyhow::Result;
use evigrid_grid::{Layer, PlanGrid, PlanSpec, SafetyMap};

use crate::map_file::{write_geometry, write_npz};
use crate::npz::NpzWriter;
use crate::{PendingFile, SealedFile, write_map};

/// Writes a layer as npz, in the format of its kind.
///
/// # Errors
/// If the file cannot be written.
pub fn write_layer(file: PendingFile, layer: &Layer<'_>) -> Result<SealedFile> {
    match layer {
        Layer::Voxels(map) => write_map(file, map),
        Layer::Plan(plan) => write_plan(file, plan),
        Layer::Safety(map) => write_safety(file, map),
    }
}

/// Writes a ground plan as npz: `probability` float32 [nx,ny] (NaN = nothing known), `origin` float64 [2] and
/// `cell_size` float64 (metres, in the plan's own frame), `map_from_plan` float64 [3]: x and y in metres and
/// yaw in radians.
///
/// # Errors
/// If the file cannot be written.
pub fn write_plan(file: PendingFile, plan: &PlanGrid) -> Result<SealedFile> {
    let pose = plan.map_from_plan();
    let mut npz = NpzWriter::default();
    npz.array("probability", &shape(plan.spec()), plan.probabilities())?;
    write_geometry(&mut npz, plan.spec())?;
    npz.array("map_from_plan", &[3], &[pose.translation.x, pose.translation.y, pose.rotation.angle()])?;
    write_npz(file, npz)
}

/// Writes a safety map as npz: `labels` uint8 [nx,ny] (numbers of the labels), `plane_of` int32 [nx,ny] (-1 =
/// on no plane), `planes` float64 [P,4] (unit normal and offset in metres of the points p with normal . p =
/// offset, in the map frame), `origin` float64 [2], `cell_size` float64 (metres).
///
/// # Errors
/// If the file cannot be written.
pub fn write_safety(file: PendingFile, map: &SafetyMap) -> Result<SealedFile> {
    let labels: Vec<u8> = map.labels().iter().map(|label| *label as u8).collect();
    let plane_of: Vec<i32> = map.plane_numbers().iter().map(|n| n.map_or(-1, |n| n as i32)).collect();
    let planes: Vec<f64> =
        map.planes().iter().flat_map(|p| [p.normal.x, p.normal.y, p.normal.z, p.offset_m]).collect();
    let mut npz = NpzWriter::default();
    npz.array("labels", &shape(map.spec()), &labels)?;
    npz.array("plane_of", &shape(map.spec()), &plane_of)?;
    npz.array("planes", &[map.planes().len() as u64, 4], &planes)?;
    write_geometry(&mut npz, map.spec())?;
    write_npz(file, npz)
}

fn shape(spec: &PlanSpec) -> [u64; 2] {
    spec.shape().map(|n| n as u64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::npz::{Array, Npz};
    use evigrid_grid::{SafetyLabel, SafetyPlane};
    use nalgebra::{Isometry2, Vector2, Vector3};

    fn spec() -> PlanSpec {
        PlanSpec::of_area([-1.0, 1.0], [0.0, 3.0], 1.0).unwrap()
    }

    /// Writes a layer, and reads these arrays of the file.
    fn arrays<const N: usize>(layer: &Layer<'_>, names: [&str; N]) -> [Array; N] {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("layer.npz");
        write_layer(PendingFile::create(path.clone()).unwrap(), layer).unwrap().publish().unwrap();
        let bytes = std::fs::read(path).unwrap();
        let mut npz = Npz::new(&bytes).unwrap();
        names.map(|name| npz.array(name).unwrap())
    }

    #[test]
    fn a_plan_is_written_with_its_place_in_the_map() {
        let mut plan = PlanGrid::moving(spec(), Isometry2::new(Vector2::new(4.0, -2.0), 0.5));
        plan.probabilities_mut()[1] = 0.25;
        let names = ["probability", "origin", "cell_size", "map_from_plan"];
        let [probability, origin, cell_size, pose] = arrays(&Layer::from(&plan), names);
        assert_eq!((probability.shape, probability.values[1]), (vec![2, 3], 0.25));
        assert!(probability.values[0].is_nan());
        assert_eq!((origin.values, cell_size.values), (vec![-1.0, 0.0], vec![1.0]));
        assert_eq!((&pose.values[..2], (pose.values[2] - 0.5).abs() < 1e-12), (&[4.0, -2.0][..], true));
    }

    #[test]
    fn a_safety_map_is_written_with_its_planes() {
        let mut map = SafetyMap::unknown(spec());
        let ground = map.add_plane(SafetyPlane { normal: Vector3::z(), offset_m: -1.5 });
        map.set(0, SafetyLabel::Level, Some(ground));
        map.set(4, SafetyLabel::NonGround, None);
        let names = ["labels", "plane_of", "planes", "origin"];
        let [labels, plane_of, planes, origin] = arrays(&Layer::from(&map), names);
        assert_eq!((labels.shape, labels.values), (vec![2, 3], vec![0.0, 3.0, 3.0, 3.0, 2.0, 3.0]));
        assert_eq!(plane_of.values, [0.0, -1.0, -1.0, -1.0, -1.0, -1.0]);
        assert_eq!((planes.shape, planes.values), (vec![1, 4], vec![0.0, 0.0, 1.0, -1.5]));
        assert_eq!(origin.values, [-1.0, 0.0]);
        let [planes] = arrays(&Layer::from(&SafetyMap::unknown(spec())), ["planes"]);
        assert_eq!(planes.shape, [0, 4]);
    }
}
