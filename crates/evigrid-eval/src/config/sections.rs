use evigrid_core::{Mounting, SettingError, require_setting};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Which methods run on which frames of which recording.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct RunSettings {
    /// A folder, the name of a known data set, or `synth:NAME` for a synthetic world. Unit: none. Source:
    /// user.
    pub dataset: String,
    /// Names of the methods. Unit: none. Source: user.
    pub methods: Vec<String>,
    /// Frames `A..B` (B excluded), `A..` or `..B`. Unit: frame numbers. Source: user.
    pub frames: String,
    /// Use every n-th frame. Unit: frames. Source: user.
    pub stride: usize,
}

impl Default for RunSettings {
    fn default() -> Self {
        Self {
            dataset: "synth:street".into(),
            methods: vec!["winner-take-all".into()],
            frames: "..".into(),
            stride: 1,
        }
    }
}

/// Data that does not come with the recording.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct InputSettings {
    /// Folder with a 16-bit KITTI disparity PNG per frame, named as the frame number in ten digits
    /// (0000000007.png); empty: match. Unit: none. Source: KITTI stereo benchmark's format.
    pub disparity_dir: String,
    /// How the left camera stands over the ground: [height_m, pitch_deg], pitch downwards; empty: as the data
    /// set tells. Unit: m and deg. Source: user.
    pub mounting: Vec<f64>,
}

impl InputSettings {
    /// The mounting that the user gives; `None` if the data set is to tell.
    ///
    /// # Errors
    /// If it is neither empty nor a height above 0 and a pitch within a quarter turn.
    pub fn mounting(&self) -> Result<Option<Mounting>, SettingError> {
        let expected = "[] or [height_m above 0, pitch_deg between -90 and 90]";
        let wrong = |ok| require_setting(ok, "input", "mounting", expected, format!("{:?}", self.mounting));
        let &[height_m, pitch_deg] = &self.mounting[..] else {
            return wrong(self.mounting.is_empty()).map(|()| None);
        };
        let mounting = Mounting::over_middle(height_m, pitch_deg.to_radians());
        wrong(mounting.checked().is_ok()).map(|()| Some(mounting))
    }
}

/// Files that are written besides tables and maps.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct OutputSettings {
    /// Write the Rerun recording. Unit: none. Source: user.
    pub recording: bool,
    /// Write each frame's disparity as a 16-bit KITTI PNG into disparity/. Unit: none. Source: user.
    pub disparity: bool,
}

impl Default for OutputSettings {
    fn default() -> Self {
        Self { recording: true, disparity: false }
    }
}

/// How maps are scored.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct ScoreSettings {
    /// Distances to the nearest counterpart that are forgiven in the tolerant scores. Unit: m. Source: one
    /// and two cells of the paper's grid.
    pub tolerances_m: Vec<f64>,
    /// Heights over the ground, from and to, whose voxels make up the ground plan of a 3-D map. Unit: m.
    /// Source: own choice: above kerbs, below what a car passes under.
    pub plan_band_m: [f64; 2],
    /// Planning radius: safety maps are scored in cells whose centres are at most so far from the robot. Unit:
    /// m. Source: Murarka and Kuipers 2009, Algorithm 1 (R_max).
    pub safety_radius_m: f64,
    /// Height of the robot of the laser's safety map: what is higher over the floor does not matter. Unit: m.
    /// Source: own choice; the robot of the built-in worlds.
    pub safety_robot_height_m: f64,
}

impl Default for ScoreSettings {
    fn default() -> Self {
        Self {
            tolerances_m: vec![0.2, 0.4],
            plan_band_m: [0.3, 1.8],
            safety_radius_m: 4.0,
            safety_robot_height_m: 1.3,
        }
    }
}

/// Every cell within a tolerance is looked at, so a tolerance of many cells would take for ever.
const MAX_TOLERANCE_CELLS: f64 = 20.0;

impl ScoreSettings {
    /// `Ok` if these settings are possible for cells of this size.
    ///
    /// # Errors
    /// If a tolerance is negative or over 20 cells, the radius is not positive, or the band is empty.
    pub fn check(&self, cell_size_m: f64) -> Result<(), SettingError> {
        let most = MAX_TOLERANCE_CELLS * cell_size_m;
        for t in &self.tolerances_m {
            let ok = *t >= 0.0 && *t <= most;
            require_setting(ok, "score", "tolerances_m", format!("metres from 0 to {most} (20 cells)"), t)?;
        }
        let lengths = [
            ("safety_radius_m", self.safety_radius_m),
            ("safety_robot_height_m", self.safety_robot_height_m),
        ];
        for (key, length) in lengths {
            let ok = length.is_finite() && length > 0.0;
            require_setting(ok, "score", key, "a positive number", length)?;
        }
        let [from, to] = self.plan_band_m;
        let found = format!("[{from}, {to}]");
        let ok = from.is_finite() && to.is_finite() && from < to;
        require_setting(ok, "score", "plan_band_m", "two finite numbers [from, to] with from < to", found)
    }
}
