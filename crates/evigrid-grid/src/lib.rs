//! Grids and the interface of mapping methods: geometry in two and three dimensions, ray walks, log-odds and
//! their fusion, the layers that a method shows, what a method needs, and how a map is asked to grow by a
//! frame.

mod evidence;
mod fast_logit;
mod hybrid;
mod lattice;
mod layer;
mod log_odds;
mod mapper;
mod method;
mod neighbours;
mod plan_grid;
mod plane_fit;
mod project;
mod ray_batch;
mod ray_walk;
pub mod safe_ground;
mod safety_map;
mod view_rays;

pub use evidence::FrameEvidence;
pub use fast_logit::{LOG_ODDS_ERROR, bounded_logit};
pub use hybrid::{HybridModel, Patch, merged_patches, outer_faces, patches};
pub use lattice::{GridError, GridSettings, GridSpec, Lattice, PlanSpec, cell_index};
pub use layer::{Layer, LayerKind};
pub use log_odds::{Clamp, LogOddsGrid, logit, probability};
pub use mapper::{MapError, Mapper, MapperFamily, Picture, Pictures, PixelLabel};
pub use method::{Method, Needs};
pub use plan_grid::{CellVelocity, PlanGrid};
pub use plane_fit::{Moments, Plane};
pub use project::{levels_in_band, projected};
pub use ray_batch::RayBatch;
pub use ray_walk::{RayWalk, WalkAxis};
pub use safety_map::{SafetyLabel, SafetyMap, SafetyPlane};
pub use view_rays::ViewRays;
