/// Google's Turbo (Mikhailov 2019) in its published polynomial approximation, for 0..1: from blue over green
/// to red.
pub fn turbo(t: f32) -> [u8; 3] {
    const RED: [f32; 6] = [0.135_721_4, 4.615_392_6, -42.660_32, 132.131_08, -152.942_4, 59.286_38];
    const GREEN: [f32; 6] = [0.091_402_6, 2.194_188_4, 4.842_967, -14.185_033, 4.277_298_6, 2.829_566_2];
    const BLUE: [f32; 6] = [0.106_673_3, 12.641_946, -60.582_05, 110.362_77, -89.903_11, 27.348_25];
    [RED, GREEN, BLUE].map(|coefficients| {
        let value = coefficients.iter().rev().fold(0.0, |sum, c| sum * t + c);
        (value.clamp(0.0, 1.0) * 255.0).round() as u8
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn low_is_blue_and_high_is_red() {
        let [low, middle, high] = [0.1, 0.5, 0.9].map(turbo);
        assert!(low[2] > low[0] && middle[1] > middle[0] && high[0] > high[2], "{low:?} {middle:?} {high:?}");
    }
}
