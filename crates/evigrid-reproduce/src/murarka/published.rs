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

/// Section VII-C: mean and deviation of the angle in degrees and of the distance in centimetres of all safe planes.
pub const PLANES: [[f64; 2]; 2] = [[1.2, 0.5], [1.9, 0.8]];
