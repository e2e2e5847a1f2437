use crate::CoreError;
use crate::error::require_length;

/// The cost of a hypothesis that could not be measured: its window does not fit into both images.
pub const NO_COST: u16 = u16::MAX;

/// The unit of the numbers in a cost volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CostScale {
    /// Pixels over which pixel costs are summed.
    pub window_pixels: f64,
    /// Units of the pixel cost (grey levels, unless images are filtered or the pixel cost is another) per
    /// unit of the volume.
    pub grey_levels: f64,
}

impl CostScale {
    /// Grey levels summed over a square window `edge_px` pixels wide and stored divided by 2^`shift`.
    pub fn of_square(edge_px: usize, shift: u32) -> Self {
        Self { window_pixels: (edge_px * edge_px) as f64, grey_levels: f64::from(1_u32 << shift) }
    }

    /// Edge of the square window, whole pixels, at least 1.
    pub fn window_edge_px(&self) -> usize {
        (self.window_pixels.sqrt().round() as usize).max(1)
    }
}

/// The matching cost of every disparity hypothesis of every pixel of the left image.
///
/// Laid out `[row][disparity][column]`: the costs of one hypothesis along one row are contiguous, which is
/// the order in which they are computed and searched. [`NO_COST`] marks hypotheses without a cost.
#[derive(Debug, Clone, PartialEq)]
pub struct CostVolume {
    width: usize,
    height: usize,
    min_disparity: usize,
    disparities: usize,
    scale: CostScale,
    costs: Vec<u16>,
}

impl CostVolume {
    /// A volume of `height` x `disparities` x `width` costs for the hypotheses
    /// `min_disparity .. min_disparity + disparities` (whole pixels), in units of `scale`.
    ///
    /// # Errors
    /// If a dimension is zero or the length does not fit.
    pub fn new(
        width: usize,
        height: usize,
        min_disparity: usize,
        disparities: usize,
        scale: CostScale,
        costs: Vec<u16>,
    ) -> Result<Self, CoreError> {
        require_length("cost volume", &[height, disparities, width], costs.len())?;
        Ok(Self { width, height, min_disparity, disparities, scale, costs })
    }

    /// Width of the left image, pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height of the left image, pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// The smallest hypothesis, pixels.
    pub fn min_disparity(&self) -> usize {
        self.min_disparity
    }

    /// The number of hypotheses.
    pub fn disparities(&self) -> usize {
        self.disparities
    }

    /// The unit of the costs.
    pub fn scale(&self) -> CostScale {
        self.scale
    }

    /// The costs of row `y`, `[disparity][column]`.
    pub fn row(&self, y: usize) -> &[u16] {
        let slab = self.disparities * self.width;
        &self.costs[y * slab..(y + 1) * slab]
    }

    /// The cost of hypothesis `min_disparity + index` at pixel (x, y).
    pub fn cost(&self, x: usize, y: usize, index: usize) -> u16 {
        self.row(y)[index * self.width + x]
    }

    /// The cost curve of pixel (x, y): one cost per hypothesis, from the smallest disparity on.
    pub fn curve(&self, x: usize, y: usize) -> impl Iterator<Item = u16> {
        self.row(y)[x..].iter().step_by(self.width).copied()
    }

    /// Gives the buffer back, so that the next frame can fill it.
    pub fn into_costs(self) -> Vec<u16> {
        self.costs
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_curve_of_a_pixel_runs_along_the_hypotheses() {
        // cost = 100 y + 10 d + x
        let costs = (0..2 * 3 * 4).map(|i| (100 * (i / 12) + 10 * (i / 4 % 3) + i % 4) as u16).collect();
        let scale = CostScale { window_pixels: 49.0, grey_levels: 1.0 };
        let volume = CostVolume::new(4, 2, 5, 3, scale, costs).unwrap();
        assert_eq!(volume.curve(2, 1).collect::<Vec<_>>(), [102, 112, 122]);
        assert_eq!(volume.cost(3, 0, 2), 23);
        assert!(CostVolume::new(4, 2, 5, 3, scale, vec![0; 23]).is_err());
        assert_eq!(volume.scale().window_edge_px(), 7);
    }
}
