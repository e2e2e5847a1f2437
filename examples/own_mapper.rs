//! A mapper of your own beside a built-in one: see out/own-mapper/summary.md and recording.rrd.
use evigrid_core::{MatchFilter, MatchLimits, SettingError, View};
use evigrid_eval::{Config, Plan, RealClock, TableWriter, evaluate};
use evigrid_grid::{GridSpec, Layer, LayerKind, LogOddsGrid, MapError, Mapper, Method, Needs};
use evigrid_methods::Methods;
use evigrid_results::ResultsFolder;

/// Adds evidence to the cell in which a match ends. No cell is ever free.
struct Endpoints(LogOddsGrid, EndpointSettings);

/// `evigrid methods` lists settings with these comments, `--set endpoints.evidence=2` changes one.
#[derive(Clone, PartialEq, Default, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct EndpointSettings {
    /// Evidence of every match beyond 1. Unit: log-odds. Source: this example.
    evidence: f32,
}

impl Method for Endpoints {
    const NAME: &'static str = "endpoints";
    const SUMMARY: &'static str = "the cells in which matches end: an example";
    const NEEDS: Needs = Needs::MATCHES;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = EndpointSettings;

    fn build(spec: GridSpec, settings: &EndpointSettings) -> Result<Box<dyn Mapper>, SettingError> {
        Ok(Box::new(Self(LogOddsGrid::unknown(spec), settings.clone())))
    }
}

impl Mapper for Endpoints {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        let filter = MatchFilter::new(view.matches, &MatchLimits::left_right(Some(1)));
        for pixel in 0..view.rig.width * view.rig.height {
            // A pixel without a believed match has a negative disparity, and so a depth behind the camera.
            let depth_m = view.rig.depth_m(f64::from(filter.at(pixel)));
            let ray = view.rig.ray((pixel % view.rig.width) as f64, (pixel / view.rig.width) as f64);
            let point = view.map_from_left * nalgebra::Point3::from(ray * depth_m);
            if let (Some(cell), 0.0..25.0) = (self.0.spec().cell_of(point.into()), depth_m) {
                self.0.values_mut()[cell] = self.0.values()[cell].max(0.0) + 1.0 + self.1.evidence;
            }
        }
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.0)]
    }
}

fn main() -> anyhow::Result<()> {
    let mut config = Config::of(Methods::default().with::<Endpoints>());
    config.run.methods = ["winner-take-all", "endpoints"].map(String::from).to_vec();
    let plan = Plan::new(config)?;
    let (folder, _) = ResultsFolder::open("out/own-mapper".as_ref())?;
    let mut tables = TableWriter::create(&folder, &plan.job.info, serde_json::Value::Null)?;
    let mut recorder = evigrid_record::Recorder::create(folder.dir().join("recording.rrd"))?;
    evaluate(&plan, &RealClock::default(), &folder, &mut [&mut tables, &mut recorder]).map(drop)
}
