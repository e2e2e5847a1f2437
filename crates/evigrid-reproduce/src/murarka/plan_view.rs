//! Safety maps from above.

use evigrid_grid::{PlanSpec, SafetyLabel, SafetyMap};
use evigrid_results::label_rgb;
use plotters::prelude::RGBColor;

use crate::cells::Patches;
use crate::chart::{Axis, DARK, Key, Marks, Panel, Point, Series};
use crate::journey::RobotAt;

/// Width and height of a panel that shows a square map.
pub const PANEL: (u32, u32) = (430, 436);
/// Planning radius of the paper, metres.
const RADIUS_M: f64 = 4.0;
/// Length of the robot's triangle, metres.
const ROBOT_M: f64 = 0.7;
const WHITE: RGBColor = RGBColor(255, 255, 255);

/// The cells of a map as areas.
pub fn patches(spec: &PlanSpec) -> Patches {
    Patches { shape: spec.shape(), origin_m: spec.origin_m(), edge_m: spec.cell_size_m() }
}

/// A panel over a whole map.
pub fn panel(title: String, spec: &PlanSpec, series: Vec<Series>) -> Panel {
    let ([x0, y0], [nx, ny], c) = (spec.origin_m(), spec.shape(), spec.cell_size_m());
    Panel {
        title,
        x: Axis::new("metres ahead of the start", x0, x0 + nx as f64 * c),
        y: Axis::new("metres to its left", y0, y0 + ny as f64 * c),
        series,
        legend: None,
    }
}

pub fn colour(label: SafetyLabel) -> RGBColor {
    let [r, g, b] = label_rgb(label);
    RGBColor(r, g, b)
}

/// What the colours of labels mean.
pub fn label_key() -> Vec<Key> {
    use SafetyLabel::{Inclined, Level, NonGround, Unknown};
    let meaning = |(label, text): (SafetyLabel, &str)| (text.to_owned(), colour(label));
    let labels = [
        (Level, "level: safe"),
        (Inclined, "inclined: safe"),
        (NonGround, "non-ground: unsafe"),
        (Unknown, "unknown"),
    ];
    labels.into_iter().map(meaning).chain([("not examined".to_owned(), WHITE)]).collect()
}

/// The cells of each label; what nobody has examined stays white.
pub fn label_series(map: &SafetyMap) -> Vec<Series> {
    let (patches, ny) = (patches(map.spec()), map.spec().shape()[1]);
    let shown = SafetyLabel::ALL.into_iter().filter(|&label| label != SafetyLabel::Unexamined);
    let areas = |label| patches.areas(|i, j| map.labels()[i * ny + j] == label);
    shown.map(|label| Series::new("", colour(label), Marks::Areas(areas(label)))).collect()
}

/// The robot as a triangle that points ahead, and its planning radius.
pub fn robot_series(robot: &RobotAt) -> Vec<Series> {
    let triangle = triangle(robot);
    let outline = triangle.iter().chain(&triangle[..1]).copied().collect();
    vec![
        Series::new("", DARK, Marks::Line(circle(robot.at_m))),
        Series::new("", WHITE, Marks::Areas(vec![triangle.to_vec()])),
        Series::new("", DARK, Marks::Line(outline)),
    ]
}

fn triangle(robot: &RobotAt) -> [Point; 3] {
    let ([x, y], [c, s]) = (robot.at_m, robot.heading);
    let corners = [(0.5, 0.0), (-0.5, 0.3), (-0.5, -0.3)];
    corners.map(|(ahead, left)| (x + ROBOT_M * (c * ahead - s * left), y + ROBOT_M * (s * ahead + c * left)))
}

fn circle([x, y]: [f64; 2]) -> Vec<Point> {
    let angles = (0..=72).map(|n| (5.0 * f64::from(n)).to_radians());
    angles.map(|a| (x + RADIUS_M * a.cos(), y + RADIUS_M * a.sin())).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_triangle_points_ahead() {
        let robot = RobotAt { at_m: [1.0, 2.0], heading: [0.0, 1.0] };
        let expected = [(1.0, 2.35), (0.79, 1.65), (1.21, 1.65)];
        for (corner, expected) in triangle(&robot).into_iter().zip(expected) {
            assert!((corner.0 - expected.0).hypot(corner.1 - expected.1) < 1e-9, "{corner:?}");
        }
    }

    #[test]
    fn cells_are_drawn_in_the_colour_of_their_label() {
        let mut map =
            SafetyMap::of(PlanSpec::of_area([0.0, 2.0], [0.0, 1.0], 1.0).unwrap(), SafetyLabel::Unexamined);
        map.set(1, SafetyLabel::NonGround, None);
        let drawn: Vec<_> = label_series(&map)
            .into_iter()
            .filter(|series| matches!(&series.marks, Marks::Areas(areas) if !areas.is_empty()))
            .collect();
        assert_eq!(drawn.len(), 1);
        assert_eq!(drawn[0].colour, RGBColor(230, 130, 0));
        let square = vec![(1.0, 0.0), (2.0, 0.0), (2.0, 1.0), (1.0, 1.0)];
        assert!(matches!(&drawn[0].marks, Marks::Areas(areas) if areas == &[square]));
    }
}
