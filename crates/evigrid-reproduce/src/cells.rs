//! Cells of a plane as areas of a picture.

use crate::chart::{Marks, Point, Series, rectangle};
use plotters::style::RGBColor;

/// A plane of square cells.
#[derive(Debug, Clone, Copy)]
pub struct Patches {
    /// Cells along the first and the second axis.
    pub shape: [usize; 2],
    /// Where the first begins, in the units of the picture's axes.
    pub origin_m: [f64; 2],
    pub edge_m: f64,
}

/// Levels that values are drawn in; odd, so that a value in the middle does not stand between two.
const LEVELS: usize = 25;

impl Patches {
    /// The cells for which something holds, those beside one another along the first axis as one area.
    pub fn areas(&self, is_in: impl Fn(usize, usize) -> bool) -> Vec<Vec<Point>> {
        let ([nx, ny], [x0, y0], c) = (self.shape, self.origin_m, self.edge_m);
        let mut areas = Vec::new();
        for j in 0..ny {
            let mut begin = None;
            for i in 0..=nx {
                match (begin, i < nx && is_in(i, j)) {
                    (None, true) => begin = Some(i),
                    (Some(from), false) => {
                        let [from, to] = [from, i].map(|i| x0 + i as f64 * c);
                        areas.push(rectangle([from, to], [y0 + j as f64 * c, y0 + (j + 1) as f64 * c]));
                        begin = None;
                    }
                    _ => {}
                }
            }
        }
        areas
    }

    /// Values in shades: from 0 to 1 through `shade`; cells without a value are left out.
    pub fn shaded(
        &self,
        value: impl Fn(usize, usize) -> Option<f64>,
        shade: impl Fn(f64) -> RGBColor,
    ) -> Vec<Series> {
        let last = (LEVELS - 1) as f64;
        let level = |i, j| value(i, j).map(|v| (v.clamp(0.0, 1.0) * last).round() as usize);
        let levels: Vec<Option<usize>> =
            (0..self.shape[0] * self.shape[1]).map(|n| level(n / self.shape[1], n % self.shape[1])).collect();
        let areas = |wanted| self.areas(|i, j| levels[i * self.shape[1] + j] == Some(wanted));
        let shown = (0..LEVELS).map(|l| (l, areas(l))).filter(|(_, areas)| !areas.is_empty());
        shown.map(|(l, areas)| Series::new("", shade(l as f64 / last), Marks::Areas(areas))).collect()
    }
}

/// Between two colours.
pub fn blend(from: RGBColor, to: RGBColor, share: f64) -> RGBColor {
    let mix =
        |a: u8, b: u8| (f64::from(a) + share.clamp(0.0, 1.0) * (f64::from(b) - f64::from(a))).round() as u8;
    RGBColor(mix(from.0, to.0), mix(from.1, to.1), mix(from.2, to.2))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::{BLUE, ORANGE};

    const PATCHES: Patches = Patches { shape: [3, 2], origin_m: [1.0, 0.0], edge_m: 0.5 };

    #[test]
    fn neighbours_along_the_first_axis_are_one_area() {
        let areas = PATCHES.areas(|i, j| j == 1 || i == 0);
        assert_eq!(areas, [rectangle([1.0, 1.5], [0.0, 0.5]), rectangle([1.0, 2.5], [0.5, 1.0])]);
    }

    #[test]
    fn equal_values_share_a_shade_and_the_unknown_has_none() {
        let shown = PATCHES.shaded(|i, j| (j == 0).then_some(i as f64), |v| blend(BLUE, ORANGE, v));
        let colours: Vec<RGBColor> = shown.iter().map(|series| series.colour).collect();
        assert_eq!(colours, [BLUE, ORANGE]);
        assert!(matches!(&shown[1].marks, Marks::Areas(areas) if areas.len() == 1));
    }
}
