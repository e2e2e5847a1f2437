//! Colours of safety labels in files and recordings: blue, orange and grey stay apart for the colour-blind
//! (Okabe and Ito).

use evigrid_grid::SafetyLabel;

/// Red, green and blue of a cell.
pub fn label_rgb(label: SafetyLabel) -> [u8; 3] {
    match label {
        SafetyLabel::Level => [0, 114, 178],
        SafetyLabel::Inclined => [86, 180, 233],
        SafetyLabel::NonGround => [230, 130, 0],
        SafetyLabel::Unknown => [112, 116, 124],
        SafetyLabel::Unexamined => [24, 26, 30],
    }
}

/// Red, green and blue of an occupied voxel, by the label of its column. Over safe ground it is nearly white: it
/// is too high to matter to the robot.
pub fn voxel_rgb(label: SafetyLabel) -> [u8; 3] {
    match label.is_safe() {
        Some(true) => [214, 216, 220],
        _ => label_rgb(label),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn colours_are_distinct() {
        for (number, label) in SafetyLabel::ALL.into_iter().enumerate() {
            let before = &SafetyLabel::ALL[..number];
            assert!(before.iter().all(|other| label_rgb(*other) != label_rgb(label)), "{label:?}");
            assert_ne!(label_rgb(label), voxel_rgb(SafetyLabel::Level));
        }
    }
}
