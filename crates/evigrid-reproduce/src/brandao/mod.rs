//! The figures and the table of Brandao, Ferreira, Hashimoto, Santos-Victor, Takanishi: "Integrating
//! the whole cost-curve of stereo into occupancy grids". Each item becomes ITEM.csv and ITEM.svg, with
//! what the paper says beside ours.

mod bar_maps;
mod bar_picture;
mod bar_score;
mod bars;
mod drive_maps;
mod fig1;
mod fig10;
mod fig2;
mod fig3;
mod fig4;
mod fig5;
mod methods;
mod moments;
mod ray;
mod table1;
mod top_view;

use crate::{Group, Items};

/// The group of this paper, in its order. (Fig. 7 is a photograph and the laser's reference.)
pub const GROUP: Group = Group {
    name: "brandao",
    items: Items::Listed(&[
        ("fig1", fig1::make),
        ("fig2", fig2::make),
        ("fig3", fig3::make),
        ("fig4", fig4::make),
        ("fig5", fig5::whole_curve),
        ("fig6", fig5::winner_take_all),
        ("fig8", drive_maps::fig8),
        ("fig9", drive_maps::fig9),
        ("fig10", fig10::make),
        ("table1", table1::make),
    ]),
};
