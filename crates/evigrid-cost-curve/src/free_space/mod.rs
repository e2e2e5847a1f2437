//! The free space of one frame, found cell by cell instead of ray by ray: of every cell it is asked whether
//! some ray crosses it that is simply free up to there.

mod free_cells;
mod projection;
mod reach;
mod silhouette;

pub(crate) use free_cells::draw_free_space;
pub(crate) use projection::{CellProjection, crosses, pixel_at};
pub(crate) use reach::{NO_REACH, ReachImage, TILE};
pub(crate) use silhouette::Silhouette;
