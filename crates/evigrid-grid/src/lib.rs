//! Voxel grids: geometry, ray walks, log-odds and their fusion, the three-way belief of a map, and the interface of
//! every mapping method.

mod evidence;
mod fast_logit;
mod log_odds;
mod mapper;
mod nested;
mod ray_batch;
mod ray_walk;
mod spec;
mod view_rays;

pub use evidence::FrameEvidence;
pub use fast_logit::{LOG_ODDS_ERROR, bounded_logit};
pub use log_odds::{Belief, Clamp, LogOddsGrid, logit, probability};
pub use mapper::{Mapper, MapperFamily, View};
pub use nested::{NestedEvidence, NestedMaps};
pub use ray_batch::RayBatch;
pub use ray_walk::RayWalk;
pub use spec::{GridError, GridSettings, GridSpec, cell_index};
pub use view_rays::ViewRays;
