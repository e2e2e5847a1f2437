//! Numbers that the paper prints.

/// A column of Table II: the decrement, then mean and deviation of the rates over five data sets, percent.
pub struct Column {
    /// decr.
    pub decrement: i32,
    /// False negatives.
    pub false_negative: [f64; 2],
    /// False positives.
    pub false_positive: [f64; 2],
}

/// Table II. (Its rates of true positives and negatives are 100 % less these.)
pub const TABLE_2: [Column; 3] = [
    Column { decrement: 1, false_negative: [3.0, 1.8], false_positive: [9.3, 4.7] },
    Column { decrement: 3, false_negative: [8.5, 5.3], false_positive: [6.2, 3.7] },
    Column { decrement: 5, false_negative: [11.2, 7.3], false_positive: [5.2, 2.4] },
];

/// Section VII-B: half of a board, textured or not, is in the grid within so many frames ...
pub const LATENCY_FRAMES: usize = 8;
/// ... from so many metres and nearer.
pub const LATENCY_WITHIN_M: f64 = 5.0;
/// Section VII-B: between these distances, metres, the frames to 90 % of a board jump.
pub const LATENCY_JUMP_M: [f64; 2] = [4.0, 5.0];

/// Section VII-D, milliseconds per frame: the model; segmentation, planes and safety together.
pub const MODEL_MS: f64 = 92.0;
pub const LABELS_MS: f64 = 4.0 + 61.0 + 71.0;

/// Section VII-C: mean and deviation of the angle in degrees and of the distance in centimetres of all safe planes.
pub const PLANES: [[f64; 2]; 2] = [[1.2, 0.5], [1.9, 0.8]];
