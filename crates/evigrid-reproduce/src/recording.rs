//! Recordings of single runs, for items that show more than a picture can.

use anyhow::Result;
use evigrid_eval::{Config, Observer, Plan, evaluate};
use evigrid_results::ResultsFolder;

use crate::job::Job;

/// Runs these settings once more into ITEM.rrd; nothing if the program cannot record.
pub fn record(job: &mut Job<'_, '_>, config: Config) -> Result<()> {
    let dir = job.dir();
    // Locked, and with nothing of an earlier run that was killed: the
    // recording's temporary name must be free.
    let (folder, _) = ResultsFolder::open(&dir)?;
    let path = dir.join(format!("{}.rrd", job.item()));
    remove_if_there(&path.with_extension("rrd.partial"))?;
    let Some(mut recorder) = (job.tools.recorder)(path.clone())? else { return Ok(()) };
    job.say("recording");
    let plan = Plan::new(config)?;
    let mut observers: [&mut dyn Observer; 1] = [recorder.as_mut()];
    evaluate(&plan, job.tools.clock, &folder, &mut observers)?;
    job.files.push(path);
    Ok(())
}

fn remove_if_there(path: &std::path::Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
            Err(anyhow::anyhow!("cannot remove {}: {e}", path.display()))
        }
        _ => Ok(()),
    }
}
