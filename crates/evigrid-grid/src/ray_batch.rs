use crate::RayWalk;

/// `N` ray walks side by side, so that vector code takes their steps together. They visit the cells that the
/// walks would visit one by one.
#[derive(Debug, Clone)]
pub struct RayBatch<const N: usize> {
    flat: [i64; N],
    cells: [u32; N],
    leave_grid: [f64; N],
    next_face: [[f64; N]; 3],
    face_spacing: [[f64; N]; 3],
    stride: [[i64; N]; 3],
}

impl<const N: usize> Default for RayBatch<N> {
    /// Empty places: walks without cells.
    fn default() -> Self {
        Self {
            flat: [0; N],
            cells: [0; N],
            leave_grid: [0.0; N],
            next_face: [[0.0; N]; 3],
            face_spacing: [[0.0; N]; 3],
            stride: [[0; N]; 3],
        }
    }
}

impl<const N: usize> RayBatch<N> {
    /// Puts what is left of a walk into a place.
    ///
    /// # Panics
    /// If there is no such place.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, walk: &RayWalk) {
        self.flat[lane] = walk.flat() as i64;
        self.cells[lane] = walk.len() as u32;
        self.leave_grid[lane] = walk.end();
        for (a, axis) in walk.axes().iter().enumerate() {
            self.next_face[a][lane] = axis.next_face;
            self.face_spacing[a][lane] = axis.face_spacing;
            self.stride[a][lane] = axis.stride as i64;
        }
    }

    /// How many cells each walk visits, from where it was put in.
    pub fn cells(&self) -> &[u32; N] {
        &self.cells
    }

    /// Flat indices of the next cell of each walk, and the parameters at which it is left
    /// ([`RayWalk::leave`]); then all go on to the next. The numbers of a walk that has visited its last cell
    /// mean nothing.
    #[inline(always)]
    pub fn step(&mut self) -> ([i64; N], [f64; N]) {
        let flat = self.flat;
        let mut leave = [0.0; N];
        let ([next_x, next_y, next_z], [space_x, space_y, space_z]) =
            (&mut self.next_face, &self.face_spacing);
        let [stride_x, stride_y, stride_z] = &self.stride;
        for l in 0..N {
            let (x, y, z) = (next_x[l], next_y[l], next_z[l]);
            let xy = if x < y { x } else { y };
            let next = if xy < z { xy } else { z };
            leave[l] = if next < self.leave_grid[l] { next } else { self.leave_grid[l] };
            // The nearest face; ties go to the first axis. Masks, since a branch here would keep this scalar.
            let is_x = mask((x <= y) & (x <= z));
            let is_y = mask(y <= z) & !is_x;
            let is_z = !(is_x | is_y);
            next_x[l] = x + f64::from_bits(space_x[l].to_bits() & is_x);
            next_y[l] = y + f64::from_bits(space_y[l].to_bits() & is_y);
            next_z[l] = z + f64::from_bits(space_z[l].to_bits() & is_z);
            let stride =
                (stride_x[l] & is_x as i64) | (stride_y[l] & is_y as i64) | (stride_z[l] & is_z as i64);
            self.flat[l] = self.flat[l].wrapping_add(stride);
        }
        (flat, leave)
    }
}

/// All bits where a condition holds, none elsewhere.
#[inline(always)]
fn mask(condition: bool) -> u64 {
    u64::from(condition).wrapping_neg()
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::{GridSettings, GridSpec};
    use proptest::prelude::*;

    fn anywhere() -> impl Strategy<Value = [f64; 3]> {
        [-4.0..12.0, -4.0..10.0, -4.0..8.0]
    }

    proptest! {
        #[test]
        fn a_batch_steps_as_its_walks_do(ends in prop::array::uniform4((anywhere(), anywhere()))) {
            let settings =
                GridSettings { x_m: [0.0, 8.0], y_m: [0.0, 6.0], z_m: [0.0, 4.0], cell_size_m: 1.0 };
            let spec = GridSpec::new(&settings).unwrap();
            let mut walks = ends.map(|(from, to)| RayWalk::in_cells(&spec, from, to));
            let mut batch = RayBatch::<4>::default();
            (0..4).for_each(|lane| batch.set(lane, &walks[lane]));
            prop_assert_eq!(batch.cells().map(|n| n as usize), walks.clone().map(|w| w.len()));
            for step in 0..*batch.cells().iter().max().unwrap() {
                let visiting: Vec<_> = (0..4).filter(|&lane| step < batch.cells()[lane]).collect();
                let (flat, leave) = batch.step();
                for lane in visiting {
                    prop_assert_eq!(leave[lane], walks[lane].leave());
                    prop_assert_eq!(Some(flat[lane] as usize), walks[lane].next().map(|w| w.0));
                }
            }
        }
    }
}
