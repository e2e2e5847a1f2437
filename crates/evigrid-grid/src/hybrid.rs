//! The 3-D model behind a safety map (Murarka and Kuipers 2009, section VI): planes where the ground is safe,
//! voxels elsewhere.

use crate::{GridSpec, SafetyLabel, SafetyMap, SafetyPlane};

/// The part of the model that is voxels; the planes stand in the safety map.
#[derive(Debug, Clone, PartialEq)]
pub struct HybridModel {
    /// The voxels, in the map frame. Its ground plan is that of the safety map.
    pub spec: GridSpec,
    /// Flat indices of the occupied voxels that are no safe ground, ascending. In columns labelled safe these are
    /// the voxels above the ground; columns that nobody has examined have none.
    pub voxels: Vec<u32>,
    /// The floor under the middle of the robot in the map frame, metres.
    pub robot_m: [f64; 3],
    /// Height of the robot over its floor, metres.
    pub robot_height_m: f64,
}

/// A piece of safe ground: a flat quadrangle over one cell of the plan, or over neighbours in a row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Patch {
    /// The label of all its cells.
    pub label: SafetyLabel,
    /// Corners in the map frame, metres, counter-clockwise as seen from above.
    pub corners_m: [[f64; 3]; 4],
}

/// The safe cells that lie on a plane, each as a patch, by rising flat index.
pub fn patches(map: &SafetyMap) -> Vec<Patch> {
    runs(map, |_| 1)
}

/// The same ground in fewer patches: cells of one row along y that share label and plane are one patch.
pub fn merged_patches(map: &SafetyMap) -> Vec<Patch> {
    let (ny, labels, planes) = (map.spec().shape()[1], map.labels(), map.plane_numbers());
    runs(map, |first| {
        let row_end = (first / ny + 1) * ny;
        let same = |&cell: &usize| (labels[cell], planes[cell]) == (labels[first], planes[first]);
        (first..row_end).take_while(same).count()
    })
}

/// Patches of neighbours along y; `length` tells how many cells the patch holds that begins at a cell.
fn runs(map: &SafetyMap, length: impl Fn(usize) -> usize) -> Vec<Patch> {
    let (mut patches, mut cell) = (Vec::new(), 0);
    while cell < map.labels().len() {
        let cells = length(cell);
        patches.extend(patch(map, cell, cells));
        cell += cells;
    }
    patches
}

/// The patch over so many cells along y; `None` where the first is not safe, lies on no plane or on a plane that
/// stands upright.
fn patch(map: &SafetyMap, first: usize, cells: usize) -> Option<Patch> {
    let label = map.labels()[first];
    let plane = map.plane_of(first).filter(|_| label.is_safe() == Some(true))?;
    let ([i, j], [x0, y0], c) = (map.spec().cell(first), map.spec().origin_m(), map.spec().cell_size_m());
    let corner = |a: usize, b: usize| {
        let at_m = [x0 + (i + a) as f64 * c, y0 + (j + b) as f64 * c];
        Some([at_m[0], at_m[1], plane.height_m(at_m)?])
    };
    Some(Patch { label, corners_m: [corner(0, 0)?, corner(1, 0)?, corner(1, cells)?, corner(0, cells)?] })
}

impl SafetyPlane {
    /// Height of the plane over a place of the map frame, metres; `None` if it stands upright.
    pub fn height_m(&self, [x, y]: [f64; 2]) -> Option<f64> {
        let z = (self.offset_m - self.normal.x * x - self.normal.y * y) / self.normal.z;
        z.is_finite().then_some(z)
    }
}

/// The faces of voxels that can be seen: those without another voxel of the list on the other side. Each has four
/// corners in the map frame, metres, counter-clockwise as seen from outside, and the number of its voxel in the
/// list. `voxels` are flat indices, ascending.
pub fn outer_faces(spec: &GridSpec, voxels: &[u32]) -> Vec<(usize, [[f64; 3]; 4])> {
    let mut faces = Vec::new();
    for (number, &flat) in voxels.iter().enumerate() {
        let voxel = spec.voxel(flat as usize);
        for (axis, side) in [0, 1, 2].into_iter().flat_map(|axis| [(axis, 0), (axis, 1)]) {
            let mut beside = voxel.map(|v| v as i64);
            beside[axis] += if side == 1 { 1 } else { -1 };
            let beside = spec.flat(beside).and_then(|flat| u32::try_from(flat).ok());
            if beside.is_none_or(|flat| voxels.binary_search(&flat).is_err()) {
                faces.push((number, face(spec, voxel, axis, side)));
            }
        }
    }
    faces
}

