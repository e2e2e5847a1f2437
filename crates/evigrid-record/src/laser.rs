use std::io::Write;

use anyhow::Result;
use evigrid_core::LaserScan;
use rerun::components::Radius;
use rerun::{Color, Points3D, TimePoint};

use crate::camera::transform;
use crate::rrd::{Rrd, Store};

/// The latest laser scan.
pub(crate) const LASER: &str = "world/laser";

/// Points of a scan that are kept: enough to see what is there, few enough to keep the file small.
const KEPT_POINTS: usize = 6000;

/// Writes a thinned scan, in the laser's own frame below its pose; a frame without a scan shows none.
pub(crate) fn write_scan<W: Write>(
    rrd: &mut Rrd<W>,
    store: &mut Store,
    at: &TimePoint,
    scan: Option<&LaserScan>,
) -> Result<()> {
    if let Some(scan) = scan {
        rrd.log(store, LASER, at, &transform(scan.map_from_laser()))?;
    }
    rrd.log(store, LASER, at, &Points3D::update_fields().with_positions(thin(scan)))
}

/// What holds at all times: small grey points.
pub(crate) fn begin<W: Write>(rrd: &mut Rrd<W>, store: &mut Store) -> Result<()> {
    let look = Points3D::update_fields()
        .with_colors([Color::from_rgb(104, 110, 122)])
        .with_radii([Radius::new_ui_points(0.9)]);
    rrd.log(store, LASER, &TimePoint::default(), &look)
}

fn thin(scan: Option<&LaserScan>) -> Vec<[f32; 3]> {
    let points = scan.map_or(&[][..], LaserScan::points);
    points.iter().step_by(points.len().div_ceil(KEPT_POINTS).max(1)).copied().collect()
}
