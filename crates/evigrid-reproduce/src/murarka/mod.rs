//! Tables and figures of Murarka and Kuipers, "A Stereo Vision Based Mapping Algorithm for Detecting Inclines,
//! Drop-offs, and Obstacles for Safe Local Navigation" (2009), on worlds made after its descriptions: its own
//! recordings are lost.

mod published;
mod table2;
mod worlds;

use crate::{Group, Items};

/// The group of this paper.
pub const GROUP: Group = Group { name: "murarka", items: Items::Listed(&[("table2", table2::make)]) };
