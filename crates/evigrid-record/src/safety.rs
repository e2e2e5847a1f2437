use anyhow::Result;
use evigrid_eval::Step;
use evigrid_grid::{Layer, SafetyLabel};
use evigrid_results::label_rgb;
use rerun::AnnotationContext;
use rerun::datatypes::{AnnotationInfo, ClassDescription, Rgba32};

use crate::blueprint::Pane;
use crate::layout::dark;
use crate::part::{Out, Part, Shown, Slot, Start};
use crate::plan::plan_image;
use crate::safety_verdict::{Verdict, verdicts};

/// The colours of the labels for people.
pub(crate) const LEGEND: &str =
    "blue = level, light blue = inclined, orange = not to be driven on, grey = unknown";

/// The safety labels of one method, and where there is a truth how they compare with it: forward to the
/// right, left upwards, one pixel per cell.
pub(crate) struct SafetyPart {
    number: usize,
    method: String,
    /// Whether any frame had a truth.
    judged: bool,
}

impl SafetyPart {
    pub fn new(start: Start<'_>, number: usize) -> Self {
        Self { number, method: start.info.methods[number].name.clone(), judged: false }
    }

    fn path(&self) -> String {
        format!("safety/{}", self.method)
    }

    fn verdict_path(&self) -> String {
        format!("safety_verdict/{}", self.method)
    }
}

fn colour(label: SafetyLabel) -> Rgba32 {
    let [r, g, b] = label_rgb(label);
    Rgba32::from_rgb(r, g, b)
}

impl Part for SafetyPart {
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        let about = |label: SafetyLabel| {
            ClassDescription::from(AnnotationInfo::from((label as u16, label.name(), colour(label))))
        };
        out.always(self.path(), &AnnotationContext::new(SafetyLabel::ALL.map(about)))?;
        out.always(self.verdict_path(), &Verdict::annotations())
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        for layer in step.methods[self.number].layers {
            if let Layer::Safety(map) = layer {
                let numbers: Vec<u8> = map.labels().iter().map(|label| *label as u8).collect();
                out.log(self.path(), &plan_image(map.spec(), &numbers))?;
                if let Some(truth) = step.truth.safety() {
                    self.judged = true;
                    out.log(self.verdict_path(), &plan_image(truth.spec(), &verdicts(map, truth)))?;
                }
            }
        }
        Ok(())
    }

    fn panes(&self, _: &Shown) -> Vec<(Slot, Pane)> {
        let pane = |title: &str, path: &str| {
            Pane::new("2D", format!("{}: {title}", self.method), path).with("Background", dark())
        };
        let labels = pane(&format!("safety map, {LEGEND}"), &self.path());
        if !self.judged {
            return vec![(Slot::Space, labels)];
        }
        let title =
            "safety, green = right, red = unsafe called safe, orange = safe called unsafe, violet = missed";
        vec![(Slot::Space, pane(title, &self.verdict_path())), (Slot::Above, labels)]
    }
}
