/// The parameters of Murarka and Kuipers 2009; the defaults are the paper's except where it says otherwise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SafetyRules {
    /// Steeper ground is unsafe (theta_max). Unit: degrees.
    pub max_slope_deg: f64,
    /// Safe ground that is steeper is inclined, not level (theta_T). Unit: degrees.
    pub level_slope_deg: f64,
    /// A robot gets over lower steps alone (h_T). Unit: metres.
    pub max_step_m: f64,
    /// It takes so many cells with a low step to get from one segment to the next (num_T).
    pub min_border_cells: usize,
    /// Smaller segments are unknown (n_small). Unit: cells.
    pub min_segment_cells: usize,
    /// Segments with fewer interior cells per boundary cell are unknown.
    pub min_interior_per_boundary: f64,
    /// Segments further up or down are not examined, whatever their size (w_T of
    /// one voxel of l_v). Unit: metres.
    pub max_examined_step_m: f64,
    /// Neighbouring cells are on one surface if the plane of one leads past the other's centre by no
    /// more. Unit: metres. Source: own; far below a step and above what a bend from level to
    /// inclined ground does in a small cell.
    pub continuity_m: f64,
    /// Cells whose centres are farther from the robot's start are unknown (R_max, 4 m in the paper); no limit
    /// if none. Unit: metres. Source: own default.
    pub max_range_m: Option<f64>,
}

impl Default for SafetyRules {
    fn default() -> Self {
        Self {
            max_slope_deg: 10.0,
            level_slope_deg: 3.0,
            max_step_m: 0.05,
            min_border_cells: 5,
            min_segment_cells: 6,
            min_interior_per_boundary: 0.1,
            max_examined_step_m: 0.1,
            continuity_m: 0.01,
            max_range_m: None,
        }
    }
}
