//! Tables and figures of Murarka and Kuipers, "A Stereo Vision Based Mapping Algorithm for Detecting Inclines,
//! Drop-offs, and Obstacles for Safe Local Navigation" (2009), on worlds made after its descriptions: its own
//! recordings are lost.

mod board;
mod cut;
mod drive;
mod fig2;
mod fig3;
mod fig4;
mod fig6a;
mod fig6b;
mod fig7;
mod fig8;
mod hazards;
mod journeys;
mod latency;
pub mod mapping;
mod places;
mod plan_view;
mod planes;
mod published;
mod runs;
mod shift;
mod steps;
mod table2;
mod timing;
mod worlds;

use crate::{Group, Items};

/// The group of this paper.
pub const GROUP: Group = Group {
    name: "murarka",
    items: Items::Listed(&[
        ("fig2", fig2::make),
        ("fig3", fig3::make),
        ("fig4", fig4::make),
        ("table2", table2::make),
        ("fig6a", fig6a::make),
        ("fig6b", fig6b::make),
        ("hazards", hazards::make),
        ("places", places::make),
        ("steps", steps::make),
        ("shift", shift::make),
        // After the items whose pass gives them their maps.
        ("planes", planes::make),
        ("fig7", fig7::make),
        ("fig8", fig8::make),
        ("timing", timing::make),
    ]),
};
