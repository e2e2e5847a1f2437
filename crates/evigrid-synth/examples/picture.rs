//! Renders frames of a world and says how hard they are to match:
//! `cargo run --release -p evigrid-synth --example picture -- WORLD[.toml] FOLDER FRAME...`
//! writes FOLDER/FRAME.png: left and right image above, true and matched disparity below.

#![allow(clippy::print_stdout)]

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use evigrid_core::{Disparity, Frame, Pose};
use evigrid_metrics::MatchingScores;
use evigrid_replay::Sequence;
use evigrid_stereo::{BlockMatcher, BlockMatchingSettings};
use evigrid_synth::{LeftViewTruth, PixelTruth, SyntheticSequence, World};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let name = arguments.next().ok_or("expected a world")?;
    let folder = PathBuf::from(arguments.next().ok_or("expected a folder")?);
    let world = match Path::new(&name).extension() {
        Some(_) => World::from_file(Path::new(&name))?,
        None => World::builtin(&name)?,
    };
    std::fs::create_dir_all(&folder)?;
    let sequence = SyntheticSequence::new(world.clone());
    let mut matcher = BlockMatcher::new(BlockMatchingSettings::default())?;
    for index in arguments {
        let index: usize = index.parse()?;
        let start = Instant::now();
        let frame = sequence.frame(index, &Pose::identity())?;
        let ms = start.elapsed().as_secs_f64() * 1e3;
        let truth = LeftViewTruth::new(&world, index);
        let points = frame.laser().map_or(0, |scan| scan.points().len());
        let p = world.true_world_from_left(index).translation.vector;
        println!(
            "frame {index}: {ms:.0} ms, {points} laser points, camera at {:.2} {:.2} {:.2}",
            p.x, p.y, p.z
        );
        let matched = matched(&mut matcher, &frame)?;
        println!("  {}", difficulty(&truth, &matched)?);
        save(&frame, &truth, &matched, &folder.join(format!("{index}.png")))?;
    }
    Ok(())
}

/// What passes a left-right check within one pixel.
fn matched(matcher: &mut BlockMatcher, frame: &Frame) -> Result<Disparity, Box<dyn Error>> {
    let matches = matcher.run(frame.left(), frame.right(), false, None)?.matches;
    let checked = matches.disparity.values().iter().zip(&matches.left_right_difference_px);
    let values = checked.map(|(&d, &difference)| if difference <= 1 { d } else { f32::NAN }).collect();
    Ok(Disparity::new(frame.rig().width, frame.rig().height, values)?)
}

fn difficulty(truth: &LeftViewTruth, matched: &Disparity) -> Result<String, Box<dyn Error>> {
    let scores = MatchingScores::new(matched, &truth.disparity()?, 1.0)?;
    let share = |seen: &dyn Fn(&PixelTruth) -> bool| {
        truth.pixels().iter().filter(|p| seen(p)).count() as f64 / truth.pixels().len() as f64
    };
    Ok(format!(
        "SAD 7x7 with left-right check: {:.1} % valid, {:.1} % of them off by more than 1 px; sky {:.1} %, hidden from the right camera {:.1} %, depth below 25 m {:.1} %",
        100.0 * scores.density(),
        100.0 * scores.error_rate(),
        100.0 * share(&|p| p.surface.is_none()),
        100.0 * share(&|p| p.surface.is_some() && !p.seen_by_right),
        100.0 * share(&|p| p.depth_m < 25.0),
    ))
}

fn save(
    frame: &Frame,
    truth: &LeftViewTruth,
    matched: &Disparity,
    path: &Path,
) -> Result<(), Box<dyn Error>> {
    let (width, height) = (frame.rig().width, frame.rig().height);
    let truth = truth.disparity()?;
    let largest = truth.values().iter().copied().fold(1.0, f32::max);
    let shown = |d: &f32| if d.is_nan() { 0 } else { (255.0 * (d / largest).min(1.0)) as u8 };
    let grey = |disparity: &Disparity| disparity.values().iter().map(shown).collect::<Vec<u8>>();
    let rows = |left: &[u8], right: &[u8]| -> Vec<u8> {
        left.chunks(width).zip(right.chunks(width)).flat_map(|(l, r)| [l, r].concat()).collect()
    };
    let above = rows(frame.left().pixels(), frame.right().pixels());
    let below = rows(&grey(&truth), &grey(matched));
    let (columns, lines) = (2 * width as u32, 2 * height as u32);
    Ok(image::save_buffer(path, &[above, below].concat(), columns, lines, image::ColorType::L8)?)
}
