//! The one loop over frames, for a run, a sweep and the score of a foreign map: a frame is read once, matched
//! once per setting of the matcher, integrated into every map, and added once to every truth.

use anyhow::{Context, Result};
use evigrid_core::{Frame, Matching};
use evigrid_grid::{HybridModel, Layer, LayerKind, Needs, Pictures};
use evigrid_methods::Family;
use evigrid_metrics::{PlanTally, SafetyTally, Scores};
use evigrid_results::{MethodMaps, MethodResult, RunResult, StageTime};

use crate::lane::Lane;
use crate::plan::RunJob;
use crate::prefetch::read_ahead;
use crate::stage_times::Times;
use crate::{Clock, Config, Recording, Truth};

/// Whether maps are integrated one after the other, so that their times can be compared, or side by side.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Order {
    /// One after the other.
    InTurn,
    /// On all threads.
    SideBySide,
}

/// One map in the making: the method, and the run that it is made for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Entrant<'a> {
    /// The run, with all settings.
    pub job: &'a RunJob,
    /// Position of the method in that run.
    pub method: usize,
}

impl<'a> Entrant<'a> {
    /// All methods of a run.
    pub fn all_of(job: &'a RunJob) -> Vec<Self> {
        (0..job.methods.len()).map(|method| Self { job, method }).collect()
    }

    /// Name of the method.
    pub fn name(&self) -> &'static str {
        self.job.methods[self.method].name
    }

    fn config(&self) -> &'a Config {
        &self.job.config
    }

    /// An empty lane for its input and matcher.
    fn lane(&self, recording: &Recording) -> Result<Lane> {
        Lane::new(self.config(), self.job.mounting, recording.world())
    }

    /// Whether two maps can be made from one matching.
    pub fn same_matches(&self, other: &Self) -> bool {
        let (a, b) = (self.config(), other.config());
        a.stereo == b.stereo && a.input == b.input
    }

    /// Whether one truth serves two maps: grid, source, the place of the ground, and the kinds it is asked
    /// for.
    fn same_truth(&self, other: &Self) -> bool {
        let (a, b) = (self.config(), other.config());
        let same_ground =
            a.score.plan_band_m == b.score.plan_band_m && self.job.mounting == other.job.mounting;
        let same_kinds = LayerKind::ALL.into_iter().all(|kind| self.job.shows(kind) == other.job.shows(kind));
        let same_robot = a.score.safety_radius_m == b.score.safety_radius_m
            && a.score.safety_robot_height_m == b.score.safety_robot_height_m;
        a.grid == b.grid && a.truth == b.truth && same_ground && same_kinds && same_robot
    }

    fn same_kind(&self, other: &Self) -> bool {
        self.name() == other.name() && self.job.info.spec == other.job.info.spec
    }
}

/// Puts each entrant's group number down: the first entrant of its group, among `entrants`, comes first.
pub(crate) fn groups<'a>(
    entrants: &[Entrant<'a>],
    same: impl Fn(&Entrant<'a>, &Entrant<'a>) -> bool,
) -> Vec<Vec<usize>> {
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (number, entrant) in entrants.iter().enumerate() {
        match groups.iter_mut().find(|group| same(&entrants[group[0]], entrant)) {
            Some(group) => group.push(number),
            None => groups.push(vec![number]),
        }
    }
    groups
}

/// Where the map of an entrant is made and what it is scored against.
#[derive(Debug, Clone, Copy, Default)]
struct Place {
    lane: usize,
    family: usize,
    member: usize,
    truth: usize,
}

/// All maps in the making on the same frames.
pub(crate) struct Pass<'a> {
    entrants: Vec<Entrant<'a>>,
    places: Vec<Place>,
    lanes: Vec<Lane>,
    truths: Vec<Truth>,
    /// For each entrant its safety map, counted over all frames so far; `None` while there was nothing to
    /// count.
    safety: Vec<Option<SafetyTally>>,
    /// For each entrant its plan, counted likewise.
    plans: Vec<Option<PlanTally>>,
}

/// A frame that has been integrated.
pub(crate) struct Moment<'a> {
    /// Position in the run, from 0.
    pub position: usize,
    /// The frame.
    pub frame: &'a Frame,
    /// How long its stages took so far.
    pub times: Vec<StageTime>,
}

