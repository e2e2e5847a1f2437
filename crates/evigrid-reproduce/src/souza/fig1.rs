//! Andert's Fig. 1 under an error of the robot's motion (eq. 13).

use anyhow::Result;

use crate::chart::Sheet;
use crate::job::Job;
use crate::profile::{Profile, panel};

/// eps, metres; the paper gives none.
const MOTION_ERRORS_M: [f64; 3] = [0.0, 0.1, 0.5];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let groups: Result<Vec<Vec<Profile>>> = MOTION_ERRORS_M.into_iter().map(Profile::all).collect();
    let groups = groups?;
    let rows = groups.iter().flatten().flat_map(|profile| {
        let Profile { motion_error_m, measured_m, .. } = *profile;
        profile.samples().map(move |[l, p, log_odds]| {
            let [p, log_odds] = [p, log_odds].map(|v| format!("{v:.9}"));
            [motion_error_m.to_string(), measured_m.to_string(), l.to_string(), p, log_odds]
        })
    });
    job.write_table(&["eps_m", "measured_m", "l_m", "p", "log_odds"], rows)?;
    let panels = groups.iter().zip(MOTION_ERRORS_M);
    job.write_picture(&Sheet {
        title: "The error of motion eps widens what a measurement says, and lowers its peak (eq. 13)".into(),
        notes: vec!["the camera of Andert's Fig. 1; the paper gives no value for eps".into()],
        columns: 3,
        panel: (460, 380),
        panels: panels.map(|(group, eps)| panel(&format!("eps = {eps} m"), group)).collect(),
    })
}
