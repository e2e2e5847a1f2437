//! Hits against mistakes over the probability threshold, drawn by hand: the viewer has no plot of y over x.

use anyhow::Result;
use evigrid_grid::LayerKind;
use evigrid_metrics::{Curve, CurvePoint};
use evigrid_results::{MethodResult, RunResult};
use rerun::components::Radius;
use rerun::{Color, LineStrips2D, Points2D};

use crate::blueprint::Pane;
use crate::layout::{bounds, dark};
use crate::part::{Out, Part, Shown, Slot};
use crate::series::shaded;
use crate::ticks::{short, ticks};

/// The plot.
const CURVE: &str = "curve";

/// Size of the plot's box in scene units; y runs downwards in the viewer.
const BOX: [f32; 2] = [160.0, 100.0];

pub(crate) const COLOURS: [[u8; 3]; 6] =
    [[79, 195, 247], [255, 183, 77], [174, 213, 129], [240, 98, 146], [186, 104, 200], [255, 241, 118]];

/// From counts to the box.
#[derive(Debug, Clone, Copy)]
struct Scale {
    /// Mistakes at the right edge.
    mistakes: f64,
    /// Hits at the top.
    hits: f64,
}

impl Scale {
    /// The top is the number of true cells; the right edge shows the map as it stands with some room.
    fn of(curves: &[NamedCurve<'_>]) -> Self {
        let hits = curves.iter().map(|c| c.curve.true_cells).max().unwrap_or(0).max(1) as f64;
        let at_zero = curves.iter().filter_map(|c| at_threshold_zero(c.curve)).map(|p| p.mistakes).max();
        Self { mistakes: hits.max(1.25 * at_zero.unwrap_or(0) as f64), hits }
    }

    fn place(self, mistakes: f64, hits: f64) -> [f32; 2] {
        let [width, height] = BOX;
        [(mistakes / self.mistakes) as f32 * width, (1.0 - hits / self.hits) as f32 * height]
    }
}

/// The point of the map as it is scored: occupied means a probability above one half.
fn at_threshold_zero(curve: &Curve) -> Option<&CurvePoint> {
    curve.points.iter().min_by(|a, b| a.log_odds.abs().total_cmp(&b.log_odds.abs()))
}

/// The curve from (0, 0) on, cut off at the right edge.
fn strip(curve: &Curve, scale: Scale) -> Vec<[f32; 2]> {
    let mut strip = vec![scale.place(0.0, 0.0)];
    let (mut m0, mut h0) = (0.0, 0.0);
    for point in &curve.points {
        let (m, h) = (point.mistakes as f64, point.hits as f64);
        if m > scale.mistakes {
            let h_at_edge = h0 + (h - h0) * (scale.mistakes - m0) / (m - m0);
            strip.push(scale.place(scale.mistakes, h_at_edge));
            break;
        }
        if (m, h) != (m0, h0) {
            strip.push(scale.place(m, h));
        }
        (m0, h0) = (m, h);
    }
    strip
}

/// The curve of one method.
#[derive(Debug, Clone, Copy)]
struct NamedCurve<'a> {
    method: &'a str,
    curve: &'a Curve,
}

impl<'a> NamedCurve<'a> {
    /// `None` for a method whose voxels were not scored.
    fn of(result: &'a MethodResult) -> Option<Self> {
        let curve = result.scores_of(LayerKind::Voxels)?.curve.as_ref()?;
        Some(Self { method: &result.method, curve })
    }
}

/// The curves of all methods; without any curve nothing is drawn.
pub(crate) struct CurvePart;

impl Part for CurvePart {
    fn end(&mut self, out: &mut Out<'_>, result: &RunResult) -> Result<()> {
        let curves: Vec<_> = result.methods.iter().filter_map(NamedCurve::of).collect();
        write_curves(out, &curves)
    }

    fn panes(&self, shown: &Shown) -> Vec<(Slot, Pane)> {
        let [width, height] = BOX.map(f64::from);
        let area = bounds([-18.0, width + 12.0], [-12.0, height + 14.0]);
        let pane = Pane::new("2D", "hits against mistakes over the threshold", CURVE)
            .with("VisualBounds2D", area)
            .with("Background", dark());
        if shown.scored { vec![(Slot::Curve, pane)] } else { Vec::new() }
    }
}

fn write_curves(out: &mut Out<'_>, curves: &[NamedCurve<'_>]) -> Result<()> {
    if curves.is_empty() {
        return Ok(());
    }
    let scale = Scale::of(curves);
    write_axes(out, scale)?;
    for (curve, colour) in curves.iter().zip(COLOURS.into_iter().cycle()) {
        write_curve(out, scale, curve, shaded(colour, 1.0))?;
    }
    Ok(())
}

fn write_curve(out: &mut Out<'_>, scale: Scale, named: &NamedCurve<'_>, colour: Color) -> Result<()> {
    let NamedCurve { method, curve } = named;
    let line = LineStrips2D::new([strip(curve, scale)])
        .with_colors([colour])
        .with_radii([Radius::new_ui_points(1.5)])
        .with_draw_order(2.0);
    out.always(format!("{CURVE}/{method}"), &line)?;
    let Some(point) = at_threshold_zero(curve) else { return Ok(()) };
    let label = format!("{method}: {} hits, {} mistakes", point.hits, point.mistakes);
    let mark = Points2D::new([scale.place(point.mistakes as f64, point.hits as f64)])
        .with_colors([colour])
        .with_radii([Radius::new_ui_points(5.0)])
        .with_labels([label])
        .with_draw_order(3.0);
    out.always(format!("{CURVE}/{method}/as_scored"), &mark)
}

