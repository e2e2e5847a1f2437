use std::io::Write;

use anyhow::Result;
use evigrid_eval::Scores;
use rerun::{Color, Scalars, SeriesLines, TimePoint};

use crate::classes::CellClass;
use crate::rrd::{Rrd, Store};

/// Precision, recall and F1 of each method over the frames.
pub(crate) const RATES: &str = "rates";
/// Hits, mistakes and missed cells of each method over the frames.
pub(crate) const COUNTS: &str = "counts";

/// Names and colours of the lines. `label` tells methods apart, and is empty if there is one alone; `shade` is 1 for
/// the first method and less for later ones.
pub(crate) fn begin<W: Write>(
    rrd: &mut Rrd<W>,
    store: &mut Store,
    method: &str,
    label: &str,
    shade: f32,
) -> Result<()> {
    let named = |names: [&str; 3]| names.map(|n| format!("{label} {n}").trim().to_owned());
    let f1 = [235, 235, 235];
    let [hit, mistake, missed] = [CellClass::Hit, CellClass::Mistake, CellClass::Missed].map(CellClass::rgb);
    for (group, names, colours) in [
        (RATES, ["precision", "recall", "F1"], [mistake, missed, f1]),
        (COUNTS, ["hits", "mistakes", "missed"], [hit, mistake, missed]),
    ] {
        let colours = colours.map(|c| shaded(c, shade));
        let lines = SeriesLines::new().with_names(named(names)).with_colors(colours).with_widths([2.0; 3]);
        rrd.log(store, format!("{group}/{method}"), &TimePoint::default(), &lines)?;
    }
    Ok(())
}

pub(crate) fn frame<W: Write>(
    rrd: &mut Rrd<W>,
    store: &mut Store,
    at: &TimePoint,
    method: &str,
    scores: &Scores,
) -> Result<()> {
    let c = &scores.counts;
    let rates = Scalars::new([c.precision(), c.recall(), c.f1()]);
    rrd.log(store, format!("{RATES}/{method}"), at, &rates)?;
    let counts = Scalars::new([c.hits, c.mistakes, c.missed()].map(|n| n as f64));
    rrd.log(store, format!("{COUNTS}/{method}"), at, &counts)
}

/// A colour mixed with black.
pub(crate) fn shaded(rgb: [u8; 3], shade: f32) -> Color {
    let [r, g, b] = rgb.map(|v| (f32::from(v) * shade).round() as u8);
    Color::from_rgb(r, g, b)
}