impl<'a> Pass<'a> {
    /// Empty maps for entrants on the same frames, at least one.
    ///
    /// # Errors
    /// If a setting is outside its domain, or a world lacks what an exact truth needs.
    pub fn new(recording: &Recording, entrants: Vec<Entrant<'a>>) -> Result<Self> {
        let mut pass = Self::without_maps(recording, entrants)?;
        for (lane, group) in groups(&pass.entrants, Entrant::same_matches).into_iter().enumerate() {
            let mut new = pass.entrants[group[0]].lane(recording)?;
            let members: Vec<Entrant<'a>> = group.iter().map(|&i| pass.entrants[i]).collect();
            for kind in groups(&members, Entrant::same_kind) {
                let numbers: Vec<usize> = kind.iter().map(|&i| group[i]).collect();
                pass.add_families(lane, &mut new, &numbers)?;
            }
            pass.lanes.push(new);
        }
        Ok(pass)
    }

    /// One entrant whose map has been made already.
    pub fn ended(recording: &Recording, entrant: Entrant<'a>, family: Family) -> Result<Self> {
        let mut pass = Self::without_maps(recording, vec![entrant])?;
        let mut lane = entrant.lane(recording)?;
        lane.add(family, Needs::NOTHING, 0);
        pass.lanes.push(lane);
        Ok(pass)
    }

    fn without_maps(recording: &Recording, entrants: Vec<Entrant<'a>>) -> Result<Self> {
        let mut places = vec![Place::default(); entrants.len()];
        let mut truths = Vec::new();
        for (truth, group) in groups(&entrants, Entrant::same_truth).into_iter().enumerate() {
            truths.push(Truth::new(entrants[group[0]].job, recording)?);
            group.into_iter().for_each(|i| places[i].truth = truth);
        }
        let (safety, plans) = (vec![None; entrants.len()], vec![None; entrants.len()]);
        Ok(Self { entrants, places, lanes: Vec::new(), truths, safety, plans })
    }

    /// Adds the maps of entrants of one method on one grid.
    fn add_families(&mut self, lane: usize, to: &mut Lane, numbers: &[usize]) -> Result<()> {
        let first = self.entrants[numbers[0]];
        let method = &first.job.methods[first.method];
        let tables: Vec<_> =
            numbers.iter().map(|&i| self.entrants[i].config().methods.table(method.name)).collect();
        let tables: Vec<_> = tables.iter().collect();
        for family in method.families(first.job.info.spec, &tables)? {
            let members = family.members.clone();
            let family = to.add(family, method.needs, numbers[members[0]]);
            for (member, at) in members.into_iter().enumerate() {
                let place = &mut self.places[numbers[at]];
                (place.lane, place.family, place.member) = (lane, family, member);
            }
        }
        Ok(())
    }

