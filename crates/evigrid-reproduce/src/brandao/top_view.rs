//! Maps of a drive from above.

use evigrid_grid::GridSpec;

use crate::cells::Patches;
use crate::chart::{Axis, GREEN, GREY, Marks, ORANGE, Panel, Point, Series};

/// The class of most occupied cells of a column; a mistake if there are as many hits.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Class {
    Nothing,
    Hit,
    Mistake,
    Missed,
}

/// A map against its reference, column by column of the grid.
#[derive(Debug, Clone)]
pub struct TopView {
    spec: GridSpec,
    classes: Vec<Class>,
}

impl TopView {
    pub fn new(spec: &GridSpec, log_odds: &[f32], truth: &[bool]) -> Self {
        let nz = spec.shape()[2];
        let columns = log_odds.chunks_exact(nz).zip(truth.chunks_exact(nz));
        Self { spec: *spec, classes: columns.map(|(map, truth)| class(map, truth)).collect() }
    }

    /// Last metre along x where the map has an occupied cell.
    pub fn end_m(&self) -> f64 {
        let ny = self.spec.shape()[1];
        let occupied = |c: &Class| matches!(c, Class::Hit | Class::Mistake);
        let last = self.classes.iter().rposition(occupied).map_or(0, |at| at / ny + 1);
        self.spec.origin_m()[0] + last as f64 * self.spec.cell_size_m()
    }

    /// The panel; it ends at `end_m`.
    pub fn panel(&self, title: String, end_m: f64) -> Panel {
        let [x0, y0, _] = self.spec.origin_m();
        let height = self.spec.shape()[1] as f64 * self.spec.cell_size_m();
        let end = ((end_m - x0) / self.spec.cell_size_m()).round().max(0.0) as usize;
        let areas = |class: Class| Marks::Areas(self.areas(class, end));
        Panel {
            title,
            x: Axis::new("metres ahead of the first frame", x0, end_m),
            y: Axis::new("metres to the left", y0, y0 + height),
            series: vec![
                Series::new("", GREY, areas(Class::Missed)),
                Series::new("", ORANGE, areas(Class::Mistake)),
                Series::new("", GREEN, areas(Class::Hit)),
            ],
            legend: None,
        }
    }

    /// The columns of a class before the cell `end` along x, those beside one another along x as one area.
    fn areas(&self, class: Class, end: usize) -> Vec<Vec<Point>> {
        let ([nx, ny, _], [x0, y0, _]) = (self.spec.shape(), self.spec.origin_m());
        let patches =
            Patches { shape: [nx.min(end), ny], origin_m: [x0, y0], edge_m: self.spec.cell_size_m() };
        patches.areas(|i, j| self.classes[i * ny + j] == class)
    }
}

fn class(map: &[f32], truth: &[bool]) -> Class {
    let pairs = || map.iter().zip(truth);
    let count =
        |found: bool, real: bool| pairs().filter(|(l, t)| (**l > 0.0) == found && **t == real).count();
    let (hits, mistakes) = (count(true, true), count(true, false));
    match (hits, mistakes) {
        (0, 0) if truth.contains(&true) => Class::Missed,
        (0, 0) => Class::Nothing,
        _ if hits > mistakes => Class::Hit,
        _ => Class::Mistake,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::rectangle;
    use evigrid_grid::GridSettings;

    #[test]
    fn columns_by_hand() {
        let nan = f32::NAN;
        assert_eq!(class(&[nan, -1.0], &[false, false]), Class::Nothing);
        assert_eq!(class(&[nan, -1.0], &[true, false]), Class::Missed);
        assert_eq!(class(&[1.0, 1.0, 2.0], &[true, false, true]), Class::Hit);
        assert_eq!(class(&[1.0, 1.0], &[true, false]), Class::Mistake);
    }

    #[test]
    fn columns_beside_one_another_are_one_area() {
        let settings = GridSettings { x_m: [0.0, 4.0], y_m: [0.0, 1.0], z_m: [0.0, 1.0], cell_size_m: 1.0 };
        let spec = GridSpec::new(&settings).unwrap();
        let view = TopView::new(&spec, &[1.0, 1.0, -1.0, f32::NAN], &[true, true, true, false]);
        assert_eq!(view.areas(Class::Hit, 9), [rectangle([0.0, 2.0], [0.0, 1.0])]);
        assert_eq!(view.areas(Class::Missed, 9), [rectangle([2.0, 3.0], [0.0, 1.0])]);
        assert_eq!(view.areas(Class::Hit, 1), [rectangle([0.0, 1.0], [0.0, 1.0])]);
        assert_eq!(view.end_m(), 2.0);
    }
}
