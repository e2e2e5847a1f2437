use anyhow::Result;
use evigrid_eval::Step;
use evigrid_grid::LayerKind;
use evigrid_metrics::{Kind, Metric, Score, Scores, metric_of};
use evigrid_results::RunInfo;
use rerun::blueprint::components::Corner2D;
use rerun::components::Range1D;
use rerun::external::re_sdk_types::blueprint::archetypes::{PlotLegend, ScalarAxis};
use rerun::{Color, Scalars, SeriesLines};

use crate::blueprint::Pane;
use crate::classes::CellClass;
use crate::part::{Out, Part, Shown, Slot, Start};

/// Rates of each method over the frames.
const RATES: &str = "rates";
/// Counts of each method over the frames.
const COUNTS: &str = "counts";

/// Colours of metrics that are shown elsewhere too; all others take the next of the palette.
const KNOWN: [(&str, CellClass); 5] = [
    ("precision", CellClass::Mistake),
    ("recall", CellClass::Missed),
    ("hits", CellClass::Hit),
    ("mistakes", CellClass::Mistake),
    ("missed", CellClass::Missed),
];
const PALETTE: [[u8; 3]; 6] =
    [[235, 235, 235], [79, 195, 247], [255, 183, 77], [174, 213, 129], [240, 98, 146], [186, 104, 200]];

/// The scores of all methods over the frames: every metric that is shown in the summary too.
pub(crate) struct SeriesPart {
    info: RunInfo,
}

impl SeriesPart {
    pub fn new(start: Start<'_>) -> Self {
        Self { info: start.info.clone() }
    }

    /// Columns of a kind of map that are drawn in a group.
    fn columns(&self, layer: LayerKind, group: &str) -> Vec<String> {
        let columns = Scores::columns(layer, &self.info.tolerances_m, false);
        columns.into_iter().filter(|c| metric_of(c).is_some_and(|m| is_drawn(m, group))).collect()
    }
}

/// Whether a metric is drawn in a group.
fn is_drawn(metric: &Metric, group: &str) -> bool {
    let kind = if group == RATES { Kind::Rate } else { Kind::Count };
    metric.kind == kind && metric.heading().is_some()
}

/// Entity of one method's lines: voxels stand for the method itself, other kinds of maps below it.
fn path(group: &str, method: &str, layer: LayerKind) -> String {
    match layer {
        LayerKind::Voxels => format!("{group}/{method}"),
        other => format!("{group}/{method}/{}", other.name()),
    }
}

impl Part for SeriesPart {
    /// Names and colours of the lines; later methods are darker.
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        for (number, method) in self.info.methods.iter().enumerate() {
            let label = if self.info.methods.len() == 1 { "" } else { method.name.as_str() };
            let shade = 0.7_f32.powi(number as i32);
            for &layer in &method.layers {
                for group in [RATES, COUNTS] {
                    let columns = self.columns(layer, group);
                    let names = columns.iter().map(|c| format!("{label} {c}").trim().to_owned());
                    let colours = colours(&columns).into_iter().map(|c| shaded(c, shade));
                    let lines = SeriesLines::new()
                        .with_widths(vec![2.0; columns.len()])
                        .with_names(names)
                        .with_colors(colours);
                    out.always(path(group, &method.name, layer), &lines)?;
                }
            }
        }
        Ok(())
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        for method in step.methods {
            for scores in method.scores {
                for group in [RATES, COUNTS] {
                    let drawn = scores.list.iter().filter(|score| is_drawn(score.metric, group));
                    let values: Vec<f64> = drawn.map(|score: &Score| score.value).collect();
                    if !values.is_empty() {
                        out.log(path(group, method.method, scores.kind), &Scalars::new(values))?;
                    }
                }
            }
        }
        Ok(())
    }

    fn panes(&self, shown: &Shown) -> Vec<(Slot, Pane)> {
        if !shown.scored {
            return Vec::new();
        }
        let rates = Pane::new("TimeSeries", "rates so far", RATES)
            .with("PlotLegend", PlotLegend::new().with_corner(Corner2D::RightBottom))
            .with("ScalarAxis", ScalarAxis::new().with_range(Range1D::new(0.0, 1.0)));
        let counts = Pane::new("TimeSeries", "counts so far", COUNTS);
        vec![(Slot::Scores, rates), (Slot::Scores, counts)]
    }
}

fn colours(columns: &[String]) -> Vec<[u8; 3]> {
    let mut palette = PALETTE.into_iter().cycle();
    let known = |column: &str| KNOWN.iter().find(|(name, _)| *name == column).map(|(_, class)| class.rgb());
    columns.iter().map(|c| known(c).or_else(|| palette.next()).unwrap_or_default()).collect()
}

/// A colour mixed with black.
pub(crate) fn shaded(rgb: [u8; 3], shade: f32) -> Color {
    let [r, g, b] = rgb.map(|v| (f32::from(v) * shade).round() as u8);
    Color::from_rgb(r, g, b)
}
