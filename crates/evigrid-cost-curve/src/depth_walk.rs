//! The cells of a ray by depth, inside the grid and outside.

use evigrid_grid::ViewRays;

/// A walk over the cells of a ray from the camera on, without end (Amanatides and Woo 1987).
pub(crate) struct DepthWalk {
    /// Indices of the cell that the walk is in.
    pub cell: [i64; 3],
    /// Depth at which the ray enters that cell, metres.
    pub enter_m: f64,
    next_face_m: [f64; 3],
    spacing_m: [f64; 3],
    forward: [i64; 3],
}

impl DepthWalk {
    /// The walk of a ray with a direction in cells per metre of depth; it begins in the camera's cell.
    pub fn new(rays: &ViewRays<'_>, direction: [f64; 3]) -> Self {
        let forward = direction.map(|d| if d > 0.0 { 1 } else { -1 });
        let face = |a: usize| (rays.origin_cell[a] + i64::from(forward[a] > 0)) as f64;
        Self {
            cell: rays.origin_cell,
            enter_m: 0.0,
            next_face_m: std::array::from_fn(|a| {
                if direction[a] == 0.0 { f64::INFINITY } else { (face(a) - rays.origin[a]) / direction[a] }
            }),
            spacing_m: direction.map(|d| d.recip().abs()),
            forward,
        }
    }

    /// The axis of the face that is crossed next; of several, the first.
    fn next_axis(&self) -> usize {
        let [x, y, z] = self.next_face_m;
        if x <= y && x <= z {
            0
        } else if y <= z {
            1
        } else {
            2
        }
    }

    /// Depth at which the ray leaves the cell that the walk is in, metres.
    pub fn leave_m(&self) -> f64 {
        self.next_face_m[self.next_axis()]
    }

    /// Goes on to the next cell.
    pub fn step(&mut self) {
        let a = self.next_axis();
        self.enter_m = self.next_face_m[a];
        self.next_face_m[a] += self.spacing_m[a];
        self.cell[a] += self.forward[a];
    }
}
