use std::ops::Range;

use anyhow::{Context, Result};
use evigrid_core::{Frame, Mounting, Pose};
use evigrid_grid::safe_ground::SafetyRules;
use evigrid_grid::{GridSpec, Layer, LayerKind, PlanGrid, SafetyMap, levels_in_band, projected};
use evigrid_metrics::{
    NamedArea, PlanReference, PlanState, PlanTally, PlanningDisc, SafetyCase, SafetyReference, SafetyTally,
    Scores, VoxelReference,
};
use evigrid_results::TruthFile;
use evigrid_synth::{Hazard, SafetyTruth, VoxelState, VoxelTruth, World, hazards_or_nothing};
use evigrid_truth::{LaserSafety, LaserTruth, RobotPlace, TruthSettings, TruthSource};

use crate::frame_plan::FramePlans;
use crate::plan::RunJob;
use crate::{Config, Recording};

/// The truth of a run so far, kind by kind: voxels, the ground plan by projection, and safety labels.
#[derive(Debug)]
pub struct Truth {
    voxels: Voxels,
    safety: Option<SafetyReference>,
    robot: Robot,
    /// Levels of voxels that make up the ground plan; `None` if nobody tells where the ground is.
    band: Option<Range<usize>>,
    /// What the laser of the last frame says of the ground, in runs with a method that shows plans.
    frames: Option<FramePlans>,
    without_laser: Vec<usize>,
}

/// The robot while frames are added: the mounting of its camera, its planning radius, and the pose of the
/// camera at the last frame that safety maps are scored at.
#[derive(Debug, Default)]
struct Robot {
    mounting: Option<Mounting>,
    radius_m: f64,
    last_scored: Option<Pose>,
    has_moved: bool,
    disc: Option<PlanningDisc>,
    /// Height of the last camera in the map, metres.
    last_height_m: Option<f64>,
    /// Number of frames so far.
    frames: usize,
}

/// A robot that moves and turns by less stands still, metres and radians: its frames are not scored (Murarka
/// and Kuipers 2009 VII-A).
const STANDING: [f64; 2] = [1e-3, 1e-3];

impl Robot {
    fn at(&mut self, pose: &Pose) {
        self.frames += 1;
        self.last_height_m = Some(pose.translation.z);
        let Some(mounting) = self.mounting else { return };
        self.has_moved = self.last_scored.is_none_or(|last| {
            let motion_m = (last.translation.vector - pose.translation.vector).norm();
            motion_m > STANDING[0] || last.rotation.angle_to(&pose.rotation) > STANDING[1]
        });
        if self.has_moved {
            self.last_scored = Some(*pose);
        }
        self.disc = Some(PlanningDisc { at_m: mounting.robot_m(pose), radius_m: self.radius_m });
    }
}

/// Where the truth of voxels comes from.
#[derive(Debug)]
enum Voxels {
    /// The laser scans so far.
    Laser(LaserTruth),
    /// The shapes of a world over all frames of the run; occupied and observed by flat index.
    Exact { spec: GridSpec, occupied: Vec<bool>, observed: Vec<bool> },
}

impl Truth {
    /// The truth before the first frame.
    ///
    /// # Errors
    /// If a setting is outside its domain, or a world lacks what an exact truth needs.
    pub(crate) fn new(job: &RunJob, recording: &Recording) -> Result<Self> {
        let (config, spec) = (&job.config, job.info.spec);
        let band = job.mounting.map(|mounting| plan_levels(&spec, config, mounting));
        let voxels = match (config.truth.source, recording.world()) {
            (TruthSource::Exact, Some(world)) => {
                let exact = VoxelTruth::new(world, spec, &job.map_from_world, &job.info.frames);
                let is = |state: VoxelState| exact.states().iter().map(|s| *s == state).collect::<Vec<_>>();
                // The inside of solids is nothing that a sensor could observe.
                let observed = is(VoxelState::Hidden).into_iter().map(|hidden| !hidden).collect();
                Voxels::Exact { spec, occupied: is(VoxelState::Occupied), observed }
            }
            _ => Voxels::Laser(LaserTruth::new(spec, config.truth)?),
        };
        let safety = safety_reference(job, recording)?;
        let radius_m = config.score.safety_radius_m;
        let robot = Robot { mounting: job.mounting, radius_m, ..Robot::default() };
        let frames = match (job.mounting, band.clone()) {
            (Some(mounting), Some(levels)) if job.shows(LayerKind::Plan) => {
                FramePlans::new(&spec, config, mounting, levels)
            }
            _ => None,
        };
        Ok(Self { voxels, safety, robot, band, frames, without_laser: Vec::new() })
    }

