//! Which views a recording opens with.

use rerun::blueprint::components::{BackgroundKind, Corner2D, Eye3DKind, VisualBounds2D as Bounds};
use rerun::components::Range1D;
use rerun::datatypes::Range2D;
use rerun::external::re_sdk_types::blueprint::archetypes::{
    Background, EyeControls3D, LineGrid3D, PlotLegend, ScalarAxis, VisualBounds2D,
};

use crate::blueprint::{Node, View};
use crate::camera::{CAMERA, IMAGE};
use crate::curve_plot::{BOX, CURVE};
use crate::disparity_image::DISPARITY;
use crate::laser::LASER;
use crate::map::{map_path, top_view_path};
use crate::series::{COUNTS, RATES};
use crate::trajectory::TRAJECTORY;

/// The summary of the run.
pub(crate) const SUMMARY: &str = "summary";

/// What of a run decides on its layout.
pub(crate) struct Shown<'a> {
    /// Names of the methods.
    pub methods: &'a [String],
    /// Whether there is a reference.
    pub scored: bool,
    /// First and last cell along x where a map is occupied.
    pub extent_x: (usize, usize),
    /// Cells of the grid along y.
    pub cells_y: usize,
    /// The same in metres: beginning and end along x, and what of y and z to look at.
    pub extent_m: ([f32; 2], f32, f32),
}

/// The whole window.
pub(crate) fn window(shown: &Shown<'_>) -> Node {
    let maps = shown.methods.iter().map(|m| map_view(shown, m)).collect();
    let top_views = shown.methods.iter().map(|m| top_view(shown, m)).collect();
    let left = Node::rows(vec![
        (0.56, Node::tabs(maps)),
        (0.145, Node::tabs(top_views)),
        (0.295, view("TextDocument", "summary", SUMMARY, &[format!("+ /{SUMMARY}")])),
    ]);
    let mut right = vec![
        (0.17, view("2D", "left image", IMAGE, &["+ $origin/**".into()])),
        (0.17, view("2D", "disparity: blue far, red near", DISPARITY, &["+ $origin/**".into()])),
    ];
    if shown.scored {
        right.push((0.33, Node::tabs(vec![series_view("precision, recall, F1", RATES), counts_view()])));
        right.push((0.33, curve_view()));
    }
    Node::columns(vec![(0.63, left), (0.37, Node::rows(right))])
}

fn view(class: &'static str, title: &str, origin: &str, contents: &[String]) -> Node {
    Node::View(View {
        class,
        title: title.to_owned(),
        origin: format!("/{origin}"),
        contents: contents.to_vec(),
        properties: Vec::new(),
    })
}

/// The map in space, seen from behind and above the first camera.
fn map_view(shown: &Shown<'_>, method: &str) -> Node {
    let ([from, to], y, z) = shown.extent_m;
    let length = to - from;
    let eye = EyeControls3D::new()
        .with_kind(Eye3DKind::Orbital)
        .with_position([from - 0.08 * length, y - 0.26 * length, z + 0.30 * length])
        .with_look_target([from + 0.38 * length, y, z])
        .with_eye_up([0.0, 0.0, 1.0]);
    let colours = if shown.scored {
        "green = right, red = wrong, orange = the laser saw nothing there, violet = missed"
    } else {
        "occupied cells"
    };
    Node::View(View {
        class: "3D",
        title: format!("{method}: {colours}"),
        origin: "/world".to_owned(),
        contents: [map_path(method), TRAJECTORY.into(), LASER.into(), CAMERA.into()]
            .map(|path| format!("+ /{path}/**"))
            .to_vec(),
        properties: vec![
            ("EyeControls3D", Box::new(eye)),
            ("Background", Box::new(dark())),
            ("LineGrid3D", Box::new(LineGrid3D::new().with_visible(false))),
        ],
    })
}

/// The map from above, cut to what was touched.
fn top_view(shown: &Shown<'_>, method: &str) -> Node {
    let (first, last) = shown.extent_x;
    let bounds = bounds([first as f64, (last + 1) as f64], [0.0, shown.cells_y as f64]);
    Node::View(View {
        class: "2D",
        title: format!("{method} from above: forward is to the right"),
        origin: format!("/{}", top_view_path(method)),
        contents: vec!["+ $origin/**".into()],
        properties: vec![("VisualBounds2D", Box::new(bounds)), ("Background", Box::new(dark()))],
    })
}

fn series_view(title: &str, group: &str) -> Node {
    let legend = PlotLegend::new().with_corner(Corner2D::RightBottom);
    let axis = ScalarAxis::new().with_range(Range1D::new(0.0, 1.0));
    Node::View(View {
        class: "TimeSeries",
        title: title.to_owned(),
        origin: format!("/{group}"),
        contents: vec!["+ $origin/**".into()],
        properties: vec![("PlotLegend", Box::new(legend)), ("ScalarAxis", Box::new(axis))],
    })
}

fn counts_view() -> Node {
    view("TimeSeries", "cells: hits, mistakes, missed", COUNTS, &["+ $origin/**".into()])
}

fn curve_view() -> Node {
    let [width, height] = BOX.map(f64::from);
    let bounds = bounds([-18.0, width + 12.0], [-12.0, height + 14.0]);
    Node::View(View {
        class: "2D",
        title: "hits against mistakes over the threshold".to_owned(),
        origin: format!("/{CURVE}"),
        contents: vec!["+ $origin/**".into()],
        properties: vec![("VisualBounds2D", Box::new(bounds)), ("Background", Box::new(dark()))],
    })
}

fn bounds(x_range: [f64; 2], y_range: [f64; 2]) -> VisualBounds2D {
    let range = Range2D { x_range: x_range.into(), y_range: y_range.into() };
    VisualBounds2D::new(Bounds::from(range))
}

fn dark() -> Background {
    Background::new(BackgroundKind::SolidColor).with_color(rerun::Color::from_rgb(14, 15, 18))
}
