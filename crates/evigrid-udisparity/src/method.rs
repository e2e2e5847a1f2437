//! The methods: one step per frame, in the paper's order.

use std::borrow::Cow;
use std::ops::Range;

use evigrid_core::{
    Disparity, DisparityPlane, MatchFilter, Matches, RoadSplit, SettingError, StereoRig, View,
};
use evigrid_grid::{GridSpec, Layer, LayerKind, MapError, Mapper, Method, Needs, Pictures, PlanGrid};

use crate::filter::{Filter, FilterForm};
use crate::ground_map::{GroundView, map_to_ground};
use crate::level::{LevelView, Pixels};
use crate::pictures::pictures;
use crate::rolling::RollingPlan;
use crate::settings::{TernarySettings, VisibilityFilteredSettings, VisibilitySettings};
use crate::smooth::Smoother;
use crate::ternary::ternary;
use crate::u_disparity::UDisparityGrid;

/// `visibility`: the grid of Perrollaz et al. 2012, frame by frame; with its filter `visibility-filtered`.
#[derive(Debug)]
pub struct Visibility {
    settings: VisibilitySettings,
    sight: Sight,
    /// What depends on the camera alone; made anew when the ground under it changes.
    camera: Option<Camera>,
    plan: RollingPlan,
    filter: Option<Filter>,
    /// The plan with velocities, where there is a filter.
    shown: PlanGrid,
}

/// What is seen in a frame: whole disparities before a level camera.
#[derive(Debug, Default)]
struct Sight {
    pixels: Pixels,
    /// The level camera, kept while rig and ground stay as they are: it holds an entry per pixel.
    level: Option<(StereoRig, DisparityPlane, LevelView)>,
}

#[derive(Debug)]
struct Camera {
    grid: UDisparityGrid,
    smoother: Smoother,
}

/// The parts of a view that these methods look at.
struct Seen<'a> {
    ground: GroundView,
    split: &'a RoadSplit,
    matches: &'a Matches,
}

impl<'a> Seen<'a> {
    fn of(view: &View<'a>) -> Result<Self, MapError> {
        let split = MapError::road(view)?;
        let refuse = |what, expected, found: String| MapError::View { what, expected, found };
        let ground = GroundView::of(view.rig, view.map_from_left).ok_or_else(|| {
            refuse("pose", "a camera that looks ahead", "one that looks along the vertical".into())
        })?;
        if split.tried.end < 2 {
            let found = format!("{} to {}", split.tried.start, split.tried.end.saturating_sub(1));
            return Err(refuse("disparities", "at least 1 px", found));
        }
        Ok(Self { ground, split, matches: view.matches })
    }

    /// The largest disparity of the grid.
    fn disparities(&self) -> usize {
        self.split.tried.end - 1
    }

    /// Fills the pixels of a sight; whether its level camera is another one than before.
    fn fill(
        &self,
        rig: &StereoRig,
        settings: &VisibilitySettings,
        sight: &mut Sight,
    ) -> Result<bool, MapError> {
        let is_same =
            |kept: &&(StereoRig, DisparityPlane, LevelView)| (kept.0, kept.1) == (*rig, self.split.ground);
        let is_new = sight.level.as_ref().filter(is_same).is_none();
        if is_new {
            let level = LevelView::new(rig, &self.split.ground).map_err(|e| MapError::View {
                what: "ground",
                expected: "disparities that grow downwards",
                found: e.to_string(),
            })?;
            sight.level = Some((*rig, self.split.ground, level));
        }
        let believed = MatchFilter::new(self.matches, &settings.limits());
        let parts: [&Disparity; 2] = [&self.split.obstacles, &self.split.road];
        let tried: &Range<usize> = &self.split.tried;
        if let Some((.., level)) = &sight.level {
            level.fill(&believed, parts, tried, &mut sight.pixels);
        }
        Ok(is_new)
    }
}

impl Visibility {
    /// The method over the plan of a grid, nothing known.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: VisibilitySettings) -> Result<Self, SettingError> {
        settings.check(Self::NAME)?;
        let plan = RollingPlan::new(spec.plan(), settings.rolls);
        let filter = settings.filter_settings();
        let of_plan = || Filter::new(filter, spec.plan().shape(), spec.cell_size_m());
        Ok(Self {
            settings,
            sight: Sight::default(),
            camera: None,
            shown: plan.grid().clone(),
            plan,
            filter: (filter.form != FilterForm::None).then(of_plan),
        })
    }

    /// The u-disparity grid of the last frame.
    pub fn u_disparity(&self) -> Option<&UDisparityGrid> {
        self.camera.as_ref().map(|camera| &camera.grid)
    }

    /// What the last frame showed.
    pub fn pixels(&self) -> &Pixels {
        &self.sight.pixels
    }

    /// The level camera of the last frame.
    pub fn level_view(&self) -> Option<&LevelView> {
        self.sight.level.as_ref().map(|(.., view)| view)
    }
}

