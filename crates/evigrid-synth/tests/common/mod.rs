//! The small world of the tests, as a sequence of frames.

use evigrid_core::{Frame, Pose};
use evigrid_replay::Sequence;
use evigrid_synth::{SyntheticSequence, World};

pub const BOX: &str = include_str!("../box.toml");

/// The sequence of a world's text.
pub fn sequence(text: &str) -> SyntheticSequence {
    SyntheticSequence::new(World::from_toml(text).unwrap())
}

/// A frame in the world's own frame.
pub fn frame(sequence: &SyntheticSequence, index: usize) -> Frame {
    sequence.frame(index, &Pose::identity()).unwrap()
}
