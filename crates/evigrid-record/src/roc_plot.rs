//! Receiver operating characteristics of plans counted frame by frame, drawn by hand as the curve of voxels is.

use anyhow::Result;
use evigrid_results::RunResult;
use rerun::components::Radius;
use rerun::{Color, LineStrips2D, Points2D};

use crate::blueprint::Pane;
use crate::curve_plot::COLOURS;
use crate::layout::{bounds, dark};
use crate::part::{Out, Part, Shown, Slot};
use crate::series::shaded;

const ROC: &str = "roc";
/// Edge of the plot in scene units; y runs downwards in the viewer.
const EDGE: f32 = 100.0;

/// The curves of all methods; without any nothing is drawn.
#[derive(Default)]
pub(crate) struct RocPart {
    is_drawn: bool,
}

impl Part for RocPart {
    fn end(&mut self, out: &mut Out<'_>, result: &RunResult) -> Result<()> {
        let curves = result.methods.iter().filter_map(|method| Some((&method.method, method.plan.as_ref()?)));
        for (n, (method, tally)) in curves.enumerate() {
            if !self.is_drawn {
                write_axes(out)?;
                self.is_drawn = true;
            }
            let all = tally.all();
            let place = |x: f64, y: f64| [x as f32 * EDGE, (1.0 - y as f32) * EDGE];
            let start = std::iter::once(place(0.0, 0.0));
            let points: Vec<[f32; 2]> =
                start.chain(all.roc().iter().map(|p| place(p.false_positive_rate, p.recall))).collect();
            let colour = shaded(COLOURS[n % COLOURS.len()], 1.0);
            let line = LineStrips2D::new([points.clone()])
                .with_colors([colour])
                .with_radii([Radius::new_ui_points(1.5)]);
            out.always(format!("{ROC}/{method}"), &line)?;
            // The names stand one below the other in the empty corner.
            let name = Points2D::new([[0.62 * EDGE, (0.55 + 0.1 * n as f32) * EDGE]])
                .with_labels([format!("{method}: AUC {:.3}", all.auc())])
                .with_show_labels(true)
                .with_colors([colour])
                .with_radii([Radius::new_ui_points(4.0)]);
            out.always(format!("{ROC}/{method}/name"), &name)?;
        }
        Ok(())
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        let edge = f64::from(EDGE);
        let area = bounds([-14.0, edge + 10.0], [-8.0, edge + 12.0]);
        let title = "plans frame by frame: occupied cells found over free cells called occupied";
        let pane = Pane::new("2D", title, ROC).with("VisualBounds2D", area).with("Background", dark());
        if self.is_drawn { vec![(Slot::Curve, pane)] } else { Vec::new() }
    }
}

fn write_axes(out: &mut Out<'_>) -> Result<()> {
    let frame = vec![[0.0, 0.0], [0.0, EDGE], [EDGE, EDGE], [EDGE, 0.0], [0.0, 0.0]];
    let chance = vec![[0.0, EDGE], [EDGE, 0.0]];
    let lines = LineStrips2D::new([frame, chance])
        .with_colors([Color::from_rgb(120, 120, 120)])
        .with_radii([Radius::new_ui_points(0.7)]);
    out.always(format!("{ROC}/axes"), &lines)?;
    let texts = [
        ([0.0, EDGE + 2.0], "0"),
        ([EDGE, EDGE + 2.0], "1"),
        ([-7.0, -4.0], "1"),
        ([0.5 * EDGE, EDGE + 3.0], "false positive rate"),
        ([-3.0, 0.45 * EDGE], "recall"),
    ];
    let texts = Points2D::new(texts.map(|(at, _)| at))
        .with_labels(texts.map(|(_, text)| text))
        .with_show_labels(true)
        .with_colors([Color::from_rgb(190, 190, 190)])
        .with_radii([Radius::new_ui_points(0.0)]);
    out.always(format!("{ROC}/labels"), &texts)
}
