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

use crate::Group;
use crate::job::{Make, make_items};

/// All items, in the order of the paper. (Fig. 2 is a sketch, Fig. 8 a photograph.)
const ITEMS: [(&str, Make); 7] = [
    ("fig1", fig1::make),
    ("fig3", fig3::make),
    ("fig4", fig4::make),
    ("fig5", fig5::make),
    ("fig6", fig6::make),
    ("table1", table1::make),
    ("fig7", fig7::make),
];

/// The group of this paper.
pub const GROUP: Group = Group {
    name: "andert",
    items: || ITEMS.iter().map(|(name, _)| *name).collect(),
    make: |item, folders, tools| make_items("andert", &ITEMS, item, folders, tools),
};
