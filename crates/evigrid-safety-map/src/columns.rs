use evigrid_grid::{Moments, PlanSpec};

/// A column of voxels that has something occupied below the robot's height.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Column {
    /// Layer of the highest such voxel.
    pub height: i32,
    /// The points of its occupied voxels up to there.
    pub moments: Moments,
}

/// The height map of Algorithm 1, step 1: columns within the planning radius.
#[derive(Debug, Clone)]
pub struct Columns {
    spec: PlanSpec,
    list: Vec<Option<Column>>,
    /// Cells within the planning radius, by flat index.
    examined: Vec<u32>,
    is_examined: Vec<bool>,
}

impl Columns {
    /// A height map without any columns.
    pub fn none(spec: PlanSpec) -> Self {
        let cells = spec.cell_count();
        Self { spec, list: vec![None; cells], examined: Vec::new(), is_examined: vec![false; cells] }
    }

    /// Fills in the columns whose centres are at most `radius_m` away from a place in the map frame.
    pub fn fill(
        &mut self,
        spec: PlanSpec,
        at_m: [f64; 2],
        radius_m: f64,
        column: impl Fn(usize) -> Option<Column>,
    ) {
        for &flat in &self.examined {
            (self.list[flat as usize], self.is_examined[flat as usize]) = (None, false);
        }
        self.examined.clear();
        self.spec = spec;
        let ([nx, ny], [x, y]) = (spec.shape(), spec.to_cells(at_m));
        // A cell at the radius itself is examined, whatever the last bit says.
        let radius = radius_m / spec.cell_size_m() + 1e-9;
        let range = |at: f64, n: usize| {
            let (from, to) = ((at - radius - 0.5).ceil().max(0.0), (at + radius - 0.5).floor());
            from as usize..((to + 1.0).max(0.0) as usize).min(n)
        };
        for i in range(x, nx) {
            for j in range(y, ny) {
                let away = [i as f64 + 0.5 - x, j as f64 + 0.5 - y];
                if away[0] * away[0] + away[1] * away[1] > radius * radius {
                    continue;
                }
                let flat = i * ny + j;
                self.examined.push(flat as u32);
                self.is_examined[flat] = true;
                self.list[flat] = column(flat);
            }
        }
    }

    /// The cells.
    pub fn spec(&self) -> &PlanSpec {
        &self.spec
    }

    /// Flat indices of the cells within the planning radius, in order.
    pub fn examined(&self) -> impl Iterator<Item = usize> + '_ {
        self.examined.iter().map(|&flat| flat as usize)
    }

    /// Whether a cell is within the planning radius.
    pub fn is_examined(&self, flat: usize) -> bool {
        self.is_examined[flat]
    }

    /// The column of a cell, if it has one.
    pub fn get(&self, flat: usize) -> Option<&Column> {
        self.list[flat].as_ref()
    }

    /// The height of a cell's column, if it has one.
    pub fn height(&self, flat: usize) -> Option<i32> {
        self.get(flat).map(|column| column.height)
    }
}
