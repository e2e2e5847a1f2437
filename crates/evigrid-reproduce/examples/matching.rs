//! Error and density of the matchers on Middlebury pairs with true disparity, as a Markdown table:
//!
//! ```sh
//! cargo run --release -p evigrid-reproduce --example matching -- data/middlebury/cones
//! ```
#![allow(clippy::print_stdout)]

use std::path::Path;

use anyhow::Result;
use evigrid_core::{Disparity, Matches, Pose};
use evigrid_metrics::MatchingScores;
use evigrid_replay::middlebury_truth;
use evigrid_stereo::{Matcher, MatcherKind, PixelCost, SemiGlobalSettings, StereoSettings};

fn main() -> Result<()> {
    println!(
        "| pair | matcher | left-right check | off by more than 1 px | matched | off, from column 64 on | matched |"
    );
    println!("| --- | --- | --- | --- | --- | --- | --- |");
    for dir in std::env::args().skip(1) {
        let dir = Path::new(&dir);
        let frame = evigrid_replay::open(dir)?.frame(0, &Pose::identity())?;
        let truth = middlebury_truth(dir)?;
        for (name, settings) in matchers() {
            let matches = Matcher::new(settings)?.run(frame.left(), frame.right(), false, None)?.matches;
            for checked in [false, true] {
                let found = if checked { left_right_checked(&matches)? } else { matches.disparity.clone() };
                let [(error, density), (error_inside, density_inside)] =
                    [percent(&found, &truth)?, percent(&without_left_columns(&found)?, &truth)?];
                let pair = dir.file_name().unwrap_or_default().display();
                let check = if checked { "1 px" } else { "-" };
                println!(
                    "| {pair} | {name} | {check} | {error:.2} % | {density:.1} % | {error_inside:.2} % | {density_inside:.1} % |"
                );
            }
        }
    }
    Ok(())
}

/// Error of the matched pixels and share of the known ones that are matched, percent.
fn percent(found: &Disparity, truth: &Disparity) -> Result<(f64, f64)> {
    let scores = MatchingScores::new(found, truth, 1.0)?;
    Ok((100.0 * scores.error_rate(), 100.0 * scores.density()))
}

/// Without the columns in which not all 64 hypotheses exist, which OpenCV leaves out.
fn without_left_columns(found: &Disparity) -> Result<Disparity> {
    let width = found.width();
    let values = found.values().iter().enumerate();
    let values = values.map(|(i, &d)| if i % width < 64 { f32::NAN } else { d }).collect();
    Ok(Disparity::new(width, found.height(), values)?)
}

/// 64 disparities as for OpenCV, uniqueness 5 percent.
fn matchers() -> Vec<(&'static str, StereoSettings)> {
    let block = StereoSettings { disparities: 64, ..Default::default() };
    let unique = StereoSettings { uniqueness_percent: 5, ..block };
    let semi_global =
        |semi_global| StereoSettings { matcher: MatcherKind::SemiGlobal, semi_global, ..unique };
    let base = SemiGlobalSettings::default();
    vec![
        ("block 7x7", block),
        ("block 7x7, uniqueness 5", unique),
        ("semi-global", semi_global(base)),
        ("semi-global, speckles 100", StereoSettings { speckle_pixels: 100, ..semi_global(base) }),
        ("semi-global, 4 paths", semi_global(SemiGlobalSettings { paths: 4, ..base })),
        ("semi-global, adapted p2", semi_global(SemiGlobalSettings { adapt_p2: true, ..base })),
        (
            "semi-global, absolute differences",
            semi_global(SemiGlobalSettings { pixel_cost: PixelCost::AbsoluteDifference, ..base }),
        ),
        (
            "semi-global, census, p1 40, p2 160",
            semi_global(SemiGlobalSettings { pixel_cost: PixelCost::Census, p1: 40, p2: 160, ..base }),
        ),
    ]
}

/// The disparities whose right pixel agrees within one pixel.
fn left_right_checked(matches: &Matches) -> Result<Disparity> {
    let pixels = matches.disparity.values().iter().zip(&matches.left_right_difference_px);
    let values = pixels.map(|(&d, &difference)| if difference <= 1 { d } else { f32::NAN }).collect();
    Ok(Disparity::new(matches.disparity.width(), matches.disparity.height(), values)?)
}