    /// A truth of voxels alone, from the laser scans of the frames that are added.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn laser(spec: GridSpec, settings: TruthSettings) -> Result<Self> {
        let voxels = Voxels::Laser(LaserTruth::new(spec, settings)?);
        let (safety, robot) = (None, Robot::default());
        Ok(Self { voxels, safety, robot, band: None, frames: None, without_laser: Vec::new() })
    }

    /// Adds a frame: its scan, if it has one, and the place of the robot.
    pub fn add(&mut self, frame: &Frame) {
        self.robot.at(frame.map_from_left());
        if let Some(frames) = &mut self.frames {
            frames.add(frame);
        }
        match (&mut self.voxels, frame.laser()) {
            (Voxels::Laser(truth), Some(scan)) => {
                truth.add_scan(scan);
                truth.add_view(scan, frame.rig(), frame.map_from_left());
            }
            (Voxels::Laser(_), None) => self.without_laser.push(frame.index()),
            (Voxels::Exact { .. }, _) => {}
        }
    }

    /// The truth of voxels; `None` while there was no laser scan.
    pub fn voxels(&self) -> Option<VoxelReference<'_>> {
        match &self.voxels {
            Voxels::Laser(truth) if truth.scans() == 0 => None,
            Voxels::Laser(truth) => Some(VoxelReference {
                spec: truth.spec(),
                occupied: truth.occupied(),
                observed: truth.observed(),
                in_view: Some(truth.in_view()),
            }),
            Voxels::Exact { spec, occupied, observed } => {
                Some(VoxelReference { spec, occupied, observed, in_view: None })
            }
        }
    }

    /// The truth of the ground plan, by projection; `None` without voxels, or if nobody tells where the
    /// ground is.
    pub fn plan(&self) -> Option<PlanReference> {
        Some(PlanReference::projected(&self.voxels()?, self.band.clone()?))
    }

    /// The truth of safety labels, where there is one.
    pub fn safety(&self) -> Option<&SafetyMap> {
        self.safety.as_ref().map(SafetyReference::map)
    }

    /// A safety map counted against the truth around the robot of the last frame; `None` without such a truth, or
    /// if the robot has stood still.
    pub fn safety_case(&self, found: &SafetyMap) -> Option<SafetyCase> {
        let truth = self.safety.as_ref().filter(|_| self.robot.has_moved)?;
        Some(SafetyCase::new(found, truth, self.robot.disc))
    }

    /// Counts a safety map against the truth around the robot of the last frame, unless there is no such truth or
    /// the robot has stood still.
    pub(crate) fn tally_safety(&self, found: &SafetyMap, tally: &mut Option<SafetyTally>) {
        if let (Some(truth), Some(disc), true) = (&self.safety, self.robot.disc, self.robot.has_moved) {
            let tally = tally.get_or_insert_with(|| SafetyTally::new(truth));
            tally.add(found, truth, disc, self.robot.frames - 1);
        }
    }

    /// Counts the plan of a map after the last frame against what the laser of that frame says, in runs with a method
    /// that shows plans.
    pub(crate) fn tally_plan(&self, layers: &[Layer<'_>], tally: &mut Option<PlanTally>) {
        if let Some(frames) = &self.frames {
            frames.count(layers, tally);
        }
    }

    /// What the laser of the last frame says of the ground around the camera, in runs with a method that shows plans.
    pub fn frame_plan(&self) -> Option<PlanReference> {
        let plan = self.frames.as_ref()?.laser()?;
        let state = |(occupied, free): (&bool, &bool)| match (occupied, free) {
            (true, _) => PlanState::Occupied,
            (false, true) => PlanState::Free,
            (false, false) => PlanState::Unknown,
        };
        let cells = plan.occupied().iter().zip(plan.free()).map(state).collect();
        Some(PlanReference { spec: *plan.spec(), cells })
    }

    /// How high the ground under the last camera lies in the map, metres; `None` if nobody tells.
    pub fn ground_m(&self) -> Option<f64> {
        let mounting = self.robot.mounting?;
        Some(self.robot.last_height_m? - mounting.height_m)
    }

    /// How many laser scans are in it.
    pub fn scans(&self) -> usize {
        match &self.voxels {
            Voxels::Laser(truth) => truth.scans(),
            Voxels::Exact { .. } => 0,
        }
    }

    /// Numbers of the frames that had no scan for it.
    pub fn without_laser(&self) -> &[usize] {
        &self.without_laser
    }

    /// The parts that are written to disk; `None` if there are none.
    pub fn file(&self) -> Option<TruthFile<'_>> {
        let (voxels, safety) = (self.voxels(), self.safety());
        (voxels.is_some() || safety.is_some()).then_some(TruthFile { voxels, safety })
    }

    /// Scores of the layers of one map after a frame, one entry per layer that there is a truth for.
    pub(crate) fn scores(&self, layers: &[Layer<'_>], tolerances_m: &[f64]) -> Vec<Scores> {
        layers.iter().filter_map(|layer| self.score(layer, tolerances_m, Scores::voxels)).collect()
    }

    /// Scores of the layers of one map at the end of a run. A map without a plan of its own is projected to
    /// one, so that all methods stand in one two-dimensional table. Those of the safety map are the sums over
    /// all frames, `safety`; those of the plan get what was counted frame by frame, `plan`.
    pub(crate) fn final_scores(
        &self,
        layers: &[Layer<'_>],
        tolerances_m: &[f64],
        safety: Option<&SafetyTally>,
        plan: Option<&PlanTally>,
    ) -> Vec<Scores> {
        let others = layers.iter().filter(|layer| layer.kind() != LayerKind::Safety);
        let own = others.filter_map(|layer| self.score(layer, tolerances_m, Scores::voxels_at_end));
        let mut scores: Vec<Scores> = own.collect();
        scores.extend(safety.map(|tally| Scores::safety(&tally.case)));
        let has_plan = layers.iter().any(|layer| layer.kind() == LayerKind::Plan);
        let voxels = layers.iter().find_map(Layer::voxels);
        if let (false, Some(map), Some(levels)) = (has_plan, voxels, self.band.clone()) {
            scores.extend(self.plan_scores(&projected(map, levels)));
        }
        let plans = scores.iter_mut().filter(|scores| scores.kind == LayerKind::Plan);
        if let Some(tally) = plan {
            plans.for_each(|scores| scores.add_frames(tally));
        }
        scores
    }

    fn score(&self, layer: &Layer<'_>, tolerances_m: &[f64], of_voxels: VoxelScoring) -> Option<Scores> {
        match layer {
            Layer::Voxels(map) => Some(of_voxels(map.values(), &self.voxels()?, tolerances_m)),
            Layer::Plan(plan) => self.plan_scores(plan),
            Layer::Safety(map) => {
                let truth = self.safety.as_ref()?;
                Some(Scores::safety(&SafetyCase::new(map, truth, self.robot.disc)))
            }
        }
    }

    fn plan_scores(&self, plan: &PlanGrid) -> Option<Scores> {
        Some(Scores::plan(plan, &self.plan()?))
    }
}

type VoxelScoring = fn(&[f32], &VoxelReference<'_>, &[f64]) -> Scores;

/// The levels of the ground plan: a band over the ground below the first camera.
fn plan_levels(spec: &GridSpec, config: &Config, mounting: Mounting) -> Range<usize> {
    levels_in_band(spec, config.score.plan_band_m.map(|height_m| height_m - mounting.height_m))
}

/// The true safety labels, if a method shows such labels: those of a world that tells of a robot, or those of all
/// laser scans of the run. They are whole before the first map is scored.
fn safety_reference(job: &RunJob, recording: &Recording) -> Result<Option<SafetyReference>> {
    if !job.shows(LayerKind::Safety) {
        return Ok(None);
    }
    let reference = match (job.config.truth.source, recording.world(), job.mounting) {
        (TruthSource::Exact, Some(world), _) => Some(exact_safety(job, world)?),
        (TruthSource::Laser, _, Some(mounting)) => laser_safety(job, recording, mounting)?,
        _ => None,
    };
    match (reference, job.mounting) {
        (Some(reference), Some(mounting)) => Ok(Some(reference.with_way(&way_m(job, recording, mounting)?))),
        (reference, _) => Ok(reference),
    }
}

/// The robot's places in the map frame, metres, one per frame of the run.
fn way_m(job: &RunJob, recording: &Recording, mounting: Mounting) -> Result<Vec<[f64; 2]>> {
    let place = |&frame: &usize| {
        let world_from_left = recording.sequence().world_from_left(frame)?;
        Ok(mounting.robot_m(&(job.map_from_world * world_from_left)))
    };
    job.info.frames.iter().map(place).collect()
}

/// The safety labels of a world, with its named hazards and safe areas.
fn exact_safety(job: &RunJob, world: &World) -> Result<SafetyReference> {
    let (spec, first) = (job.info.spec, job.info.frames[0]);
    let truth = SafetyTruth::new(world, spec, &job.map_from_world, first, &SafetyRules::default());
    let map = truth.context("truth.source = exact")?.map();
    let areas = hazards_or_nothing(world, &job.map_from_world, &map).into_iter().map(named_area);
    let areas = areas.filter(|area| !area.cells.is_empty()).collect();
    Ok(SafetyReference::new(map).with_areas(areas))
}

fn named_area(hazard: Hazard) -> NamedArea {
    let Hazard { name, kind, cells } = hazard;
    NamedArea { name, kind: kind.name().to_owned(), is_safe: kind.is_safe(), cells }
}

/// The safety labels of all laser scans of the run; `None` without any.
fn laser_safety(job: &RunJob, recording: &Recording, mounting: Mounting) -> Result<Option<SafetyReference>> {
    let (sequence, score, min_range_m) =
        (recording.sequence(), &job.config.score, job.config.truth.min_range_m);
    let mut truth = LaserSafety::new(job.info.spec.plan(), SafetyRules::default(), min_range_m);
    let mut start = None;
    for &frame in &job.info.frames {
        let pose = job.map_from_world * sequence.world_from_left(frame)?;
        let robot = RobotPlace {
            at_m: mounting.robot_m(&pose),
            floor_m: pose.translation.z - mounting.height_m,
            height_m: score.safety_robot_height_m,
            radius_m: score.safety_radius_m,
        };
        if let Some(scan) = sequence.laser(frame, &job.map_from_world)? {
            truth.add_scan(&scan, &robot);
            start.get_or_insert(robot);
        }
    }
    Ok(start.map(|start| SafetyReference::new(truth.map(&start)).with_heights(truth.heights_m())))
}
