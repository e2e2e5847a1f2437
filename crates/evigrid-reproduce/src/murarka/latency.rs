//! Frame latency: how many frames go by before a board is detected, and what the paper claims of it.

use super::published::{LATENCY_FRAMES, LATENCY_JUMP_M, LATENCY_WITHIN_M};

/// The shares of a board's width whose latency is counted.
pub const SHARES: [f64; 2] = [0.5, 0.9];

/// A board being detected.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Detection {
    /// Frames that the method has used since the board appeared, the first and this one counted.
    pub frames: usize,
    /// From the camera to the board's face, along the way, metres.
    pub distance_m: f64,
}

/// The way of the robot towards one board, with one map.
#[derive(Debug, Clone, Copy, Default)]
pub struct Approach {
    /// Distance at the first frame, metres.
    pub start_m: f64,
    /// Frames used.
    pub frames: usize,
    /// When each of [`SHARES`] was in the grid for the first time.
    pub detected: [Option<Detection>; 2],
    /// The share in the grid after the last frame.
    pub share: f64,
}

impl Approach {
    /// Adds a frame that the method has used, after which this share of the width is in the grid.
    pub fn add(&mut self, distance_m: f64, share: f64) {
        if self.frames == 0 {
            self.start_m = distance_m;
        }
        self.frames += 1;
        self.share = share;
        let now = Detection { frames: self.frames, distance_m };
        for (detected, wanted) in self.detected.iter_mut().zip(SHARES) {
            // Sums of parts of the width are whole shares only up to rounding.
            if detected.is_none() && share >= wanted - 1e-9 {
                *detected = Some(now);
            }
        }
    }

    /// Frames to one of the shares; `None` if it was never in the grid.
    pub fn frames_to(&self, share: usize) -> Option<usize> {
        self.detected[share].map(|detection| detection.frames)
    }
}

/// A claim of section VII-B, and what is found.
#[derive(Debug, Clone, PartialEq)]
pub struct Claim {
    pub text: String,
    /// The number that decides; `None`: there is none, and that decides.
    pub ours: Option<f64>,
    pub is_met: bool,
}

/// The claims of section VII-B about one matcher; approaches of both boards, those of one by rising distance.
pub fn claims(textured: &[Approach], plain: &[Approach]) -> Vec<Claim> {
    let (within, limit) = (LATENCY_WITHIN_M, LATENCY_FRAMES);
    let near = |a: &&Approach| a.start_m <= within + 0.01;
    let soon = |name: &str, boards: &[Approach]| {
        let found: Option<Vec<usize>> = boards.iter().filter(near).map(|a| a.frames_to(0)).collect();
        let most = found.and_then(|frames| frames.into_iter().max());
        Claim {
            text: format!("{name} board: 50 % within {limit} frames from {within} m and nearer"),
            ours: most.map(|frames| frames as f64),
            is_met: most.is_some_and(|frames| frames <= limit),
        }
    };
    let seen_whole = plain.iter().filter(|a| a.detected[1].is_some()).count();
    vec![
        soon("textured", textured),
        soon("untextured", plain),
        jump(textured),
        Claim {
            text: "untextured board: approaches that bring 90 % into the grid before contact: none".into(),
            ours: Some(seen_whole as f64),
            is_met: seen_whole == 0,
        },
    ]
}

/// Whether the frames to 90 % rise most between the two distances that the paper names.
fn jump(approaches: &[Approach]) -> Claim {
    let [from, to] = LATENCY_JUMP_M;
    let rise = |pair: &[Approach]| match [pair[0].frames_to(1), pair[1].frames_to(1)] {
        [Some(near), Some(far)] => Some(far as f64 - near as f64),
        // Found from nearer only: a jump that is larger than all numbers.
        [Some(_), None] => Some(f64::INFINITY),
        [None, _] => None,
    };
    let is_named = |pair: &[Approach]| (pair[0].start_m - from).abs() + (pair[1].start_m - to).abs() < 0.02;
    let named = approaches.windows(2).filter(|pair| is_named(pair)).find_map(rise);
    let others = approaches.windows(2).filter(|pair| !is_named(pair)).filter_map(rise);
    let most = others.fold(f64::NEG_INFINITY, f64::max);
    Claim {
        text: format!("textured board: frames to 90 % rise most from {from} to {to} m (by)"),
        ours: named,
        is_met: named.is_some_and(|rise| rise > 0.0 && rise > most),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn approach(start_m: f64, frames: [Option<usize>; 2]) -> Approach {
        let detected = frames.map(|f| f.map(|frames| Detection { frames, distance_m: 1.0 }));
        Approach { start_m, frames: 30, detected, share: 1.0 }
    }

    #[test]
    fn frames_count_from_the_first_and_detections_stay() {
        let mut approach = Approach::default();
        for (distance_m, share) in [(3.0, 0.0), (2.9, 0.5), (2.8, 0.3), (2.7, 0.95), (2.6, 0.9)] {
            approach.add(distance_m, share);
        }
        assert_eq!((approach.start_m, approach.frames, approach.share), (3.0, 5, 0.9));
        assert_eq!(approach.detected[0], Some(Detection { frames: 2, distance_m: 2.9 }));
        assert_eq!(approach.detected[1], Some(Detection { frames: 4, distance_m: 2.7 }));
        let mut never = Approach::default();
        never.add(2.0, 0.49);
        assert_eq!([0, 1].map(|n| never.frames_to(n)), [None; 2]);
    }

    fn met(textured: &[Approach], plain: &[Approach]) -> Vec<bool> {
        claims(textured, plain).iter().map(|claim| claim.is_met).collect()
    }

    #[test]
    fn the_papers_own_curves_meet_its_claims() {
        let textured = [
            approach(3.0, [Some(5), Some(6)]),
            approach(4.0, [Some(6), Some(8)]),
            approach(5.0, [Some(8), Some(40)]),
            approach(6.0, [Some(30), Some(45)]),
        ];
        let plain = textured.map(|a| approach(a.start_m, [a.frames_to(0), None]));
        assert_eq!(met(&textured, &plain), [true; 4]);
    }

    #[test]
    fn each_claim_can_fail() {
        let textured = [
            approach(3.0, [Some(5), Some(6)]),
            approach(4.0, [Some(6), Some(20)]),
            approach(5.0, [Some(9), Some(22)]),
        ];
        let plain = [approach(3.0, [Some(5), Some(20)]), approach(5.0, [None, None])];
        assert_eq!(met(&textured, &plain), [false; 4]);
        let found: Vec<Option<f64>> = claims(&textured, &plain).iter().map(|claim| claim.ours).collect();
        assert_eq!(found, [Some(9.0), None, Some(2.0), Some(1.0)]);
    }

    #[test]
    fn a_board_that_is_found_from_nearer_only_is_a_jump() {
        let line = [approach(4.0, [Some(5), Some(9)]), approach(5.0, [Some(5), None])];
        assert_eq!((jump(&line).ours, jump(&line).is_met), (Some(f64::INFINITY), true));
    }
}
