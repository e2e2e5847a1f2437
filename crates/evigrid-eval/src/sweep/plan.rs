use anyhow::{Context, Result, bail};
use evigrid_methods::Entry;

use super::axis::{Axis, MAX_POINTS};
use super::point::{Point, applies};
use crate::{Config, Recording};

/// A sweep as it was written; [`Sweep::new`] checks it.
#[derive(Debug, Clone, PartialEq)]
pub struct SweepPlan {
    /// The place that the plan comes from, for error lines.
    pub(super) origin: String,
    /// Name of the sweep; empty: that of the first data set.
    pub(super) name: String,
    /// Data sets, as in `run.dataset`.
    pub(super) datasets: Vec<String>,
    /// Whether every point's map and reference are kept.
    pub(super) maps: bool,
    /// All settings that are not swept, with methods, frames and stride in `run`.
    pub(super) base: Config,
    /// The swept settings, by key.
    pub(super) axes: Vec<Axis>,
}

impl SweepPlan {
    /// A sweep around a run: its settings, with each `SECTION.KEY=A..B:STEP` over its range.
    ///
    /// # Errors
    /// If a range has another form, is empty, or names a setting twice.
    pub fn around(run: Config, sweeps: &[String]) -> Result<Self> {
        let axes: Result<Vec<Axis>> = sweeps.iter().map(|text| Axis::parse(text)).collect();
        let mut axes = axes?;
        axes.sort_by(|a, b| a.key.cmp(&b.key));
        if let Some(pair) = axes.windows(2).find(|pair| pair[0].key == pair[1].key) {
            bail!("--sweep: expected every setting once, found `{}` twice", pair[0].key);
        }
        Ok(Self {
            origin: "--sweep".into(),
            name: String::new(),
            datasets: vec![run.run.dataset.clone()],
            maps: false,
            base: run,
            axes,
        })
    }
}

/// A sweep whose every point has been checked.
pub struct Sweep {
    /// The plan, with a name.
    pub(super) plan: SweepPlan,
    /// The recordings with their points, in the order of the plan.
    pub(super) recordings: Vec<SweptRecording>,
}

/// One recording of a sweep.
pub(super) struct SweptRecording {
    /// The recording.
    pub recording: Recording,
    /// Its points: by method, then by the values of the keys, the last key's the fastest.
    pub points: Vec<Point>,
}

impl SweptRecording {
    /// Name of the recording.
    pub fn id(&self) -> &str {
        &self.recording.sequence().info().id
    }
}

impl std::fmt::Debug for Sweep {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Sweep").field("plan", &self.plan).finish_non_exhaustive()
    }
}

impl Sweep {
    /// Opens the recordings and checks the settings of every point against them.
    ///
    /// # Errors
    /// If a data set, method, setting or frame does not exist, a value is outside its domain, two points are
    /// the same, or there are too many.
    pub fn new(mut plan: SweepPlan) -> Result<Self> {
        let origin = plan.origin.clone();
        let methods = methods(&plan).with_context(|| origin.clone())?;
        check_keys(&plan, &methods).with_context(|| origin.clone())?;
        check_size(&plan, &methods).with_context(|| origin.clone())?;
        let mut recordings = Vec::new();
        for dataset in &plan.datasets {
            let recording = Recording::open(dataset).with_context(|| origin.clone())?;
            let mut points = Vec::new();
            for method in &methods {
                let combinations = super::point::combinations(&plan, method);
                for values in combinations {
                    points.push(Point::new(&plan, dataset, method, values, &recording)?);
                }
            }
            recordings.push(SweptRecording { recording, points });
        }
        if let (true, Some(first)) = (plan.name.is_empty(), recordings.first()) {
            first.id().clone_into(&mut plan.name);
        }
        let sweep = Self { plan, recordings };
        sweep.check_distinct()?;
        Ok(sweep)
    }

    /// Name of the sweep, for its folder.
    pub fn name(&self) -> &str {
        &self.plan.name
    }

    /// All points, in the order of the tables.
    pub(super) fn points(&self) -> impl Iterator<Item = &Point> {
        self.recordings.iter().flat_map(|r| &r.points)
    }

    /// Recordings are told apart by their names, points by their settings.
    fn check_distinct(&self) -> Result<()> {
        let mut names: Vec<&str> = self.recordings.iter().map(SweptRecording::id).collect();
        names.sort_unstable();
        if let Some(pair) = names.windows(2).find(|pair| pair[0] == pair[1]) {
            let origin = &self.plan.origin;
            bail!("{origin}: datasets: expected recordings of different names, found `{}` twice", pair[0]);
        }
        let mut seen = std::collections::BTreeMap::new();
        for (number, point) in self.points().enumerate() {
            if let Some(before) = seen.insert(point.hash(), number) {
                bail!(
                    "{}: expected points that differ, found points {} and {} the same: {}",
                    self.plan.origin,
                    before + 1,
                    number + 1,
                    point.label(&self.plan.axes)
                );
            }
        }
        Ok(())
    }
}

fn methods(plan: &SweepPlan) -> Result<Vec<Entry>> {
    if plan.datasets.is_empty() {
        bail!("datasets: expected at least one data set, found none");
    }
    let names = &plan.base.run.methods;
    if names.is_empty() {
        bail!("methods: expected at least one method, found none");
    }
    let all = plan.base.methods.methods();
    let method = |name: &String| {
        all.find(name).copied().with_context(|| format!("unknown method `{name}`{}", all.hint(name)))
    };
    names.iter().map(method).collect()
}

/// Every key must be a setting that changes maps or scores, of at least one of the methods.
fn check_keys(plan: &SweepPlan, methods: &[Entry]) -> Result<()> {
    for Axis { key, .. } in &plan.axes {
        if key.starts_with("output.") || ["run.dataset", "run.methods"].contains(&key.as_str()) {
            bail!(
                "sweep.{key}: expected a setting of maps or scores (data sets and methods have lists of their own)"
            );
        }
        if !methods.iter().any(|m| applies(key, m, plan.base.methods.methods())) {
            let names: Vec<_> = methods.iter().map(|m| m.name).collect();
            bail!("sweep.{key}: expected a setting of {}, found one of another method", names.join(" or "));
        }
    }
    Ok(())
}

fn check_size(plan: &SweepPlan, methods: &[Entry]) -> Result<()> {
    let all = plan.base.methods.methods();
    let of_method = |m: &Entry| {
        let sizes = plan.axes.iter().filter(|a| applies(&a.key, m, all)).map(|a| a.values.len());
        sizes.fold(plan.datasets.len(), usize::saturating_mul)
    };
    match methods.iter().map(of_method).fold(0, usize::saturating_add) {
        found if found > MAX_POINTS => bail!("expected at most {MAX_POINTS} points, found {found}"),
        _ => Ok(()),
    }
}
