//! Fig. 7: what larger error probabilities change.

use anyhow::{Context, Result};
use evigrid_udisparity::VisibilitySettings;

use super::panels::{FREE, OCCUPIED, SIZE, image_panel, key, u_panel};
use super::scene::Grids;
use crate::chart::Sheet;
use crate::job::Job;
use crate::table::rounded;

const WORLD: &str = "crossing";
const FRAME: usize = 60;
/// P_FP and P_FN of the paper's three grids.
const SETTINGS: [[f64; 2]; 3] = [[0.02, 0.02], [0.25, 0.02], [0.02, 0.25]];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let (mut panels, mut rows) = (Vec::new(), Vec::new());
    let mut standard: Vec<f32> = Vec::new();
    for [false_positive, false_negative] in SETTINGS {
        let settings = VisibilitySettings { false_positive, false_negative, ..VisibilitySettings::default() };
        let mut grids = Grids::new(WORLD, settings)?;
        grids.add(FRAME, &mut |seen| {
            let grid = seen.plain.u_disparity().context("no frame")?;
            if panels.is_empty() {
                panels.push(image_panel("a) left image", seen));
                standard = grid.total().to_vec();
            }
            let p = |u: usize, d: usize| f64::from(grid.total()[(d - 1) * grid.columns() + u]);
            panels.push(u_panel(&format!("P_FP = {false_positive}, P_FN = {false_negative}"), grid, p));
            let share = |is: &dyn Fn(f64) -> bool| {
                let cells = grid.total().iter().filter(|p| is(f64::from(**p))).count();
                rounded(100.0 * cells as f64 / grid.total().len() as f64, 2)
            };
            let of = |part: &dyn Fn(f64) -> bool| mean(grid.total(), &standard, part);
            rows.push(vec![
                rounded(false_positive, 2),
                rounded(false_negative, 2),
                share(&|p| p > OCCUPIED),
                share(&|p| p < FREE),
                rounded(of(&|p| p > OCCUPIED), 4),
                rounded(of(&|p| p < FREE), 4),
                rounded(of(&|p| (FREE..=OCCUPIED).contains(&p)), 4),
            ]);
            Ok(())
        })?;
    }
    let header = [
        "p_fp",
        "p_fn",
        "occupied_percent",
        "free_percent",
        "mean_of_occupied",
        "mean_of_free",
        "mean_of_the_rest",
    ];
    job.write_table(&header, rows)?;
    let sheet = Sheet {
        title: format!("The parameters P_FP and P_FN, {WORLD}, frame {FRAME} (Fig. 7)"),
        notes: vec!["a larger P_FP makes occupied cells lighter, a larger P_FN free ones darker".into()],
        columns: 2,
        panel: SIZE,
        panels,
    };
    job.write_keyed_picture(&sheet, &key())
}

/// Mean over the cells whose standard probability lies in a part.
fn mean(total: &[f32], standard: &[f32], part: &dyn Fn(f64) -> bool) -> f64 {
    let cells = total.iter().zip(standard).filter(|(_, standard)| part(f64::from(**standard)));
    let (count, sum) = cells.fold((0, 0.0), |(count, sum), (p, _)| (count + 1, sum + f64::from(*p)));
    sum / f64::from(count)
}
