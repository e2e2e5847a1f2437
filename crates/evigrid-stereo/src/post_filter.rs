//! Filters of matches, whatever matcher they come from. A match that is dropped looks as if there had never
//! been one: disparity and peak ratio NaN, left-right difference `u16::MAX`.

use evigrid_core::{CoreError, Disparity, Matches};

/// Drops the matches of the pixels for which `drop` is true.
///
/// # Errors
/// Never for matches of one size.
pub fn drop_matches(matches: Matches, drop: &[bool]) -> Result<Matches, CoreError> {
    let (width, height) = (matches.disparity.width(), matches.disparity.height());
    let Matches { disparity, mut peak_ratio, left_right_difference_px: mut left_right } = matches;
    let mut values = disparity.into_values();
    for i in (0..values.len()).filter(|&i| drop[i]) {
        (values[i], peak_ratio[i], left_right[i]) = (f32::NAN, f32::NAN, u16::MAX);
    }
    let disparity = Disparity::new(width, height, values)?;
    Ok(Matches { disparity, peak_ratio, left_right_difference_px: left_right })
}

/// Finds the pixels of speckles, row-major: those of connected regions of at most `max_pixels` pixels. Two of
/// the four neighbours of a pixel are connected if both have a disparity and these differ by at most
/// `max_step_px`. (The rule of OpenCV's `filterSpeckles`.)
pub fn speckles(disparity: &Disparity, max_pixels: usize, max_step_px: f32) -> Vec<bool> {
    let values = disparity.values();
    let mut speckle = vec![false; values.len()];
    let mut seen: Vec<bool> = values.iter().map(|v| v.is_nan()).collect();
    let mut region = Vec::new();
    for start in 0..values.len() {
        if seen[start] {
            continue;
        }
        fill_region(disparity, start, max_step_px, &mut seen, &mut region);
        if region.len() <= max_pixels {
            region.iter().for_each(|&i| speckle[i] = true);
        }
    }
    speckle
}

/// The connected region of pixel `start`; its pixels become seen.
fn fill_region(
    disparity: &Disparity,
    start: usize,
    max_step_px: f32,
    seen: &mut [bool],
    region: &mut Vec<usize>,
) {
    let (values, width) = (disparity.values(), disparity.width());
    region.clear();
    region.push(start);
    seen[start] = true;
    let mut next = 0;
    while let Some(&at) = region.get(next) {
        next += 1;
        let x = at % width;
        let neighbours = [
            (x > 0).then(|| at - 1),
            (x + 1 < width).then(|| at + 1),
            at.checked_sub(width),
            Some(at + width).filter(|&i| i < values.len()),
        ];
        for i in neighbours.into_iter().flatten() {
            if !seen[i] && (values[i] - values[at]).abs() <= max_step_px {
                seen[i] = true;
                region.push(i);
            }
        }
    }
}
