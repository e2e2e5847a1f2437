//! The one list of the parts of a recording.

use evigrid_grid::LayerKind;

use crate::camera::CameraPart;
use crate::curve_plot::CurvePart;
use crate::disparity_image::DisparityPart;
use crate::hybrid::HybridPart;
use crate::labelled_image::LabelledImagePart;
use crate::laser::LaserPart;
use crate::map::MapPart;
use crate::part::{Part, Start};
use crate::plan::PlanPart;
use crate::plan_ground::PlanGroundPart;
use crate::roc_plot::RocPart;
use crate::safety::SafetyPart;
use crate::series::SeriesPart;
use crate::sight::SightPart;
use crate::summary::SummaryPart;
use crate::trajectory::TrajectoryPart;

/// The parts of a run's recording. Views in one place stand in the order of the parts.
pub(crate) fn parts(start: Start<'_>) -> Vec<Box<dyn Part>> {
    let mut parts: Vec<Box<dyn Part>> = vec![
        Box::new(CameraPart::default()),
        Box::new(TrajectoryPart::default()),
        Box::new(LaserPart),
        Box::new(DisparityPart::new(start)),
    ];
    for (number, method) in start.info.methods.iter().enumerate() {
        for layer in &method.layers {
            match layer {
                LayerKind::Voxels => parts.push(Box::new(MapPart::new(start, number))),
                LayerKind::Plan => parts.extend([
                    Box::new(PlanGroundPart::new(start, number)) as Box<dyn Part>,
                    Box::new(PlanPart::new(start, number)),
                    Box::new(SightPart::new(start, number)),
                ]),
                LayerKind::Safety => parts.extend([
                    Box::new(HybridPart::new(start, number)) as Box<dyn Part>,
                    Box::new(SafetyPart::new(start, number)),
                    Box::new(LabelledImagePart::new(start, number)),
                ]),
            }
        }
    }
    parts.extend([
        Box::new(SeriesPart::new(start)) as Box<dyn Part>,
        Box::new(RocPart::default()),
        Box::new(CurvePart),
        Box::new(SummaryPart::new(start)),
    ]);
    parts
}
