use evigrid_core::{MatchLimits, SettingError, require_setting};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// The segments that Algorithm 2 may make safe.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum Spread {
    /// Segments that are still Unexamined: a steep, small or thin segment keeps its label.
    Unexamined,
    /// Every neighbour, whatever its label: Algorithm 2 as it is printed, which has no test of the label.
    Any,
}

/// Where the floor under the robot lies in its layer of voxels.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "kebab-case")]
pub enum FloorPlace {
    /// In the middle of a voxel, as in the paper, where voxel w has its centre at the height w l_v over the
    /// floor. The layers of the grid are moved by up to half a voxel for it.
    Middle,
    /// Wherever the layers of the grid put it.
    Grid,
}

/// Settings of `safety-map`. The defaults are the paper's parameters; where the paper is silent, the source
/// says so.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(default, deny_unknown_fields)]
pub struct SafetyMapSettings {
    /// Matches with a smaller peak ratio are dropped; 1 drops none. Unit: none. Source: own choice.
    pub peak_ratio: f64,
    /// Drop matches that the right image does not confirm. Unit: none. Source: own choice.
    pub left_right_check: bool,
    /// Largest difference between the two winners that still counts as confirmed. Unit: px. Source: own
    /// choice.
    pub left_right_tolerance_px: u16,
    /// Smaller disparities are too far to be used. Unit: px. Source: own choice.
    pub min_disparity_px: f64,
    /// Readings are dropped that differ by more than this from most of their neighbours; 0: none are. Unit:
    /// px. Source: Murarka and Kuipers 2009 III, without a number.
    pub neighbour_difference_px: f64,
    /// A frame is dropped unless the camera has moved by so much, or turned by `min_turn_deg`, since the last
    /// one that was used. Unit: m. Source: Murarka and Kuipers 2009 IV (frames of a standing robot), without
    /// a number.
    pub min_motion_m: f64,
    /// See `min_motion_m`. Unit: deg. Source: as there.
    pub min_turn_deg: f64,
    /// Evidence for the voxel that a point falls in (incr_H). Unit: none. Source: Murarka and Kuipers 2009 IV.
    pub increment_hit: i32,
    /// Evidence for the voxels before and behind it on the ray (incr_L). Unit: none. Source: as incr_H.
    pub increment_beside: i32,
    /// Evidence against all other voxels between the camera and the point (decr). Unit: none. Source: Murarka
    /// and Kuipers 2009 VII-A (1, 3 and 5; its figures use 1).
    pub decrement: i32,
    /// Evidence at which a voxel is occupied (occ_t). Unit: none. Source: Murarka and Kuipers 2009 IV.
    pub occupied_at: i32,
    /// Points that a voxel keeps, those seen from nearest. Unit: none. Source: own choice.
    pub points_per_voxel: usize,
    /// Height of the robot: what is higher over the floor does not matter to it. Unit: m. Source: own choice;
    /// the robot of the built-in worlds.
    pub robot_height_m: f64,
    /// Planning radius (R_max). Unit: m. Source: Murarka and Kuipers 2009, Algorithm 1.
    pub radius_m: f64,
    /// Neighbouring columns may differ by so many voxels for one to lead to the other (w_T). Unit: voxels.
    /// Source: Murarka and Kuipers 2009, Algorithm 1.
    pub max_height_step: i64,
    /// Steeper segments are unsafe (theta_max). Unit: deg. Source: Murarka and Kuipers 2009, Algorithm 2.
    pub max_slope_deg: f64,
    /// Steeper safe segments are inclined, not level (theta_T). Unit: deg. Source: as theta_max.
    pub level_slope_deg: f64,
    /// Smaller segments are unknown (n_small). Unit: cells. Source: as theta_max.
    pub min_segment_cells: usize,
    /// Segments with fewer interior cells per boundary cell are unknown (r_thin). Unit: none. Source: as
    /// theta_max.
    pub min_interior_per_boundary: f64,
    /// At a border, the planes of two segments agree in a cell if their heights differ by less (h_T). Unit:
    /// m. Source: as theta_max.
    pub max_step_m: f64,
    /// So many cells must agree for one segment to be reachable from the next (num_T). Unit: cells. Source:
    /// as theta_max.
    pub min_border_cells: usize,
    /// Segments that can become safe: `unexamined`, or `any` as the algorithm is printed. Unit: none. Source:
    /// reading of Algorithm 2.
    pub spread: Spread,
    /// A boundary cell of safe ground is a potential drop-off edge if a lower cell is so near. Unit: cells.
    /// Source: Murarka and Kuipers 2009 VI ("close"), without a number.
    pub edge_reach: usize,
    /// `middle` or `grid`. Unit: none. Source: Murarka and Kuipers 2009 eq. 1.
    pub floor: FloorPlace,
    /// The grid moves with the robot, by whole voxels, and forgets what it leaves behind. Unit: none. Source:
    /// Murarka and Kuipers 2009 IV (their grid stands).
    pub scroll: bool,
    /// Neighbouring segments become one if, on the plane of all their points, the points of neither are more
    /// than this farther off than on their own (root mean square); 0: none do. Unit: m. Source: own.
    pub merge_m: f64,
    /// Points count for as much as there is evidence of their voxel. Without it a few readings that noise puts
    /// into the next layer count like the many of the layer below. Unit: none. Source: own.
    pub weigh_points: bool,
    /// Cells change over to a neighbouring segment whose plane their points lie nearer to by more than `merge_m`.
    /// Unit: none. Source: own.
    pub reassign_cells: bool,
    /// Evidence against a voxel at the height of the safe ground beside it from which on an empty column is a
    /// hole, and unsafe; 0: none is. Unit: none, as occupied_at. Source: own.
    pub hole_at: i32,
    /// Safe cells next to a hole, or to lower unsafe ground, are unsafe. Unit: none. Source: own.
    pub edges_unsafe: bool,
    /// Unknown cells that cannot be reached from the robot within the planning radius are unsafe. Unit: none.
    /// Source: own; Murarka and Kuipers 2009 VI for segments.
    pub enclosed_unsafe: bool,
}

