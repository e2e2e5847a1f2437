use anyhow::Result;
use evigrid_core::Pose;
use evigrid_eval::Step;
use rerun::components::Radius;
use rerun::{Color, LineStrips3D};

use crate::part::{Out, Part};

/// Where the camera has been.
pub(crate) const TRAJECTORY: &str = "world/trajectory";

/// Positions of one strip. Each strip is an entity of its own, so that a frame costs the same however long
/// the way is.
const STRIP: usize = 64;

/// The way of the left camera.
#[derive(Debug, Default)]
pub(crate) struct TrajectoryPart {
    strip: Vec<[f32; 3]>,
    strips: usize,
}

impl Part for TrajectoryPart {
    fn frame(&mut self, out: &mut Out<'_>, step: &Step<'_>) -> Result<()> {
        self.push(step.frame.map_from_left());
        let strip = LineStrips3D::new([self.strip.clone()])
            .with_colors([Color::from_rgb(255, 255, 255)])
            .with_radii([Radius::new_ui_points(1.5)]);
        out.log(format!("{TRAJECTORY}/{}", self.strips), &strip)
    }
}

impl TrajectoryPart {
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
        let mut writer = TrajectoryPart::default();
        for x in 0..=STRIP {
            writer.push(&Pose::translation(x as f64, 0.0, 0.0));
        }
        assert_eq!(writer.strips, 1);
        let last = (STRIP - 1) as f32;
        assert_eq!(writer.strip, [[last, 0.0, 0.0], [last + 1.0, 0.0, 0.0]]);
    }
}
