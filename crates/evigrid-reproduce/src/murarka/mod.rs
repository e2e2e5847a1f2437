//! Tables and figures of Murarka and Kuipers, "A Stereo Vision Based Mapping Algorithm for Detecting Inclines,
//! Drop-offs, and Obstacles for Safe Local Navigation" (2009), on worlds made after its descriptions: its own
//! recordings are lost.

mod board;
mod fig6a;
mod fig6b;
mod hazards;
mod latency;
mod mapping;
mod places;
mod published;
mod runs;
mod shift;
mod steps;
mod table2;
mod worlds;

use crate::{Group, Items};

/// The group of this paper.
pub const GROUP: Group = Group {
    name: "murarka",
    items: Items::Listed(&[
        ("table2", table2::make),
        ("fig6a", fig6a::make),
        ("fig6b", fig6b::make),
        ("hazards", hazards::make),
        ("places", places::make),
        ("steps", steps::make),
        ("shift", shift::make),
    ]),
};
