//! Table I as it is published.

/// A row of the published table.
#[derive(Debug, Clone, Copy)]
pub struct Published {
    pub transfers: u64,
    pub used_pixels: u64,
    pub cells_drawn: u64,
    pub different_cells: u64,
    pub ms: f64,
}

const fn row(transfers: u64, used_pixels: u64, cells_drawn: u64, different_cells: u64, ms: f64) -> Published {
    Published { transfers, used_pixels, cells_drawn, different_cells, ms }
}

/// By cell size, line, line-pyramid, ray, ray-pyramid.
pub const PUBLISHED: [[Published; 4]; 3] = [
    [
        row(194_048, 194_047, 2_002_640, 943, 207.0),
        row(653, 652, 5_487, 921, 0.62),
        row(11_405, 7_939_260, 11_400, 11_400, 50.0),
        row(11_405, 13_752, 11_400, 11_400, 6.09),
    ],
    [
        row(194_048, 194_047, 4_013_218, 5_287, 352.0),
        row(1_710, 1_709, 27_942, 4_739, 2.5),
        row(86_405, 62_875_230, 86_400, 86_400, 395.0),
        row(86_405, 106_172, 86_400, 86_400, 44.8),
    ],
    [
        row(194_048, 194_047, 7_832_833, 32_985, 632.0),
        row(5_392, 5_391, 189_446, 31_946, 15.9),
        row(674_505, 505_599_749, 674_500, 674_500, 3171.0),
        row(674_505, 861_312, 674_500, 674_500, 346.0),
    ],
];
