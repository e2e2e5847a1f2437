//! Hits against mistakes as a picture.

use std::fmt::Display;

use anyhow::{Result, anyhow};
use plotters::prelude::{
    BLACK, ChartBuilder, Circle, Color, IntoDrawingArea, LineSeries, PathElement, RGBColor, SVGBackend,
    SeriesLabelPosition, WHITE,
};

use super::lines::Line;

const SIZE: (u32, u32) = (860, 600);

/// Colours that stay apart for most people (Okabe and Ito).
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];
/// More lines than this go without a legend.
const LEGEND_LINES: usize = 14;

/// The curves of one data set as SVG. Fonts are those of whoever looks at it.
pub(super) fn draw(title: &str, lines: &[Line<'_>]) -> Result<String> {
    let mut svg = String::new();
    draw_into(&mut svg, title, lines).map_err(|e| anyhow!("cannot draw the curves of {title}: {e}"))?;
    Ok(svg)
}

fn draw_into(svg: &mut String, title: &str, lines: &[Line<'_>]) -> Result<(), String> {
    let area = SVGBackend::with_string(svg, SIZE).into_drawing_area();
    area.fill(&WHITE).map_err(text)?;
    let all = || lines.iter().flat_map(Line::scored);
    let end = |values: &mut dyn Iterator<Item = f64>| 1.05 * values.fold(1.0, f64::max);
    let (right, top) = (end(&mut all().map(|p| p.0)), end(&mut all().map(|p| p.1)));
    let mut chart = ChartBuilder::on(&area)
        .caption(title, ("sans-serif", 18))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d(0.0..right, 0.0..top)
        .map_err(text)?;
    let whole = |v: &f64| format!("{v:.0}");
    chart
        .configure_mesh()
        .max_light_lines(0)
        .x_desc("mistakes (cells)")
        .y_desc("hits (cells)")
        .x_label_formatter(&whole)
        .y_label_formatter(&whole)
        .draw()
        .map_err(text)?;
    for (line, colour) in lines.iter().zip(COLOURS.into_iter().cycle()) {
        let series =
            chart.draw_series(LineSeries::new(line.scored(), colour.stroke_width(2))).map_err(text)?;
        if lines.len() <= LEGEND_LINES {
            series.label(&line.name).legend(move |(x, y)| PathElement::new([(x, y), (x + 18, y)], colour));
        }
        let dots = line.scored().into_iter().map(|p| Circle::new(p, 3, colour.filled()));
        chart.draw_series(dots).map_err(text)?;
    }
    chart
        .configure_series_labels()
        .position(SeriesLabelPosition::LowerRight)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()
        .map_err(text)?;
    area.present().map_err(text)
}

fn text(error: impl Display) -> String {
    error.to_string()
}
