//! The figures and the table of Andert, "Drawing Stereo Disparity Images into Occupancy Grids: Measurement
//! Model and Fast Implementation" (2009).

mod algorithms;
mod claims;
mod fig1;
mod fig3;
mod fig4;
mod fig5;
mod fig6;
mod fig7;
mod flight;
mod objects;
mod plan;
mod published;
mod scene;
mod table1;
mod timed;

use crate::{Group, Items};

/// The group of this paper, in its order. (Fig. 2 is a sketch, Fig. 8 a photograph.)
pub const GROUP: Group = Group {
    name: "andert",
    items: Items::Listed(&[
        ("fig1", fig1::make),
        ("fig3", fig3::make),
        ("fig4", fig4::make),
        ("fig5", fig5::make),
        ("fig6", fig6::make),
        ("table1", table1::make),
        ("fig7", fig7::make),
    ]),
};
