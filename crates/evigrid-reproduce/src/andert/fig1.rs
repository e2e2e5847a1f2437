//! Fig. 1: the inverse sensor model of measurements at 10, 20 and 40 m.

use anyhow::Result;

use crate::chart::Sheet;
use crate::job::Job;
use crate::profile::{Profile, panel};

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let profiles = Profile::all(0.0)?;
    let rows = profiles.iter().flat_map(|profile| {
        let measured_m = profile.measured_m;
        profile.samples().map(move |[l, p, log_odds]| {
            [measured_m.to_string(), l.to_string(), format!("{p:.9}"), format!("{log_odds:.9}")]
        })
    });
    job.write_table(&["measured_m", "l_m", "p", "log_odds"], rows)?;
    let points = profiles.iter().map(|profile| {
        let at = profile.landmarks();
        let values = [profile.obstacle.deviation_m, at.peak_p, at.free_p, at.crossing_m];
        let [deviation, peak, free, crossing] = values.map(|v| format!("{v:.9}"));
        [profile.measured_m.to_string(), deviation, peak, free, crossing]
    });
    let header = ["measured_m", "deviation_m", "peak_p", "free_p", "crossing_m"];
    job.write_more("points", &header, points)?;
    job.write_picture(&Sheet {
        title: "Fig. 1: what a measurement of 10, 20 or 40 m says of its ray".into(),
        notes: vec![
            "b 0.3 m, f 700 px, disparities off by 0.5 px, k 0.1 m, p_min 0.35; free (0.35) in front, \
             unknown (0.5, grey) behind; near measurements say more"
                .into(),
        ],
        columns: 1,
        panel: (820, 440),
        panels: vec![panel("", &profiles)],
    })
}
