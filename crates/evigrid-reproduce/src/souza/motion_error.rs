//! Whether an error of motion in the model makes better maps where the poses are those of odometry.

use anyhow::Result;
use evigrid_eval::{Config, Recording as Replayed};
use evigrid_replay::Sequence;
use evigrid_synth::{SyntheticSequence, World};

use super::drifting::{Drift, Drifting};
use super::matchers::MATCHERS;
use super::motion_picture::picture;
use super::motion_sweep::{Scored, Setting, growing_settings, settings, sweep};
use super::robot::{DRIVES, Drive};
use crate::drive;
use crate::job::Job;
use crate::table::{SCORE_COLUMNS, rounded, score_cells};

/// The maps of one recording.
pub struct Recording {
    pub name: String,
    pub poses: String,
    pub maps: Vec<Scored>,
}

/// More drives with odometry, three times as wrong as those of the worlds: so many of them.
const MORE_DRIVES: u64 = 3;
const WRONGER: [f64; 2] = [0.06, 0.9];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut recordings = Vec::new();
    for drive in &DRIVES {
        recordings.extend(robot_drive(job, drive)?);
    }
    recordings.extend(real_drive(job)?);
    let known = ["drive", "poses", "eps_m", "eps_per_m", "prior"];
    let header = [&known[..], &SCORE_COLUMNS, &["f1_minus_that_of_eps_0"]].concat();
    job.write_table(&header, recordings.iter().flat_map(Recording::rows))?;
    let verdicts = recordings.iter().map(Recording::verdict);
    let header = ["drive", "poses", "f1_eps_0", "best_f1", "best_eps_m", "best_eps_per_m", "gain"];
    job.write_more("best", &header, verdicts)?;
    job.write_picture(&picture(&recordings))
}

/// A drive with exact poses, those of its world's odometry, and those of worse odometry; all scored
/// against the laser of the first.
fn robot_drive(job: &mut Job<'_, '_>, drive: &Drive) -> Result<Vec<Recording>> {
    let config = |sets: &[String]| drive.config(&MATCHERS[0], sets);
    let open = |world| Ok::<_, anyhow::Error>(Replayed::from(World::builtin(world)?));
    let clock = job.tools.clock;
    job.say(&format!("synth:{}", drive.exact));
    let (maps, surfaces) = sweep(settings(), &open(drive.exact)?, &config, None, clock)?;
    let recording = |poses: String, maps| Recording { name: drive.exact.to_owned(), poses, maps };
    let mut recordings = vec![recording("exact".to_owned(), maps)];
    job.say(&format!("synth:{}", drive.odometry));
    let (maps, _) = sweep(settings(), &open(drive.odometry)?, &config, surfaces.as_ref(), clock)?;
    recordings.push(recording("odometry".to_owned(), maps));
    for seed in 1..=MORE_DRIVES {
        let poses = format!("odometry 3 times as wrong ({seed})");
        job.say(&format!("synth:{}, {poses}", drive.exact));
        let drift = Drift { metres: WRONGER[0], degrees: WRONGER[1], seed };
        let exact = SyntheticSequence::new(World::builtin(drive.exact)?);
        let drifting: Box<dyn Sequence> = Box::new(Drifting::new(exact, &drift)?);
        let (maps, _) = sweep(growing_settings(), &drifting.into(), &config, surfaces.as_ref(), clock)?;
        recordings.push(recording(poses, maps));
    }
    Ok(recordings)
}

/// The KITTI drive, whose poses are those of GPS and inertial sensors, if it is there.
fn real_drive(job: &mut Job<'_, '_>) -> Result<Option<Recording>> {
    let Some(drive) = drive::find(job)? else {
        log::warn!("motion-error: {} is left out", job.missing(drive::WANTED));
        return Ok(None);
    };
    let recording = Replayed::from(evigrid_replay::open(&drive.dir)?);
    let name = recording.sequence().info().id.clone();
    job.say(&name);
    let config = |sets: &[String]| {
        let base = [format!("run.frames={}", drive.frames)];
        let mut config = Config::load(None, &[&base, sets].concat())?;
        config.run.methods = vec!["souza".to_owned()];
        Ok(config)
    };
    let (maps, _) = sweep(settings(), &recording, &config, None, job.tools.clock)?;
    Ok(Some(Recording { name, poses: "GPS and inertial".to_owned(), maps }))
}

impl Recording {
    /// F1 without any error of motion, that is Andert's.
    fn plain_f1(&self) -> f64 {
        self.maps.first().map_or(f64::NAN, |map| map.counts.f1())
    }

    fn rows(&self) -> impl Iterator<Item = Vec<String>> + '_ {
        self.maps.iter().map(|Scored { setting, counts }| {
            let mut row = vec![self.name.clone(), self.poses.clone()];
            row.extend([setting.eps_m, setting.eps_per_m, setting.prior].map(|v| v.to_string()));
            row.extend(score_cells(counts));
            row.push(rounded(counts.f1() - self.plain_f1(), 4));
            row
        })
    }

    /// The best error of motion with the prior 0.5.
    fn verdict(&self) -> [String; 7] {
        let usual = self.maps.iter().filter(|map| map.setting.prior == 0.5);
        let best = usual.max_by(|a, b| a.counts.f1().total_cmp(&b.counts.f1()));
        let f1 = best.map_or(f64::NAN, |map| map.counts.f1());
        let of = |value: fn(&Setting) -> f64| best.map_or(f64::NAN, |map| value(&map.setting)).to_string();
        [
            self.name.clone(),
            self.poses.clone(),
            rounded(self.plain_f1(), 4),
            rounded(f1, 4),
            of(|s| s.eps_m),
            of(|s| s.eps_per_m),
            rounded(f1 - self.plain_f1(), 4),
        ]
    }
}
