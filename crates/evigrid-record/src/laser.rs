use anyhow::Result;
use evigrid_core::LaserScan;
use evigrid_eval::Step;
use rerun::components::Radius;
use rerun::{Color, Points3D};

use crate::camera::transform;
use crate::part::{Out, Part};

/// The latest laser scan.
pub(crate) const LASER: &str = "world/laser";

/// Points of a scan that are kept: enough to see what is there, few enough to keep the file small.
const KEPT_POINTS: usize = 6000;

/// A thinned scan, in the laser's own frame below its pose; a frame without a scan shows none.
pub(crate) struct LaserPart;

impl Part for LaserPart {
    fn begin(&mut self, out: &mut Out<'_>) -> Result<()> {
        let look = Points3D::update_fields()
            .with_colors([Color::from_rgb(104, 110, 122)])
            .with_radii([Radius::new_ui_points(0.9)]);
        out.always(LASER, &look)
    }

    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        let scan = step.frame.laser();
        if let Some(scan) = scan {
            out.log(LASER, &transform(scan.map_from_laser()))?;
        }
        out.log(LASER, &Points3D::update_fields().with_positions(thin(scan)))
    }
}

fn thin(scan: Option<&LaserScan>) -> Vec<[f32; 3]> {
    let points = scan.map_or(&[][..], LaserScan::points);
    points.iter().step_by(points.len().div_ceil(KEPT_POINTS).max(1)).copied().collect()
}
