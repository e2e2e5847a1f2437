//! Images of the cameras in a picture: small, in shades.

use plotters::prelude::RGBColor;

use crate::cells::{Patches, blend};
use crate::chart::{Axis, Marks, Panel, Series, rectangle};

/// Pixels of the image per pixel that is shown.
pub const SHRINK: usize = 5;
/// Of a panel that shows an image of 640 x 480.
pub const PANEL: (u32, u32) = (420, 340);

/// Grey levels, 0 to 255.
pub fn grey_panel(title: &str, size: [usize; 2], grey: impl Fn(usize, usize) -> u8) -> Panel {
    let value = |x: usize, y: usize| Some(f64::from(grey(x, y)) / 255.0);
    panel(title, size, value, |v| blend(RGBColor(0, 0, 0), RGBColor(255, 255, 255), v))
}

/// Disparities: the nearer the brighter green; white: none.
pub fn disparity_panel(title: &str, size: [usize; 2], most_px: f64, values: &[f32]) -> Panel {
    let value = |x: usize, y: usize| {
        let d = f64::from(values[y * size[0] + x]);
        (!d.is_nan()).then_some(d / most_px)
    };
    panel(title, size, value, |v| blend(RGBColor(0, 40, 20), RGBColor(60, 255, 120), v))
}

fn panel(
    title: &str,
    [width, height]: [usize; 2],
    value: impl Fn(usize, usize) -> Option<f64>,
    shade: impl Fn(f64) -> RGBColor,
) -> Panel {
    let shape = [width / SHRINK, height / SHRINK];
    let patches = Patches { shape, origin_m: [0.0; 2], edge_m: SHRINK as f64 };
    // The picture's rows go up, the image's down.
    let at = |i: usize, j: usize| value(i * SHRINK + SHRINK / 2, (shape[1] - 1 - j) * SHRINK + SHRINK / 2);
    let (right, top) = ((shape[0] * SHRINK) as f64, (shape[1] * SHRINK) as f64);
    let mut series = vec![Series::new(
        "",
        RGBColor(255, 255, 255),
        Marks::Areas(vec![rectangle([0.0, right], [0.0, top])]),
    )];
    series.extend(patches.shaded(at, shade));
    Panel {
        title: title.to_owned(),
        x: Axis::new("pixels", 0.0, right),
        y: Axis::new("pixels, from below", 0.0, top),
        series,
        legend: None,
    }
}
