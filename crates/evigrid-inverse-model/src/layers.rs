//! The layer of a pyramid that a disparity is drawn from (Andert 2009, eqs 12 and 13).

/// Layers a pyramid may have below and above the image itself.
pub const LAYERS: std::ops::RangeInclusive<i32> = -4..=30;

/// Table of the layer for every disparity (Andert 2009, eq. 13): layer i is used for d in
/// [b 2^i / c, b 2^{i+1} / c), whatever the focal length.
#[derive(Debug, Clone, PartialEq)]
pub struct LayerTable {
    /// First disparity of every layer of [`LAYERS`], pixels.
    edges: Vec<f64>,
}

impl LayerTable {
    /// The table of a baseline and a cell size, both in metres.
    pub fn new(baseline_m: f64, cell_size_m: f64) -> Self {
        Self { edges: LAYERS.map(|i| baseline_m * f64::from(i).exp2() / cell_size_m).collect() }
    }

    /// The first disparity of a layer of [`LAYERS`], pixels: from there on dp = z 2^i / f is at most c.
    pub fn edge_px(&self, layer: i32) -> f64 {
        let place = (layer - LAYERS.start()).clamp(0, self.edges.len() as i32 - 1);
        self.edges[place as usize]
    }

    /// The layer whose dp is within (c/2, c], or the nearest of [`LAYERS`].
    pub fn layer(&self, disparity_px: f64) -> i32 {
        let above = self.edges.partition_point(|&edge| edge <= disparity_px) as i32;
        LAYERS.start() + (above - 1).max(0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_layers_of_figure_3() {
        // c = 0.5, b = 0.3: edges 0.6 * 2^i.
        let table = LayerTable::new(0.3, 0.5);
        for (i, edge) in (0..7).zip([0.6, 1.2, 2.4, 4.8, 9.6, 19.2, 38.4]) {
            assert!((table.edge_px(i) - edge).abs() < 1e-12);
            assert_eq!((table.layer(edge * 0.999_999), table.layer(edge * 1.000_001)), (i - 1, i));
        }
        // 6 to 25 m, where b f = 210.
        assert_eq!([6.0, 25.0].map(|z| table.layer(210.0 / z)), [5, 3]);
        assert_eq!((table.layer(0.0), table.layer(1e12)), (*LAYERS.start(), *LAYERS.end()));
    }

    #[test]
    fn the_table_is_equation_13() {
        for (b, c, f) in [(0.3, 0.25, 700.0), (0.537, 0.2, 721.5), (0.1, 1.0, 300.0)] {
            let table = LayerTable::new(b, c);
            for n in 12..5000 {
                let d = 0.03 * f64::from(n);
                let dp = b * f / d * f64::from(table.layer(d)).exp2() / f;
                assert!(dp > 0.5 * c * (1.0 - 1e-12) && dp <= c * (1.0 + 1e-12), "{d}: {dp}");
            }
        }
    }
}