impl Default for SafetyMapSettings {
    fn default() -> Self {
        Self {
            peak_ratio: 1.0,
            left_right_check: true,
            left_right_tolerance_px: 1,
            min_disparity_px: 3.0,
            neighbour_difference_px: 1.0,
            min_motion_m: 0.001,
            min_turn_deg: 0.05,
            increment_hit: 10,
            increment_beside: 4,
            decrement: 1,
            occupied_at: 100,
            points_per_voxel: 10,
            robot_height_m: 1.3,
            radius_m: 4.0,
            max_height_step: 1,
            max_slope_deg: 10.0,
            level_slope_deg: 3.0,
            min_segment_cells: 6,
            min_interior_per_boundary: 0.1,
            max_step_m: 0.05,
            min_border_cells: 5,
            spread: Spread::Unexamined,
            edge_reach: 5,
            floor: FloorPlace::Middle,
            scroll: false,
            merge_m: 0.0,
            weigh_points: false,
            reassign_cells: false,
            hole_at: 0,
            edges_unsafe: false,
            enclosed_unsafe: false,
        }
    }
}

impl SafetyMapSettings {
    /// `Ok` if every setting is within its domain.
    ///
    /// # Errors
    /// If one is not; the error names it, with the domain and the value. `section` is where the settings
    /// stand.
    pub fn check(&self, section: &'static str) -> Result<(), SettingError> {
        let length = |name, v: f64| {
            let possible = v.is_finite() && v > 0.0;
            require_setting(possible, section, name, "a positive number", v)
        };
        let share = |name, v: f64| {
            let possible = v.is_finite() && v >= 0.0;
            require_setting(possible, section, name, "a finite number from 0", v)
        };
        let evidence = |name, v: i32| {
            let possible = (0..=10_000).contains(&v);
            require_setting(possible, section, name, "a number from 0 to 10000", v)
        };
        let angle = |name, v: f64| {
            let possible = (0.0..=90.0).contains(&v);
            require_setting(possible, section, name, "an angle from 0 to 90 degrees", v)
        };
        let ratio = self.peak_ratio;
        require_setting(ratio >= 1.0, section, "peak_ratio", "a number from 1", ratio)?;
        length("min_disparity_px", self.min_disparity_px)?;
        share("neighbour_difference_px", self.neighbour_difference_px)?;
        share("min_motion_m", self.min_motion_m)?;
        angle("min_turn_deg", self.min_turn_deg)?;
        evidence("increment_hit", self.increment_hit)?;
        evidence("increment_beside", self.increment_beside)?;
        evidence("decrement", self.decrement)?;
        evidence("occupied_at", self.occupied_at)?;
        let points = self.points_per_voxel;
        let possible = (1..=1000).contains(&points);
        require_setting(possible, section, "points_per_voxel", "a number from 1 to 1000", points)?;
        length("robot_height_m", self.robot_height_m)?;
        length("radius_m", self.radius_m)?;
        let step = self.max_height_step;
        require_setting(
            (0..=1000).contains(&step),
            section,
            "max_height_step",
            "a number from 0 to 1000",
            step,
        )?;
        angle("max_slope_deg", self.max_slope_deg)?;
        angle("level_slope_deg", self.level_slope_deg)?;
        share("min_interior_per_boundary", self.min_interior_per_boundary)?;
        length("max_step_m", self.max_step_m)?;
        share("merge_m", self.merge_m)?;
        evidence("hole_at", self.hole_at)?;
        let reach = self.edge_reach;
        require_setting(reach <= 1000, section, "edge_reach", "a number from 0 to 1000", reach)
    }

    /// The limits that a match must keep.
    pub(crate) fn match_limits(&self) -> MatchLimits {
        let left_right_px = self.left_right_check.then_some(self.left_right_tolerance_px);
        MatchLimits { peak_ratio: self.peak_ratio, ..MatchLimits::left_right(left_right_px) }
    }
}

/// Settings of `safety-map-plus`: those of `safety-map`, with its additions switched on.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct SafetyMapPlusSettings(pub SafetyMapSettings);

impl Default for SafetyMapPlusSettings {
    fn default() -> Self {
        Self(SafetyMapSettings {
            merge_m: 0.01,
            weigh_points: true,
            reassign_cells: true,
            hole_at: 10,
            edges_unsafe: true,
            enclosed_unsafe: true,
            ..SafetyMapSettings::default()
        })
    }
}
