//! Figures of Perrollaz, Yoder, Negre, Spalanzani and Laugier, "A visibility-based approach for occupancy grid
//! computation in disparity space" (2012), on worlds made after its scenes: its recordings are lost.

mod classes;
mod exact;
mod fig1;
mod fig2;
mod fig3;
mod fig5;
mod fig7;
mod objects;
mod panels;
mod scene;
mod timing;
mod udisparity;

use crate::{Group, Items};

/// The group of this paper. (Fig. 4 is a photograph of the car.)
pub const GROUP: Group = Group {
    name: "perrollaz",
    items: Items::Listed(&[
        ("fig1a", fig1::make_a),
        ("fig1b", fig1::make_b),
        ("fig2", fig2::make),
        ("fig3", fig3::make_3),
        ("fig5", fig5::make),
        ("fig6", fig3::make_6),
        ("fig7", fig7::make),
        ("fig8", fig3::make_8),
        ("classes", classes::make),
        ("objects", objects::make),
        ("udisparity", udisparity::make),
        ("timing", timing::make),
    ]),
};
