//! Figures of Perrollaz, Yoder, Negre, Spalanzani and Laugier, "A visibility-based approach for occupancy grid
//! computation in disparity space" (2012), on worlds made after its scenes: its recordings are lost.

mod exact;
mod fig1;
mod udisparity;

use crate::{Group, Items};

/// The group of this paper. (Fig. 4 is a photograph of the car.)
pub const GROUP: Group = Group {
    name: "perrollaz",
    items: Items::Listed(&[
        ("fig1a", fig1::make_a),
        ("fig1b", fig1::make_b),
        ("udisparity", udisparity::make),
    ]),
};
