//! The figures of Souza, Maia, Goncalves, "3D Probabilistic Occupancy Grid to Robotic Mapping with Stereo
//! Vision" (2012), and whether its claim holds. The paper publishes no numbers.

mod contenders;
mod drifting;
mod fig1;
mod fig7;
mod fig9;
mod matchers;
mod matching;
mod motion_error;
mod motion_picture;
mod motion_sweep;
mod robot;

use crate::{Group, Items};

/// The group of this paper. (Figs 2 to 6 and 8 are sketches and photographs.)
pub const GROUP: Group = Group {
    name: "souza",
    items: Items::Listed(&[
        ("fig1", fig1::make),
        ("fig7", fig7::make),
        ("fig9", fig9::make),
        ("motion-error", motion_error::make),
        ("matching", matching::make),
    ]),
};