/// A line across the box at a round number.
struct GridLine {
    line: [[f32; 2]; 2],
    label_at: [f32; 2],
    label: String,
}

fn grid_lines(scale: Scale) -> Vec<GridLine> {
    let [width, height] = BOX;
    let upright = ticks(scale.mistakes).into_iter().map(|t| {
        let [x, _] = scale.place(t, 0.0);
        let line = [[x, height + 2.0], [x, 0.0]];
        GridLine { line, label_at: [x, height + 3.0], label: short(t) }
    });
    let level = ticks(scale.hits).into_iter().filter(|t| *t > 0.0).map(|t| {
        let [_, y] = scale.place(0.0, t);
        // The viewer puts a label below its point.
        GridLine { line: [[-2.0, y], [width, y]], label_at: [-10.0, y - 6.0], label: short(t) }
    });
    upright.chain(level).collect()
}

/// How a line of the axes looks.
#[derive(Debug, Clone, Copy)]
struct Pen {
    /// Brightness, 0 to 255.
    grey: u8,
    /// Half the width, points on the screen.
    radius: f32,
}

fn write_axes(out: &mut Out<'_>, scale: Scale) -> Result<()> {
    let [width, height] = BOX;
    let grid = grid_lines(scale);
    let equal = scale.mistakes.min(scale.hits);
    let frame = vec![[0.0, 0.0], [0.0, height], [width, height]];
    let half = vec![scale.place(0.0, 0.0), scale.place(equal, equal)];
    let lines = grid.iter().map(|g| g.line.to_vec()).collect();
    write_lines(out, "grid", lines, Pen { grey: 62, radius: 0.5 })?;
    write_lines(out, "as_many_mistakes_as_hits", vec![half], Pen { grey: 98, radius: 0.5 })?;
    write_lines(out, "axes", vec![frame], Pen { grey: 160, radius: 0.8 })?;
    let titles = [
        ([width + 3.0, height + 3.0], "mistakes".to_owned()),
        ([0.0, -11.0], "hits".to_owned()),
        (scale.place(0.86 * equal, 0.86 * equal), "precision 0.5".to_owned()),
    ];
    let texts = grid.into_iter().map(|g| (g.label_at, g.label)).chain(titles);
    let (places, texts): (Vec<_>, Vec<_>) = texts.unzip();
    let texts = Points2D::new(places)
        .with_labels(texts)
        .with_show_labels(true)
        .with_colors([Color::from_rgb(190, 190, 190)])
        .with_radii([Radius::new_ui_points(0.0)]);
    out.always(format!("{CURVE}/labels"), &texts)
}

fn write_lines(out: &mut Out<'_>, name: &str, lines: Vec<Vec<[f32; 2]>>, pen: Pen) -> Result<()> {
    let lines = LineStrips2D::new(lines)
        .with_colors([Color::from_rgb(pen.grey, pen.grey, pen.grey)])
        .with_radii([Radius::new_ui_points(pen.radius)]);
    out.always(format!("{CURVE}/{name}"), &lines)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn curve() -> Curve {
        let points = [(1.0, 10, 0), (0.0, 40, 50), (-1.0, 60, 150), (-2.0, 80, 350)];
        let points = points.map(|(log_odds, hits, mistakes)| CurvePoint { log_odds, hits, mistakes });
        Curve { points: points.to_vec(), true_cells: 100 }
    }

    #[test]
    fn the_curve_rises_from_the_lower_left_and_ends_at_the_edge() {
        let curve = curve();
        let scale = Scale::of(&[NamedCurve { method: "m", curve: &curve }]);
        assert_eq!((scale.mistakes, scale.hits), (100.0, 100.0));
        // (0, 0), (0, 10), (50, 40), and half-way to (150, 60).
        let strip = strip(&curve, scale).into_iter().map(|p| p.map(f32::round));
        assert_eq!(strip.collect::<Vec<_>>(), [[0.0, 100.0], [0.0, 90.0], [80.0, 60.0], [160.0, 50.0]]);
        assert_eq!(at_threshold_zero(&curve).map(|p| p.hits), Some(40));
    }

    #[test]
    fn a_map_with_many_mistakes_still_shows_its_own_point() {
        let mut curve = curve();
        curve.points[1].mistakes = 120;
        assert_eq!(Scale::of(&[NamedCurve { method: "m", curve: &curve }]).mistakes, 150.0);
    }

    #[test]
    fn an_empty_reference_does_no_harm() {
        let empty = Curve { points: Vec::new(), true_cells: 0 };
        let scale = Scale::of(&[NamedCurve { method: "m", curve: &empty }]);
        assert_eq!(strip(&empty, scale), [[0.0, 100.0]]);
        assert!(grid_lines(scale).iter().flat_map(|g| g.line).flatten().all(f32::is_finite));
    }
}