/// The corners of a voxel's face across an axis, on its lower (0) or upper (1) side.
fn face(spec: &GridSpec, voxel: [usize; 3], axis: usize, side: usize) -> [[f64; 3]; 4] {
    let (origin, c) = (spec.origin_m(), spec.cell_size_m());
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut around = [[0, 0], [1, 0], [1, 1], [0, 1]];
    if side == 0 {
        around.reverse();
    }
    around.map(|[along_u, along_v]| {
        let mut corner = voxel;
        (corner[axis], corner[u], corner[v]) = (voxel[axis] + side, voxel[u] + along_u, voxel[v] + along_v);
        [0, 1, 2].map(|a| origin[a] + corner[a] as f64 * c)
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{GridSettings, PlanSpec};
    use nalgebra::Vector3;

    fn plane(rise: [f64; 2], height: f64) -> SafetyPlane {
        let normal = Vector3::new(-rise[0], -rise[1], 1.0);
        SafetyPlane { normal: normal.normalize(), offset_m: height / normal.norm() }
    }

    /// Two cells forward from x = 5, three to the left from y = -3, on a ramp z = 0.1 x + 0.2 y - 1, but for an
    /// unsafe cell in the middle of the first row and a level one at the end of the second.
    fn map() -> SafetyMap {
        let mut map = SafetyMap::unknown(PlanSpec::of_area([5.0, 6.0], [-3.0, -1.5], 0.5).unwrap());
        let ramp = map.add_plane(plane([0.1, 0.2], -1.0));
        let floor = map.add_plane(plane([0.0, 0.0], 0.25));
        (0..5).for_each(|cell| map.set(cell, SafetyLabel::Inclined, Some(ramp)));
        map.set(1, SafetyLabel::NonGround, Some(ramp));
        map.set(5, SafetyLabel::Level, Some(floor));
        map
    }

    #[test]
    fn corners_lie_on_the_plane_over_the_corners_of_the_cell() {
        let patches = patches(&map());
        let labels: Vec<_> = patches.iter().map(|p| p.label).collect();
        use SafetyLabel::{Inclined, Level};
        assert_eq!(labels, [Inclined, Inclined, Inclined, Inclined, Level]);
        // Cell (0, 2) covers x from 5 to 5.5 and y from -2 to -1.5.
        let places = [[5.0, -2.0], [5.5, -2.0], [5.5, -1.5], [5.0, -1.5]];
        for (corner, [x, y]) in patches[1].corners_m.iter().zip(places) {
            let expected = [x, y, 0.1 * x + 0.2 * y - 1.0];
            assert!((0..3).all(|a| (corner[a] - expected[a]).abs() < 1e-12), "{corner:?} {expected:?}");
        }
        assert!(patches[4].corners_m.iter().all(|c| (c[2] - 0.25).abs() < 1e-12));
    }

    #[test]
    fn merged_patches_cover_the_same_ground() {
        let (single, merged) = (patches(&map()), merged_patches(&map()));
        assert_eq!(merged.len(), 4, "a cell, a gap, a cell; two cells and one of another plane");
        assert_eq!(merged[2].corners_m[..2], single[2].corners_m[..2]);
        assert_eq!(merged[2].corners_m[2..], single[3].corners_m[2..]);
        assert_eq!([merged[0], merged[1], merged[3]], [single[0], single[1], single[4]]);
    }

    #[test]
    fn cells_without_a_plane_or_on_an_upright_one_have_no_patch() {
        let mut map = SafetyMap::of(*map().spec(), SafetyLabel::Level);
        let upright = map.add_plane(SafetyPlane { normal: Vector3::x(), offset_m: 1.0 });
        map.set(0, SafetyLabel::Level, Some(upright));
        assert!(patches(&map).is_empty() && merged_patches(&map).is_empty());
    }

    fn spec() -> GridSpec {
        let settings = GridSettings { x_m: [1.0, 3.0], y_m: [-1.0, 0.5], z_m: [0.0, 1.0], cell_size_m: 0.5 };
        GridSpec::new(&settings).unwrap()
    }

    #[test]
    fn faces_between_two_voxels_are_left_out() {
        let at = |voxel| spec().flat(voxel).unwrap() as u32;
        let faces = |voxels: &[u32]| outer_faces(&spec(), voxels).iter().map(|f| f.0).collect::<Vec<_>>();
        assert_eq!(faces(&[at([1, 1, 0])]), [0; 6]);
        assert_eq!(faces(&[at([1, 1, 0]), at([1, 1, 1])]), [0, 0, 0, 0, 0, 1, 1, 1, 1, 1]);
        // The last voxel of a column and the first of the next follow each other, but do not touch.
        assert_eq!(faces(&[at([1, 1, 1]), at([1, 2, 0])]).len(), 12);
        assert!(faces(&[]).is_empty());
    }

    /// Corners lie on the voxel, and their order turns around the direction from its middle to the face.
    #[test]
    fn faces_look_outwards() {
        let voxel = [2, 1, 1];
        let flat = spec().flat(voxel).unwrap();
        let middle = Vector3::from(spec().centre_m(flat));
        let mut middles = Vec::new();
        for (_, corners) in outer_faces(&spec(), &[flat as u32]) {
            let [a, b, c, d] = corners.map(Vector3::from);
            let out = (a + b + c + d) / 4.0 - middle;
            assert!(((b - a).cross(&(c - b)).normalize() - out / 0.25).norm() < 1e-12, "{corners:?}");
            assert!([a, b, c, d].iter().all(|p| ((p - middle).abs() - Vector3::repeat(0.25)).norm() < 1e-12));
            middles.push(out.map(|v| (v * 4.0).round() as i32));
        }
        let expected = [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, 1, 0], [0, 0, -1], [0, 0, 1]];
        assert_eq!(middles, expected.map(Vector3::from));
    }
}
