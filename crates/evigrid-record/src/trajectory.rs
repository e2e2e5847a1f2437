use std::io::Write;

use anyhow::Result;
use evigrid_core::Pose;
use rerun::components::Radius;
use rerun::{Color, LineStrips3D, TimePoint};

use crate::rrd::{Rrd, Store};

/// Where the camera has been.
pub(crate) const TRAJECTORY: &str = "world/trajectory";

/// Positions of one strip. Each strip is an entity of its own, so that a frame costs the same however long the way is.
const STRIP: usize = 64;

/// Writes the way of the left camera.
#[derive(Debug, Default)]
pub(crate) struct TrajectoryWriter {
    strip: Vec<[f32; 3]>,
    strips: usize,
}

impl TrajectoryWriter {
    pub fn frame<W: Write>(
        &mut self,
        rrd: &mut Rrd<W>,
        store: &mut Store,
        at: &TimePoint,
        map_from_left: &Pose,
    ) -> Result<()> {
        self.push(map_from_left);
        let strip = LineStrips3D::new([self.strip.clone()])
            .with_colors([Color::from_rgb(255, 255, 255)])
            .with_radii([Radius::new_ui_points(1.5)]);
        rrd.log(store, format!("{TRAJECTORY}/{}", self.strips), at, &strip)
    }

    fn push(&mut self, map_from_left: &Pose) {
        if self.strip.len() >= STRIP {
            // The next strip begins where this one ends.
            self.strip.drain(..STRIP - 1);
            self.strips += 1;
        }
        let position: [f64; 3] = map_from_left.translation.vector.into();
        self.strip.push(position.map(|v| v as f32));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_join() {
        let mut writer = TrajectoryWriter::default();
        for x in 0..=STRIP {
            writer.push(&Pose::translation(x as f64, 0.0, 0.0));
        }
        assert_eq!(writer.strips, 1);
        let last = (STRIP - 1) as f32;
        assert_eq!(writer.strip, [[last, 0.0, 0.0], [last + 1.0, 0.0, 0.0]]);
    }
}
