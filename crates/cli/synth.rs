use anyhow::Result;
use evigrid_eval::FrameRange;
use evigrid_synth::{World, write_data_set};

use crate::args::SynthArgs;
use crate::output::tell;
use crate::progress::WriteProgress;

/// `evigrid synth`.
pub fn synth(args: &SynthArgs) -> Result<()> {
    let world = World::open(&args.world)?;
    let range: FrameRange = args.frames.as_deref().unwrap_or("..").parse()?;
    let frames = range.frames(world.frame_count(), 1)?;
    let frames = frames[0]..frames[0] + frames.len();
    let mut progress = WriteProgress::default();
    write_data_set(&world, frames, &args.out, &mut |step| progress.show(step, &args.out))?;
    drop(progress);
    let out = args.out.display();
    tell(&format!("Data set: {out} (evigrid check {out}; evigrid run --dataset {out})\n"));
    Ok(())
}
