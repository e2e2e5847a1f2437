use evigrid_core::{CoreError, CostScale, CostVolume, Disparity, Matches, Matching, NO_COST};

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

/// A matching under construction, as plain buffers. The values of an earlier frame are still in them.
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
            Some(Matching { matches, volume, .. }) => (
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

    /// The finished matches.
    pub fn into_matches(self, shape: Shape) -> Result<Matches, CoreError> {
        Ok(Matches {
            disparity: Disparity::new(shape.width, shape.height, self.disparity)?,
            peak_ratio: self.peak_ratio,
            left_right_difference_px: self.left_right,
        })
    }

    /// The finished matching; costs, where they were kept, are in units of `scale`.
    pub fn into_matching(mut self, shape: Shape, scale: CostScale) -> Result<Matching, CoreError> {
        let Shape { width, height, min_disparity, disparities } = shape;
        let volume = self
            .volume
            .take()
            .map(|costs| CostVolume::new(width, height, min_disparity, disparities, scale, costs))
            .transpose()?;
        Ok(Matching { matches: self.into_matches(shape)?, volume, road: None })
    }
}
