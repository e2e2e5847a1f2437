//! Segments of ground (Algorithm 1).

use evigrid_grid::{Moments, Plane};

use crate::columns::Columns;
use crate::robot::Robot;
use crate::settings::SafetyMapSettings;

/// A segment: neighbouring columns of one height.
#[derive(Debug, Clone, PartialEq)]
pub struct Segment {
    /// Its cells by flat index, in the order in which they were found.
    pub cells: Vec<u32>,
    /// Number of cells whose eight neighbours are all in it.
    pub interior: usize,
    /// Its plane; `None` where the points do not make one.
    pub plane: Option<Plane>,
}

impl Segment {
    /// The points of its columns.
    pub fn moments(&self, columns: &Columns) -> Moments {
        let mut moments = Moments::default();
        let found = self.cells.iter().filter_map(|&cell| columns.get(cell as usize));
        found.for_each(|column| moments.append(&column.moments));
        moments
    }
}

/// The segments that the robot may be able to reach. The first one is that of the robot.
#[derive(Debug, Clone)]
pub struct Segments {
    /// The segments in the order in which they were found.
    pub list: Vec<Segment>,
    /// The segment of each cell.
    pub of_cell: Vec<Option<u32>>,
}

impl Segments {
    /// Algorithm 1, from the floor cell that is nearest to the robot. There are none if there is no floor
    /// within the planning radius.
    pub fn find(columns: &Columns, robot: &Robot, floor_layer: i32, settings: &SafetyMapSettings) -> Self {
        let mut found = Self { list: Vec::new(), of_cell: vec![None; columns.spec().cell_count()] };
        let Some(start) = floor_cell(columns, robot, floor_layer, settings) else { return found };
        // L_U: cells that may begin a new segment.
        let mut to_examine = vec![start];
        while let Some(cell) = to_examine.pop() {
            if found.of_cell[cell].is_none() {
                found.grow(columns, cell, settings, &mut to_examine);
            }
        }
        found.fit_planes(columns);
        if settings.merge_m > 0.0 {
            found = found.joined(columns, settings.merge_m);
        }
        if settings.reassign_cells {
            found = found.reassigned(columns, settings.merge_m);
        }
        found.count_interior(columns);
        found
    }

    /// Steps 5 to 18: the segment of a cell, and the cells next to it that are almost as high.
    fn grow(
        &mut self,
        columns: &Columns,
        first: usize,
        settings: &SafetyMapSettings,
        to_examine: &mut Vec<usize>,
    ) {
        let Some(height) = columns.height(first) else { return };
        let number = self.list.len() as u32;
        self.of_cell[first] = Some(number);
        let mut cells = vec![first as u32];
        let mut compared = 0;
        while let Some(&cell) = cells.get(compared) {
            compared += 1;
            for neighbour in columns.spec().neighbours(cell as usize) {
                let Some(other) = columns.height(neighbour).filter(|_| self.of_cell[neighbour].is_none())
                else {
                    continue;
                };
                if other == height {
                    self.of_cell[neighbour] = Some(number);
                    cells.push(neighbour as u32);
                } else if i64::from(other - height).abs() <= settings.max_height_step {
                    to_examine.push(neighbour);
                }
            }
        }
        self.list.push(Segment { cells, interior: 0, plane: None });
    }

    /// Planes of all segments.
    pub(crate) fn fit_planes(&mut self, columns: &Columns) {
        for segment in &mut self.list {
            segment.plane = segment.moments(columns).plane();
        }
    }

    /// Interior cells of all segments.
    fn count_interior(&mut self, columns: &Columns) {
        let of_cell = &self.of_cell;
        for segment in &mut self.list {
            let is_interior = |&&cell: &&u32| {
                let own = of_cell[cell as usize];
                columns.spec().neighbours(cell as usize).filter(|&n| of_cell[n] == own).count() == 8
            };
            segment.interior = segment.cells.iter().filter(is_interior).count();
        }
    }

    /// The segment of a cell.
    pub fn of(&self, flat: usize) -> Option<usize> {
        self.of_cell[flat].map(|segment| segment as usize)
    }
}

/// The nearest cell to the robot whose column is as high as the floor, but for the allowed step. A camera does
/// not see the floor under the robot, so the search goes as far as the planning radius.
fn floor_cell(
    columns: &Columns,
    robot: &Robot,
    floor_layer: i32,
    settings: &SafetyMapSettings,
) -> Option<usize> {
    let is_floor = |&cell: &usize| {
        let height = columns.height(cell);
        height.is_some_and(|height| i64::from(height - floor_layer).abs() <= settings.max_height_step)
    };
    let distance = |&cell: &usize| {
        let [x, y] = columns.spec().centre_m(cell);
        (x - robot.at_m[0]).hypot(y - robot.at_m[1])
    };
    columns.examined().filter(is_floor).min_by(|a, b| distance(a).total_cmp(&distance(b)))
}
