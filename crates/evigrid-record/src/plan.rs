use anyhow::Result;
use evigrid_eval::Step;
use evigrid_grid::{Layer, PlanGrid, PlanSpec, logit};
use evigrid_metrics::{PlanReference, PlanState};
use rerun::SegmentationImage;
use rerun::components::ImageFormat;

use crate::blueprint::Pane;
use crate::classes::{CellClass, class_alone, class_of};
use crate::layout::dark;
use crate::part::{Out, Part, Shown, Slot, Start};

/// The ground plan of one method, coloured by its truth: forward to the right, left upwards, one pixel per
/// cell.
pub(crate) struct PlanPart {
    number: usize,
    method: String,
}

impl PlanPart {
    pub fn new(start: Start<'_>, number: usize) -> Self {
        Self { number, method: start.info.methods[number].name.clone() }
    }

    fn path(&self) -> String {
        format!("plan/{}", self.method)
    }
}

impl Part for PlanPart {
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        out.always(self.path(), &CellClass::annotations())
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        // What the laser of the frame says, if it is known: things move.
        let truth = step.truth.frame_plan().or_else(|| step.truth.plan());
        for layer in step.methods[self.number].layers {
            if let Layer::Plan(plan) = layer {
                let classes = classes(plan, truth.as_ref());
                out.log(self.path(), &plan_image(plan.spec(), &classes))?;
            }
        }
        Ok(())
    }

    fn panes(&self, shown: &Shown) -> Vec<(Slot, Pane)> {
        let colours = if shown.scored {
            "green = right, red = wrong, orange = the truth is unknown there, violet = missed"
        } else {
            "light = occupied, forward is to the right"
        };
        let title = format!("{}: ground plan, {colours}", self.method);
        vec![(Slot::Space, Pane::new("2D", title, &self.path()).with("Background", dark()))]
    }
}

/// Class numbers of the cells, by flat index.
fn classes(plan: &PlanGrid, truth: Option<&PlanReference>) -> Vec<u8> {
    let class = |(flat, &p): (usize, &f32)| {
        let log_odds = logit(f64::from(p)) as f32;
        let Some(truth) = truth else { return class_alone(log_odds) as u8 };
        let state = truth.spec.cell_of(plan.centre_in_map_m(flat)).map(|cell| truth.cells[cell]);
        let state = state.unwrap_or(PlanState::Unknown);
        class_of(log_odds, state == PlanState::Occupied, state != PlanState::Unknown) as u8
    };
    plan.probabilities().iter().enumerate().map(class).collect()
}

/// An image of the numbers of cells, given by flat index: x (forward) runs to the right, y (left) upwards.
pub(crate) fn plan_image(spec: &PlanSpec, numbers: &[u8]) -> SegmentationImage {
    let [nx, ny] = spec.shape();
    let pixels = (0..ny).rev().flat_map(|j| (0..nx).map(move |i| numbers[i * ny + j])).collect::<Vec<u8>>();
    let format = ImageFormat::segmentation([nx as u32, ny as u32], rerun::ChannelDatatype::U8);
    SegmentationImage::new(pixels, format)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn cells_are_judged_where_the_plan_lies_in_the_map() {
        let spec = PlanSpec::of_area([0.0, 2.0], [0.0, 1.0], 1.0).unwrap();
        let shift = nalgebra::Isometry2::translation(1.0, 0.0);
        let mut plan = PlanGrid::moving(spec, shift);
        plan.probabilities_mut().copy_from_slice(&[0.9, 0.1]);
        let cells = vec![PlanState::Free, PlanState::Occupied];
        let truth = PlanReference { spec, cells };
        let expected = [CellClass::Hit, CellClass::Free].map(|c| c as u8);
        // Cell 0 of the plan lies on cell 1 of the truth, cell 1 outside of it.
        assert_eq!(classes(&plan, Some(&truth)), expected);
        let alone = [CellClass::Occupied, CellClass::Free].map(|c| c as u8);
        assert_eq!(classes(&plan, None), alone);
    }

    /// The vehicle stands at (10, 20) and looks to the left of the map: its forward is the map's left, its
    /// left the map's rear.
    #[test]
    fn a_turned_plan_is_judged_cell_by_cell() {
        let area = PlanSpec::of_area([1.0, 4.0], [-1.0, 1.0], 1.0).unwrap();
        let turn = nalgebra::Isometry2::new([10.0, 20.0].into(), std::f64::consts::FRAC_PI_2);
        let mut plan = PlanGrid::moving(area, turn);
        // Occupied: rear right (map 10.5, 21.5) and front left (map 9.5, 23.5). Never seen: front right.
        plan.probabilities_mut().copy_from_slice(&[0.9, 0.1, 0.1, 0.1, f32::NAN, 0.8]);
        let spec = PlanSpec::of_area([8.0, 12.0], [19.0, 24.0], 1.0).unwrap();
        let mut cells = vec![PlanState::Free; spec.cell_count()];
        cells[spec.cell_of([10.5, 21.5]).unwrap()] = PlanState::Occupied;
        cells[spec.cell_of([9.5, 22.5]).unwrap()] = PlanState::Occupied;
        let numbers = classes(&plan, Some(&PlanReference { spec, cells }));
        use CellClass::{Free, Hit, Missed, Mistake, Unknown};
        assert_eq!(numbers, [Hit, Free, Free, Missed, Unknown, Mistake].map(|c| c as u8));
    }
}
