//! Renders one frame of a world and writes the two images as PNG files, to look at them:
//! `cargo run --release -p evigrid-synth --example picture -- FOLDER [FRAME] [WORLD.toml]`.

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use evigrid_core::{GrayImage, Pose};
use evigrid_replay::Sequence;
use evigrid_synth::{SyntheticSequence, World};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("expected a folder")?);
    let index = arguments.next().map_or(Ok(0), |text| text.parse())?;
    let world = match arguments.next() {
        None => World::builtin("street")?,
        Some(path) => World::from_toml(&std::fs::read_to_string(path)?)?,
    };
    let sequence = SyntheticSequence::new(world);
    let start = Instant::now();
    let frame = sequence.frame(index, &Pose::identity())?;
    let points = frame.laser().map_or(0, |scan| scan.points().len());
    eprintln!("frame {index}: {:.1} ms, {points} laser points", start.elapsed().as_secs_f64() * 1e3);
    std::fs::create_dir_all(&folder)?;
    save(frame.left(), folder.join("left.png"))?;
    save(frame.right(), folder.join("right.png"))
}

fn save(image: &GrayImage, path: PathBuf) -> Result<(), Box<dyn Error>> {
    let (width, height) = (image.width() as u32, image.height() as u32);
    Ok(image::save_buffer(path, image.pixels(), width, height, image::ColorType::L8)?)
}
