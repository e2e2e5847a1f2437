//! Numbers of a world description that are checked while they are read, so that the parser can name the line.

use nalgebra::Vector3;
use serde::Deserialize;

/// Declares a number type that refuses values outside `$range`.
macro_rules! checked_number {
    ($(#[$doc:meta])* $name:ident, $inner:ty, $type_name:literal, $range:expr, $expected:literal) => {
        $(#[$doc])*
        #[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
        #[serde(try_from = $type_name)]
        pub struct $name(pub $inner);

        impl TryFrom<$inner> for $name {
            type Error = String;

            fn try_from(value: $inner) -> Result<Self, String> {
                if ($range).contains(&value) {
                    return Ok(Self(value));
                }
                Err(format!("expected {}, found {value}", $expected))
            }
        }
    };
}

checked_number!(
    /// A coordinate or an angle in degrees.
    #[derive(Default)]
    Finite, f64, "f64", -1e6..=1e6, "a number from -1e6 to 1e6"
);
checked_number!(
    /// A length, rate or factor that cannot be zero.
    Positive, f64, "f64", 1e-6..=1e6, "a positive number (1e-6 to 1e6)"
);
checked_number!(
    /// A spread or a strength.
    #[derive(Default)]
    NonNegative, f64, "f64", 0.0..=1e6, "a number from 0 to 1e6"
);
checked_number!(
    /// A share of a whole.
    #[derive(Default)]
    Share, f64, "f64", 0.0..=1.0, "a number from 0 to 1"
);
checked_number!(
    /// A grey level in full light.
    Grey, f64, "f64", 0.0..=255.0, "a grey level from 0 to 255"
);
checked_number!(
    /// How many of something there are.
    Count, u32, "u32", 1..=1_000_000, "a whole number from 1 to 1000000"
);
checked_number!(
    /// How many octaves a fractal noise has.
    Octaves, u32, "u32", 1..=16, "a whole number from 1 to 16"
);

impl Count {
    /// The number as a length.
    pub fn get(self) -> usize {
        self.0 as usize
    }
}

/// A triple of numbers as a vector.
pub fn vector(triple: [Finite; 3]) -> Vector3<f64> {
    Vector3::from(triple.map(|v| v.0))
}