    /// Maps all frames. `follow` sees every frame when it has been integrated.
    ///
    /// # Errors
    /// If a frame cannot be read, matched or mapped, or `follow` fails; the pass stops there.
    pub fn drive(
        &mut self,
        recording: &Recording,
        clock: &dyn Clock,
        order: Order,
        follow: &mut dyn FnMut(&mut Self, Moment<'_>) -> Result<()>,
    ) -> Result<()> {
        let job = self.entrants[0].job;
        std::thread::scope(|scope| {
            let (frames, map_from_world) = (&job.info.frames, job.map_from_world);
            let frames = read_ahead(scope, recording.sequence(), frames, map_from_world, clock);
            for (position, read) in frames.iter().enumerate() {
                let (frame, read_ms) = read?;
                let mut times = Times { clock, frame: frame.index(), list: Vec::new() };
                times.list.push(StageTime { frame: frame.index(), method: None, stage: "read", ms: read_ms });
                self.step(&frame, order, &mut times)?;
                follow(self, Moment { position, frame: &frame, times: times.list })?;
                self.lanes.iter_mut().for_each(Lane::recycle);
            }
            Ok(())
        })
    }

    /// One frame: match, integrate, truth.
    fn step(&mut self, frame: &Frame, order: Order, times: &mut Times<'_>) -> Result<()> {
        for lane in &mut self.lanes {
            lane.match_pair(frame, times)?;
            lane.integrate(frame, order, times).with_context(|| format!("frame {}", frame.index()))?;
        }
        times.stage("truth", None, || self.truths.iter_mut().for_each(|truth| truth.add(frame)));
        for number in 0..self.len() {
            let mut tally = self.plans[number].take();
            self.truth(number).tally_plan(&self.layers(number), &mut tally);
            self.plans[number] = tally;
        }
        (0..self.len()).try_for_each(|number| self.count_safety(number, frame))
    }

    /// Counts the safety map of an entrant against the truth. Voxels are labelled for it, so that every method
    /// has a safety map where there is a truth for it.
    fn count_safety(&mut self, number: usize, frame: &Frame) -> Result<()> {
        if self.truth(number).safety().is_none() {
            return Ok(());
        }
        let mut tally = self.safety[number].take();
        let (entrant, layers) = (self.entrants[number], self.layers(number));
        let own = layers.iter().find_map(Layer::safety);
        let labelled = match (own, layers.iter().find_map(Layer::voxels), entrant.job.mounting) {
            (None, Some(voxels), Some(mounting)) => {
                Some(entrant.config().methods.safety_of_voxels(voxels, frame.map_from_left(), mounting)?)
            }
            _ => None,
        };
        if let Some(map) = own.or(labelled.as_ref()) {
            self.truth(number).tally_safety(map, &mut tally);
        }
        self.safety[number] = tally;
        Ok(())
    }

    /// How many maps there are.
    pub fn len(&self) -> usize {
        self.entrants.len()
    }

    /// One of the entrants.
    pub fn entrant(&self, number: usize) -> Entrant<'a> {
        self.entrants[number]
    }

    /// The layers of an entrant's map so far.
    pub fn layers(&self, number: usize) -> Vec<Layer<'_>> {
        let Place { lane, family, member, .. } = self.places[number];
        self.lanes[lane].family(family).mapper.layers(member)
    }

    /// The 3-D model behind an entrant's safety map so far, if its method makes one.
    pub fn hybrid_model(&self, number: usize) -> Option<HybridModel> {
        let Place { lane, family, member, .. } = self.places[number];
        self.lanes[lane].family(family).mapper.hybrid_model(member)
    }

    /// What an entrant's method has made of the last frame on the way to its map.
    pub fn pictures(&self, number: usize) -> Pictures {
        let Place { lane, family, member, .. } = self.places[number];
        self.lanes[lane].family(family).mapper.pictures(member)
    }

    /// Everything that an entrant's method has made so far.
    pub fn maps(&self, number: usize) -> MethodMaps<'_> {
        MethodMaps { layers: self.layers(number), hybrid: self.hybrid_model(number) }
    }

    /// The truth that an entrant is scored against.
    pub fn truth(&self, number: usize) -> &Truth {
        &self.truths[self.places[number].truth]
    }

    /// The matches of the current frame that an entrant saw; `None` if nobody needed any.
    pub fn matching(&self, number: usize) -> Option<&Matching> {
        self.lanes[self.places[number].lane].matching()
    }

    /// Scores of an entrant's map so far.
    pub fn scores(&self, number: usize) -> Vec<Scores> {
        self.truth(number).scores(&self.layers(number), &self.entrants[number].job.info.tolerances_m)
    }

    /// Scores of an entrant's map at the end.
    pub fn method_result(&self, number: usize, layers: &[Layer<'_>]) -> MethodResult {
        let entrant = &self.entrants[number];
        let tolerances_m = &entrant.job.info.tolerances_m;
        let (safety, plan) = (self.safety[number].clone(), self.plans[number].clone());
        let scores = self.truth(number).final_scores(layers, tolerances_m, safety.as_ref(), plan.as_ref());
        MethodResult { method: entrant.name().to_owned(), scores, safety, plan }
    }

    /// The result of a run with these methods, whose times nobody took.
    pub fn run_result(&self, number: usize, methods: Vec<MethodResult>) -> RunResult {
        RunResult {
            methods,
            frames: self.entrants[number].job.info.frames.len(),
            without_laser: self.truth(number).without_laser().to_vec(),
            wall_ms: 0.0,
            stage_totals: Vec::new(),
        }
    }
}
