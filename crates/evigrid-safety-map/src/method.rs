use evigrid_core::{MatchFilter, Pose, SettingError, View};
use evigrid_grid::{
    GridSpec, HybridModel, Layer, LayerKind, MapError, Mapper, Method, Needs, SafetyLabel, SafetyMap,
};

use crate::columns::Columns;
use crate::labels::label_columns;
use crate::model::{Model, floor_layer};
use crate::outliers::Readings;
use crate::robot::Robot;
use crate::segments::Segments;
use crate::settings::{FloorPlace, SafetyMapPlusSettings, SafetyMapSettings};

/// A stage of a frame, in their order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Readings are believed, and outliers among them removed (section III).
    Outliers,
    /// Evidence and points are added to the 3-D model (section IV).
    Model,
    /// Heights of the columns, and sums of their points (section V).
    Columns,
    /// Segments, planes and labels (sections V and VI).
    Labels,
}

/// The mapper of Murarka and Kuipers 2009.
#[derive(Debug)]
pub struct SafetyMapping {
    settings: SafetyMapSettings,
    /// The grid of the settings, before it is placed for the floor.
    spec: GridSpec,
    /// The model; `None` before the first frame, which tells where the floor is.
    model: Option<Model>,
    /// The robot at the first frame and at the last one that was used, and the pose of the camera there.
    first: Option<Robot>,
    robot: Option<Robot>,
    last_pose: Option<Pose>,
    readings: Readings,
    columns: Columns,
    map: SafetyMap,
}

impl SafetyMapping {
    /// An empty map over a grid.
    ///
    /// # Errors
    /// If a setting is outside its domain.
    pub fn new(spec: GridSpec, settings: SafetyMapSettings) -> Result<Self, SettingError> {
        settings.check(Self::NAME)?;
        Ok(Self {
            settings,
            spec,
            model: None,
            first: None,
            robot: None,
            last_pose: None,
            readings: Readings::default(),
            columns: Columns::none(spec.plan()),
            map: SafetyMap::of(spec.plan(), SafetyLabel::Unexamined),
        })
    }

    /// The safety map so far.
    pub fn map(&self) -> &SafetyMap {
        &self.map
    }

    /// The 3-D model so far; `None` before the first frame.
    pub fn model(&self) -> Option<&Model> {
        self.model.as_ref()
    }

    /// The height map behind the safety map.
    pub fn columns(&self) -> &Columns {
        &self.columns
    }

    /// The segments of ground behind the safety map, found once more; `None` before the first frame.
    pub fn segments(&self) -> Option<Segments> {
        let (model, robot) = (self.model.as_ref()?, self.robot?);
        let floor_layer = floor_layer(model.spec(), robot.floor_m);
        Some(Segments::find(&self.columns, &robot, floor_layer, &self.settings))
    }

    /// Integrates a frame as [`Mapper::integrate`] does, and tells when each of its stages is done. A frame of a
    /// standing robot is dropped, and has none.
    ///
    /// # Errors
    /// If the view does not tell how the camera stands over the ground.
    pub fn integrate_by_stages(
        &mut self,
        view: &View<'_>,
        done: &mut dyn FnMut(Stage),
    ) -> Result<(), MapError> {
        let robot = Robot::below(view.map_from_left, MapError::mounting(view)?);
        if !self.has_moved(view.map_from_left) {
            return Ok(());
        }
        (self.last_pose, self.robot) = (Some(*view.map_from_left), Some(robot));
        let first = *self.first.get_or_insert(robot);
        let placed = self.placed_grid(first.floor_m);
        let settings = self.settings;
        let model = self.model.get_or_insert_with(|| Model::new(placed, settings));
        if settings.scroll {
            model.scroll(voxels_moved(&placed, model.spec(), &first, &robot));
        }
        // III: range readings without those that differ much from their neighbours.
        let filter = MatchFilter::new(view.matches, &settings.match_limits());
        let (width, height, limit_px) = (view.rig.width, view.rig.height, settings.neighbour_difference_px);
        let readings = self.readings.fill(&filter, width, height, limit_px);
        done(Stage::Outliers);
        // IV: evidence of voxels, and their points.
        model.update(view.rig, view.map_from_left, readings);
        done(Stage::Model);
        // V and VI: columns, segments, planes, labels.
        model.columns(&robot, &mut self.columns);
        done(Stage::Columns);
        let model: &Model = model;
        let floor_layer = floor_layer(model.spec(), robot.floor_m);
        let is_free = |column, height_m| model.is_free(column, height_m);
        self.map = label_columns(&self.columns, &robot, floor_layer, &settings, &is_free);
        done(Stage::Labels);
        Ok(())
    }

