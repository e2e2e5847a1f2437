//! Charts as SVG: panels beside and above one another, each with axes, units and a legend.

use std::fmt::Display;

use anyhow::{Result, anyhow};
use plotters::chart::ChartContext;
use plotters::coord::Shift;
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::{
    BLACK, Cartesian2d, ChartBuilder, Circle, Color, DrawingArea, FontStyle, IntoDrawingArea, IntoFont,
    LineSeries, Polygon, RGBColor, Rectangle, SVGBackend, SeriesLabelPosition, Text, WHITE,
};
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// Colours that stay apart for most people (Okabe and Ito).
pub const BLUE: RGBColor = RGBColor(0, 114, 178);
pub const ORANGE: RGBColor = RGBColor(213, 94, 0);
pub const GREEN: RGBColor = RGBColor(0, 158, 115);
pub const PINK: RGBColor = RGBColor(204, 121, 167);
pub const YELLOW: RGBColor = RGBColor(230, 159, 0);
pub const SKY: RGBColor = RGBColor(86, 180, 233);
pub const GREY: RGBColor = RGBColor(150, 150, 150);
pub const DARK: RGBColor = RGBColor(40, 40, 40);
/// For any number of things.
pub const COLOURS: [RGBColor; 7] = [BLUE, ORANGE, GREEN, PINK, YELLOW, SKY, DARK];

/// Pixels for one line of text above the panels.
const NOTE_HEIGHT: u32 = 20;
const TITLE_HEIGHT: u32 = 30;
/// Pixels for the key, and for a letter in it.
const KEY_HEIGHT: u32 = 32;
const LETTER: i32 = 7;

/// A point in the units of the axes.
pub type Point = (f64, f64);

/// How values are shown.
#[derive(Debug, Clone)]
pub enum Marks {
    /// Joined by lines.
    Line(Vec<Point>),
    /// Filled circles with this radius in pixels.
    Dots(Vec<Point>, u32),
    /// Open circles with this radius in pixels.
    Rings(Vec<Point>, u32),
    /// Filled areas.
    Areas(Vec<Vec<Point>>),
    /// Words about places.
    Words(Vec<(Point, String)>),
}

/// What a colour means.
pub type Key = (String, RGBColor);

/// Values that belong together.
#[derive(Debug, Clone)]
pub struct Series {
    /// For the legend; empty: not in it.
    pub name: String,
    pub colour: RGBColor,
    pub marks: Marks,
}

impl Series {
    pub fn new(name: impl Into<String>, colour: RGBColor, marks: Marks) -> Self {
        Self { name: name.into(), colour, marks }
    }
}

/// An axis.
#[derive(Debug, Clone, Default)]
pub struct Axis {
    /// Name of the quantity, with unit.
    pub label: String,
    /// Its ends.
    pub range: [f64; 2],
    /// Names of 0, 1, 2 ... instead of numbers.
    pub names: Vec<String>,
}

impl Axis {
    pub fn new(label: &str, from: f64, to: f64) -> Self {
        // An axis has a length, even if there is nothing to show.
        let to = if to > from { to } else { from + 1.0 };
        Self { label: label.to_owned(), range: [from, to], names: Vec::new() }
    }

    fn text(&self, value: f64) -> String {
        if self.names.is_empty() {
            let digits = (2.0 - (self.range[1] - self.range[0]).log10().floor()).clamp(0.0, 6.0) as usize;
            let text = format!("{value:.digits$}");
            return if text.contains('.') {
                text.trim_end_matches('0').trim_end_matches('.').to_owned()
            } else {
                text
            };
        }
        let near = (value - value.round()).abs() < 1e-6 && value > -0.5;
        let name = self.names.get(value.round().max(0.0) as usize);
        name.filter(|_| near).cloned().unwrap_or_default()
    }

    /// Lines of the mesh and labels.
    fn labels(&self) -> usize {
        // Names stand at whole numbers, which need so many places.
        if self.names.is_empty() { 8 } else { 2 * self.names.len() + 2 }
    }
}

/// One pair of axes with what is drawn in it.
#[derive(Debug, Clone, Default)]
pub struct Panel {
    pub title: String,
    pub x: Axis,
    pub y: Axis,
    pub series: Vec<Series>,
    /// Where the legend stands; `None` for none.
    pub legend: Option<Corner>,
}

/// Where a legend stands.
#[derive(Debug, Clone, Copy)]
pub enum Corner {
    UpperLeft,
    UpperRight,
    LowerRight,
}

/// A whole picture.
#[derive(Debug, Clone, Default)]
pub struct Sheet {
    pub title: String,
    /// Lines below the title.
    pub notes: Vec<String>,
    /// Panels per row.
    pub columns: usize,
    /// Width and height of a panel, pixels.
    pub panel: (u32, u32),
    pub panels: Vec<Panel>,
}

impl Sheet {
    /// The picture as SVG. Fonts are those of whoever looks at it.
    pub fn draw(&self) -> Result<String> {
        self.draw_with_key(&[])
    }

    /// The picture with a line below the notes that tells what the colours of all panels mean.
    pub fn draw_with_key(&self, key: &[Key]) -> Result<String> {
        let mut svg = String::new();
        self.draw_into(&mut svg, key).map_err(|e| anyhow!("cannot draw {}: {e}", self.title))?;
        Ok(svg)
    }

