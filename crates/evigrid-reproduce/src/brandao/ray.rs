//! Occupancy along one ray under the formulations that the paper compares.

use evigrid_cost_curve::whole_curve::{
    free_space_likelihood, likelihood, profile, visibility, with_free_space,
};
use evigrid_cost_curve::{CostExponent, FreeSpaceCosts, occupancy};

/// A cost curve from the nearest cell (or hypothesis) on, and what each formulation makes of it.
#[derive(Debug, Clone)]
pub struct Ray {
    pub costs: Vec<f64>,
    /// p(E | O_i V_i) (eq. 7); with eq. 9 also p(O_i | E V_i).
    pub likelihood: Vec<f64>,
    /// p(V_i | E) (eq. 5) with eq. 9.
    pub visibility: Vec<f64>,
    /// Elfes (eqs 1, 2), the likelihood as p(r | cell i is the first obstacle).
    pub elfes: Vec<f64>,
    /// The whole curve with eq. 9.
    pub whole: Vec<f64>,
    /// p(E | F_i V_i), and the whole curve with eq. 6.
    pub free_space: Option<(Vec<f64>, Vec<f64>)>,
}

impl Ray {
    pub fn new(costs: Vec<f64>, exponent: CostExponent, free_space: Option<FreeSpaceCosts>) -> Self {
        let occupied = likelihood(&costs, exponent);
        let free_space = free_space.map(|model| {
            let free = free_space_likelihood(&costs, model.mean, model.variance);
            let whole = profile(&with_free_space(&occupied, &free));
            (free, whole)
        });
        Self {
            visibility: visibility(&occupied),
            elfes: occupancy(&occupied),
            whole: profile(&occupied),
            likelihood: occupied,
            costs,
            free_space,
        }
    }
}