impl Camera {
    /// The grid of a level camera.
    fn new(s: &VisibilitySettings, view: &LevelView, disparities: usize) -> Self {
        Self {
            grid: UDisparityGrid::new(view, s.top_m, disparities, s.parameters(), s.count_road),
            smoother: Smoother::new(s.sigma_u_px, s.sigma_d_px, view.rig.width),
        }
    }
}

impl Mapper for Visibility {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        let seen = Seen::of(view)?;
        let is_new = seen.fill(view.rig, &self.settings, &mut self.sight)?;
        let Some((.., level)) = &self.sight.level else { return Err(MapError::Lacks("a level camera")) };
        let disparities = seen.disparities();
        let fits = |camera: &Camera| !is_new && camera.grid.disparities() == disparities;
        if !self.camera.as_ref().is_some_and(fits) {
            self.camera = None;
        }
        let camera = self.camera.get_or_insert_with(|| Camera::new(&self.settings, level, disparities));
        camera.grid.fill(&self.sight.pixels);
        let columns = camera.grid.columns();
        let smooth = camera.smoother.run(camera.grid.total());
        let mut plan = self.plan.clone();
        let by = plan.follow(&seen.ground);
        let spec = plan.spec_in_map();
        map_to_ground(smooth, columns, &seen.ground, &spec, plan.probabilities_mut());
        if let Some(filter) = &mut self.filter {
            filter.step(view.stamp_ns, by, plan.grid().probabilities())?;
        }
        self.plan = plan;
        self.shown = self.plan.grid().clone();
        if let Some(filter) = &self.filter {
            self.shown.probabilities_mut().copy_from_slice(filter.probabilities());
            self.shown.set_velocities(filter.velocities());
        }
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::Plan(Cow::Borrowed(&self.shown))]
    }

    fn pictures(&self) -> Pictures {
        match (self.u_disparity(), self.level_view()) {
            (Some(grid), Some(view)) => pictures(grid, view),
            _ => Pictures::default(),
        }
    }
}

impl Method for Visibility {
    const NAME: &'static str = "visibility";
    const SUMMARY: &'static str =
        "occupancy of the ground from what the camera could see, frame by frame: Perrollaz et al. 2012";
    const NEEDS: Needs = Needs { road: true, ..Needs::MATCHES };
    const LAYERS: &'static [LayerKind] = &[LayerKind::Plan];
    type Settings = VisibilitySettings;

    fn check(settings: &VisibilitySettings) -> Result<(), SettingError> {
        settings.check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &VisibilitySettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(Self::new(spec, *settings)?))
    }
}

/// `visibility-filtered`: the same with the Bayesian occupancy filter.
#[derive(Debug)]
pub struct VisibilityFiltered;

impl Method for VisibilityFiltered {
    const NAME: &'static str = "visibility-filtered";
    const SUMMARY: &'static str = "visibility with the Bayesian occupancy filter, and velocities: Perrollaz et al. 2012, Coue et al. 2006";
    const NEEDS: Needs = Visibility::NEEDS;
    const LAYERS: &'static [LayerKind] = Visibility::LAYERS;
    type Settings = VisibilityFilteredSettings;

    fn check(settings: &VisibilityFilteredSettings) -> Result<(), SettingError> {
        settings.0.check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &VisibilityFilteredSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Self::check(settings)?;
        Ok(Box::new(Visibility::new(spec, settings.0)?))
    }
}

/// `ternary`: free up to the nearest obstacle of each column, unknown behind it.
#[derive(Debug)]
pub struct Ternary {
    settings: VisibilitySettings,
    sight: Sight,
    grid: Vec<f32>,
    plan: RollingPlan,
}

impl Mapper for Ternary {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        let seen = Seen::of(view)?;
        seen.fill(view.rig, &self.settings, &mut self.sight)?;
        let columns = self.sight.pixels.width;
        self.grid.resize(columns * seen.disparities(), 0.5);
        ternary(&self.sight.pixels, &self.settings.parameters(), &mut self.grid);
        self.plan.follow(&seen.ground);
        let spec = self.plan.spec_in_map();
        map_to_ground(&self.grid, columns, &seen.ground, &spec, self.plan.probabilities_mut());
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::Plan(Cow::Borrowed(self.plan.grid()))]
    }
}

impl Method for Ternary {
    const NAME: &'static str = "ternary";
    const SUMMARY: &'static str = "free up to the nearest obstacle of each column, unknown behind it: the baseline of Perrollaz et al. 2012";
    const NEEDS: Needs = Visibility::NEEDS;
    const LAYERS: &'static [LayerKind] = Visibility::LAYERS;
    type Settings = TernarySettings;

    fn check(settings: &TernarySettings) -> Result<(), SettingError> {
        settings.as_visibility().check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &TernarySettings) -> Result<Box<dyn Mapper>, SettingError> {
        Self::check(settings)?;
        let (settings, plan) = (settings.as_visibility(), RollingPlan::new(spec.plan(), settings.rolls));
        Ok(Box::new(Self { settings, sight: Sight::default(), grid: Vec::new(), plan }))
    }
}