    /// Whether the robot has moved since the last frame that was used.
    fn has_moved(&self, pose: &Pose) -> bool {
        self.last_pose.is_none_or(|last| {
            let turn_deg = last.rotation.angle_to(&pose.rotation).to_degrees();
            let motion_m = (last.translation.vector - pose.translation.vector).norm();
            motion_m > self.settings.min_motion_m || turn_deg > self.settings.min_turn_deg
        })
    }

    /// The grid with the floor in the middle of a layer, if the settings ask for it.
    fn placed_grid(&self, floor_m: f64) -> GridSpec {
        match self.settings.floor {
            FloorPlace::Grid => self.spec,
            FloorPlace::Middle => self.spec.raised(floor_offset_m(&self.spec, floor_m)),
        }
    }
}

/// By how much the layers of a grid must be raised for a height to be in the middle of one: at most half a
/// voxel up or down.
fn floor_offset_m(spec: &GridSpec, floor_m: f64) -> f64 {
    let in_layer = (floor_m - spec.origin_m()[2]) / spec.cell_size_m() - 0.5;
    (in_layer - (in_layer - 1e-6).round()) * spec.cell_size_m()
}

impl Mapper for SafetyMapping {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        self.integrate_by_stages(view, &mut |_| {})
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.map)]
    }

    fn hybrid_model(&self) -> Option<HybridModel> {
        let (model, robot) = (self.model.as_ref()?, self.robot?);
        let [x, y] = robot.at_m;
        Some(HybridModel {
            spec: *model.spec(),
            voxels: voxels_off_the_ground(model, &self.columns, &self.map),
            robot_m: [x, y, robot.floor_m],
            robot_height_m: self.settings.robot_height_m,
        })
    }
}

/// The occupied voxels of the examined columns, but for those up to the height of a safe one: they are its ground.
fn voxels_off_the_ground(model: &Model, columns: &Columns, map: &SafetyMap) -> Vec<u32> {
    let layers = model.spec().shape()[2];
    let above_ground = |column: usize| {
        let is_safe = map.labels()[column].is_safe() == Some(true);
        let ground = columns.height(column).filter(|_| is_safe);
        let first = ground.map_or(0, |height| height as usize + 1);
        column * layers + first..(column + 1) * layers
    };
    let voxels = columns.examined().flat_map(above_ground).filter(|&flat| model.is_occupied(flat));
    voxels.map(|flat| flat as u32).collect()
}

/// By how many voxels a grid must be moved so that it lies around the robot as at first.
fn voxels_moved(placed: &GridSpec, now: &GridSpec, first: &Robot, robot: &Robot) -> [i64; 3] {
    let c = placed.cell_size_m();
    let place = |r: &Robot| [r.at_m[0], r.at_m[1], r.floor_m];
    let (from, to) = (place(first), place(robot));
    std::array::from_fn(|a| {
        let wanted = ((to[a] - from[a]) / c).round();
        let is = ((now.origin_m()[a] - placed.origin_m()[a]) / c).round();
        (wanted - is) as i64
    })
}

impl Method for SafetyMapping {
    const NAME: &'static str = "safety-map";
    const SUMMARY: &'static str =
        "safe ground, drop-offs, inclines and obstacles around the robot: Murarka and Kuipers";
    const NEEDS: Needs = Needs { mounting: true, ..Needs::MATCHES };
    const LAYERS: &'static [LayerKind] = &[LayerKind::Safety];
    type Settings = SafetyMapSettings;

    fn check(settings: &SafetyMapSettings) -> Result<(), SettingError> {
        settings.check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &SafetyMapSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(Self::new(spec, *settings)?))
    }
}

/// The method with additions of its own: segments of one plane are joined, points count by the evidence of their
/// voxel, cells belong to the plane that they fit best, and holes, edges and what cannot be reached are unsafe.
#[derive(Debug)]
pub struct SafetyMappingPlus;

impl Method for SafetyMappingPlus {
    const NAME: &'static str = "safety-map-plus";
    const SUMMARY: &'static str =
        "safety-map with planes that hold whole ramps; holes, edges and enclosed cells unsafe: own";
    const NEEDS: Needs = SafetyMapping::NEEDS;
    const LAYERS: &'static [LayerKind] = SafetyMapping::LAYERS;
    type Settings = SafetyMapPlusSettings;

    fn check(settings: &SafetyMapPlusSettings) -> Result<(), SettingError> {
        settings.0.check(Self::NAME)
    }

    fn build(spec: GridSpec, settings: &SafetyMapPlusSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Self::check(settings)?;
        Ok(Box::new(SafetyMapping::new(spec, settings.0)?))
    }
}
