use evigrid_core::{CostVolume, Mounting, RoadSplit, View};

use crate::{HybridModel, Layer};

/// Why a frame could not be mapped. Callers add which frame and which method.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MapError {
    /// A view that lacks what the method needs.
    #[error("expected {0}, found none")]
    Lacks(&'static str),
    /// A view that the method cannot map.
    #[error("{what}: expected {expected}, found {found}")]
    View {
        /// The part of the view.
        what: &'static str,
        /// A value that could be mapped.
        expected: &'static str,
        /// The value that is there.
        found: String,
    },
}

impl MapError {
    /// The cost volume of a view.
    ///
    /// # Errors
    /// If it has none.
    pub fn volume<'a>(view: &View<'a>) -> Result<&'a CostVolume, Self> {
        view.volume.ok_or(Self::Lacks("matching costs"))
    }

    /// The road and the obstacles of a view.
    ///
    /// # Errors
    /// If they are not told apart.
    pub fn road<'a>(view: &View<'a>) -> Result<&'a RoadSplit, Self> {
        view.road.ok_or(Self::Lacks("road and obstacles apart"))
    }

    /// How the camera of a view stands over the ground.
    ///
    /// # Errors
    /// If nobody tells.
    pub fn mounting(view: &View<'_>) -> Result<Mounting, Self> {
        view.mounting.ok_or(Self::Lacks("the mounting of the camera over the ground"))
    }
}

/// A picture of what a method has made of the last frame on the way to its map.
#[derive(Debug, Clone, PartialEq)]
pub struct Picture {
    /// What it shows.
    pub name: &'static str,
    /// Width, pixels.
    pub width: usize,
    /// Height, pixels.
    pub height: usize,
    /// Row by row: shares in 255ths.
    pub shares: Vec<u8>,
}

/// What a method says of the pixels of the left image, row by row.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum PixelLabel {
    /// Nothing.
    Unknown,
    /// The ground there is free.
    Free,
    /// Something stands there.
    Occupied,
}

/// Pictures of the last frame, and what the method says of the pixels of the left image (empty: nothing).
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Pictures {
    /// The pictures, in the order in which they are made.
    pub list: Vec<Picture>,
    /// One entry per pixel of the left image, row by row; or none at all.
    pub labels: Vec<PixelLabel>,
}

/// A map in the making: integrates the evidence of one frame after the other and shows its layers.
pub trait Mapper: Send + Sync {
    /// Integrates one frame.
    ///
    /// # Errors
    /// If the frame cannot be mapped; the map is then as it was before. A mapper never returns `Ok` without
    /// having mapped.
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError>;

    /// The layers so far: those that the method declares, in that order.
    fn layers(&self) -> Vec<Layer<'_>>;

    /// The 3-D model behind the safety map so far, made when it is asked for. By default there is none.
    fn hybrid_model(&self) -> Option<HybridModel> {
        None
    }

    /// What the method has made of the last frame on the way to its map, made when it is asked for. By default there
    /// is nothing.
    fn pictures(&self) -> Pictures {
        Pictures::default()
    }
}

/// Maps of one method under several settings, built together because a frame is cheaper for all of them at
/// once than for each by itself. Every map is the same to the last bit as that of a [`Mapper`] of its
/// settings.
pub trait MapperFamily: Send + Sync {
    /// Integrates one frame into all maps.
    ///
    /// # Errors
    /// As [`Mapper::integrate`].
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError>;

    /// The layers of one of the maps so far, by its position in the settings the family was built from.
    fn layers(&self, member: usize) -> Vec<Layer<'_>>;

    /// As [`Mapper::hybrid_model`], of one of the maps.
    fn hybrid_model(&self, _member: usize) -> Option<HybridModel> {
        None
    }

    /// As [`Mapper::pictures`], of one of the maps.
    fn pictures(&self, _member: usize) -> Pictures {
        Pictures::default()
    }
}

/// A family of one.
impl MapperFamily for Box<dyn Mapper> {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        self.as_mut().integrate(view)
    }

    fn layers(&self, _: usize) -> Vec<Layer<'_>> {
        self.as_ref().layers()
    }

    fn hybrid_model(&self, _: usize) -> Option<HybridModel> {
        self.as_ref().hybrid_model()
    }

    fn pictures(&self, _: usize) -> Pictures {
        self.as_ref().pictures()
    }
}