    fn draw_into(&self, svg: &mut String, key: &[Key]) -> Result<(), String> {
        let columns = self.columns.max(1);
        let rows = self.panels.len().div_ceil(columns).max(1);
        let key_height = if key.is_empty() { 0 } else { KEY_HEIGHT };
        let head = TITLE_HEIGHT + NOTE_HEIGHT * self.notes.len() as u32 + key_height;
        let size = (self.panel.0 * columns as u32, head + self.panel.1 * rows as u32 + 8);
        let area = SVGBackend::with_string(svg, size).into_drawing_area();
        area.fill(&WHITE).map_err(text)?;
        let mut rest = area.titled(&self.title, ("sans-serif", 18)).map_err(text)?;
        for note in &self.notes {
            rest = rest.titled(note, ("sans-serif", 13)).map_err(text)?;
        }
        let (line, rest) = rest.split_vertically(key_height);
        draw_key(&line, key)?;
        for (panel, place) in self.panels.iter().zip(rest.split_evenly((rows, columns))) {
            panel.draw(&place)?;
        }
        area.present().map_err(text)
    }
}

type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
type Chart<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

impl Panel {
    fn draw(&self, area: &Area<'_>) -> Result<(), String> {
        let [x, y] = [self.x.range, self.y.range];
        let mut chart = ChartBuilder::on(area)
            .caption(&self.title, ("sans-serif", 14))
            .margin(10)
            .x_label_area_size(40)
            .y_label_area_size(if self.y.names.is_empty() { 58 } else { 320 })
            .build_cartesian_2d(x[0]..x[1], y[0]..y[1])
            .map_err(text)?;
        let x_text = |v: &f64| self.x.text(*v);
        let y_text = |v: &f64| self.y.text(*v);
        let mut mesh = chart.configure_mesh();
        mesh.max_light_lines(0).x_labels(self.x.labels()).y_labels(self.y.labels());
        mesh.x_desc(&self.x.label)
            .y_desc(&self.y.label)
            .x_label_formatter(&x_text)
            .y_label_formatter(&y_text);
        mesh.draw().map_err(text)?;
        for series in &self.series {
            series.draw(&mut chart)?;
        }
        self.draw_legend(&mut chart)
    }

    fn draw_legend<'a, 'b: 'a>(&self, chart: &mut Chart<'a, 'b>) -> Result<(), String> {
        let Some(corner) = self.legend else { return Ok(()) };
        let position = match corner {
            Corner::UpperLeft => SeriesLabelPosition::UpperLeft,
            Corner::UpperRight => SeriesLabelPosition::UpperRight,
            Corner::LowerRight => SeriesLabelPosition::LowerRight,
        };
        let mut labels = chart.configure_series_labels();
        labels.position(position).background_style(WHITE.mix(0.85)).border_style(BLACK.mix(0.3));
        labels.label_font(("sans-serif", 12)).draw().map_err(text)
    }
}

impl Series {
    fn draw(&self, chart: &mut Chart<'_, '_>) -> Result<(), String> {
        let colour = self.colour;
        let drawn = match &self.marks {
            Marks::Line(points) => {
                chart.draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))
            }
            Marks::Dots(points, radius) => {
                chart.draw_series(points.iter().map(|&p| Circle::new(p, *radius, colour.filled())))
            }
            Marks::Rings(points, radius) => {
                chart.draw_series(points.iter().map(|&p| Circle::new(p, *radius, colour.stroke_width(1))))
            }
            Marks::Words(words) => {
                let font = ("sans-serif", 13).into_font().style(FontStyle::Bold).color(&colour);
                let style = font.pos(Pos::new(HPos::Center, VPos::Center));
                chart.draw_series(words.iter().map(|(at, word)| Text::new(word.clone(), *at, style.clone())))
            }
            Marks::Areas(areas) => {
                chart.draw_series(areas.iter().map(|area| Polygon::new(area.clone(), colour.filled())))
            }
        };
        let drawn = drawn.map_err(text)?;
        if !self.name.is_empty() {
            drawn
                .label(&self.name)
                .legend(move |(x, y)| Rectangle::new([(x, y - 4), (x + 14, y + 4)], colour.filled()));
        }
        Ok(())
    }
}

/// Squares in colours, each with its meaning on its right.
fn draw_key(line: &Area<'_>, key: &[Key]) -> Result<(), String> {
    let mut x = 20;
    for (meaning, colour) in key {
        let square = [(x, 8), (x + 16, 24)];
        line.draw(&Rectangle::new(square, colour.filled())).map_err(text)?;
        line.draw(&Rectangle::new(square, BLACK.mix(0.4).stroke_width(1))).map_err(text)?;
        let style = ("sans-serif", 14).into_font().color(&BLACK);
        line.draw(&Text::new(meaning.clone(), (x + 22, 9), style)).map_err(text)?;
        x += 22 + LETTER * meaning.chars().count() as i32 + 22;
    }
    Ok(())
}

/// The corners of an upright rectangle.
pub fn rectangle([x0, x1]: [f64; 2], [y0, y1]: [f64; 2]) -> Vec<Point> {
    vec![(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
}

fn text(error: impl Display) -> String {
    error.to_string()
}
