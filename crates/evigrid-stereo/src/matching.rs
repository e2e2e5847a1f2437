use evigrid_core::{CostVolume, Disparity, Matches, NO_COST};

use crate::StereoError;

/// What matching one pair gives.
#[derive(Debug, Clone)]
pub struct Matching {
    /// Winner, peak ratio and left-right difference of every pixel.
    pub matches: Matches,
    /// The whole cost volume, where it was asked for.
    pub volume: Option<CostVolume>,
}

/// Size of a pair and its hypotheses.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(crate) struct Shape {
    pub width: usize,
    pub height: usize,
    pub min_disparity: usize,
    pub disparities: usize,
}

impl Shape {
    /// Length of a row of the volume.
    pub fn volume_row_len(&self) -> usize {
        self.disparities * self.width
    }
}

/// A matching under construction, as plain buffers. What an earlier frame left in them is still there.
pub(crate) struct Buffers {
    pub disparity: Vec<f32>,
    pub peak_ratio: Vec<f32>,
    pub left_right: Vec<u16>,
    pub volume: Option<Vec<u16>>,
}

impl Buffers {
    /// Buffers for a pair of this shape, those of `recycled` where there are any.
    pub fn new(shape: Shape, keep_volume: bool, recycled: Option<Matching>) -> Self {
        let (mut out, volume) = match recycled {
            Some(Matching { matches, volume }) => (
                Self {
                    disparity: matches.disparity.into_values(),
                    peak_ratio: matches.peak_ratio,
                    left_right: matches.left_right_difference_px,
                    volume: None,
                },
                volume.map(CostVolume::into_costs),
            ),
            None => (Self { disparity: vec![], peak_ratio: vec![], left_right: vec![], volume: None }, None),
        };
        let pixels = shape.width * shape.height;
        out.disparity.resize(pixels, f32::NAN);
        out.peak_ratio.resize(pixels, f32::NAN);
        out.left_right.resize(pixels, u16::MAX);
        if keep_volume {
            let mut costs = volume.unwrap_or_default();
            costs.resize(shape.height * shape.volume_row_len(), NO_COST);
            out.volume = Some(costs);
        }
        out
    }

    /// The finished matching.
    pub fn into_matching(self, shape: Shape) -> Result<Matching, StereoError> {
        let Shape { width, height, min_disparity, disparities } = shape;
        let volume = self
            .volume
            .map(|costs| CostVolume::new(width, height, min_disparity, disparities, costs))
            .transpose()?;
        let matches = Matches {
            disparity: Disparity::new(width, height, self.disparity)?,
            peak_ratio: self.peak_ratio,
            left_right_difference_px: self.left_right,
        };
        Ok(Matching { matches, volume })
    }
}
