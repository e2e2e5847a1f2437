use serde::Deserialize;

use super::area::mix;
use super::interval::Interval;
use crate::noise::{fade, hash, unit};
use crate::number::{Grey, NonNegative, Positive};

/// Bricks or slabs in running bond: every second row is shifted by half a brick. Joints begin at (0, 0).
#[derive(Debug, Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Brick {
    /// From one brick to the next along u (the joint included), metres.
    length_m: Positive,
    /// From one row to the next along v (the joint included), metres.
    height_m: Positive,
    /// Width of the joints, metres.
    joint_m: Positive,
    /// Grey of the joints, 0 to 255 in full light.
    grey: Grey,
    /// The greys of the bricks spread evenly this far up and down from that of the material, grey levels.
    tint: NonNegative,
}

/// The tints of single bricks fade out as the footprint grows from half of this many bricks to this many,
/// along u or v. The mean of four by four tints is a quarter as strong as one.
const TINTED_BRICKS: f64 = 8.0;

impl Brick {
    /// The mean grey over an area of u and v, of a surface that would have grey `base` without the bricks.
    pub fn apply(&self, base: f32, area: [Interval; 2], seed: u32) -> f32 {
        mix(base, self.grey, self.joint_share(area)) + self.tone(area, seed)
    }

    fn shift(&self, row: i64) -> f64 {
        if row & 1 == 0 { 0.0 } else { 0.5 * self.length_m.0 }
    }

    /// The share of an area that is joints. All rows together repeat every row, what tells the odd rows from
    /// the even ones every two rows; either is averaged over one period at most.
    fn joint_share(&self, [u, v]: [Interval; 2]) -> f64 {
        let (length, height, joint) = (self.length_m.0, self.height_m.0, self.joint_m.0);
        let one = v.at_most(height);
        let rows = one.covered(joint, height, height - joint) / one.length();
        let two = v.at_most(2.0 * height);
        let half_rows =
            |row: f64| two.covered(row * height + joint, 2.0 * height, height - joint) / two.length();
        let alternation = half_rows(0.0) - half_rows(1.0);
        let u = u.at_most(length);
        let upright_joints = |row| u.covered(-self.shift(row), length, joint) / u.length();
        let [even, odd] = [upright_joints(0), upright_joints(1)];
        1.0 - rows * (1.0 - 0.5 * (even + odd)) + 0.5 * alternation * (even - odd)
    }

    /// Mean of the tints of the bricks over an area, grey levels.
    fn tone(&self, [u, v]: [Interval; 2], seed: u32) -> f32 {
        let (length, height, joint) = (self.length_m.0, self.height_m.0, self.joint_m.0);
        let bricks = (u.length() / length).max(v.length() / height);
        let weight = self.tint.0 as f32 * fade(TINTED_BRICKS / bricks);
        if weight == 0.0 {
            return 0.0;
        }
        let brick =
            |i: i64, size: f64| Interval::between(i as f64 * size + joint.min(size), (i + 1) as f64 * size);
        let mut sum = 0.0;
        for row in v.cells(height) {
            let across = v.common(brick(row, height)).length();
            let shifted = Interval::around(u.centre() + self.shift(row), u.length());
            for column in shifted.cells(length) {
                let along = shifted.common(brick(column, length)).length();
                sum += along * across * f64::from(unit(hash(column as u32, row as u32, seed)));
            }
        }
        weight * (sum / (u.length() * v.length())) as f32
    }
}
