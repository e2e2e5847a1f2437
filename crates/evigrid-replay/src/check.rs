use std::fmt;
use std::path::PathBuf;

use evigrid_core::StereoRig;

use crate::{FrameRanges, Layout};

/// What a data set should hold, what it holds, and what is wrong with it. Printed as a plain table.
#[derive(Debug, Clone)]
pub struct CheckReport {
    /// The folder that was looked at.
    pub dir: PathBuf,
    /// Its layout, if one fits.
    pub layout: Option<Layout>,
    /// Name of the recording; empty if it could not be opened.
    pub id: String,
    /// The rig, if the recording could be opened.
    pub rig: Option<StereoRig>,
    /// Whether the rig is an assumption, so that metric depths are nominal (Middlebury pairs without calibration).
    pub rig_is_assumed: bool,
    /// Frames that the left images promise: `0..frame_count`.
    pub frame_count: usize,
    /// Frames with both images, of the right size.
    pub stereo_frames: usize,
    /// Frames with a laser scan. Mapping needs none; the truth is built from these frames alone.
    pub laser_frames: usize,
    /// Everything that was looked for.
    pub items: Vec<CheckItem>,
    /// Everything that is wrong, one line each: what, expected, found, path.
    pub problems: Vec<String>,
}

/// One thing that a data set should hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckItem {
    /// What was looked for.
    pub name: String,
    /// What should be there.
    pub expected: String,
    /// What is there.
    pub found: String,
    /// The verdict.
    pub state: ItemState,
    /// Frames that lack it.
    pub missing: FrameRanges,
    /// Frames whose file is wrong.
    pub faulty: FrameRanges,
}

/// The verdict on a [`CheckItem`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ItemState {
    /// Complete, and nothing wrong was seen.
    Ok,
    /// Not or not wholly there, and needed.
    Missing,
    /// There, but wrong.
    Faulty,
    /// Not or not wholly there, but not needed for mapping.
    Optional,
}

impl CheckReport {
    /// Whether every frame can be replayed: nothing is wrong, and nothing needed is missing.
    pub fn usable(&self) -> bool {
        let complete = |item: &CheckItem| matches!(item.state, ItemState::Ok | ItemState::Optional);
        self.layout.is_some() && self.problems.is_empty() && self.items.iter().all(complete)
    }

    fn heading(&self) -> String {
        let layout = self.layout.map_or("unknown layout", Layout::name);
        let id = if self.id.is_empty() { "data set" } else { &self.id };
        format!("{id} ({layout}), frames: {}", self.frame_count)
    }

    fn rig_line(&self) -> String {
        let Some(rig) = self.rig else { return "rig: unknown".to_owned() };
        let assumed = if self.rig_is_assumed { " (assumed: metres are nominal)" } else { "" };
        format!(
            "rig: {}x{} px, focal length {} px, centre ({}, {}) px, baseline {:.4} m{assumed}",
            rig.width, rig.height, rig.focal_px, rig.centre_x_px, rig.centre_y_px, rig.baseline_m
        )
    }
}

impl CheckItem {
    fn frames(&self) -> String {
        let part = |name: &str, frames: &FrameRanges| {
            if frames.is_empty() { None } else { Some(format!("{name} {frames}")) }
        };
        let parts = [part("missing", &self.missing), part("faulty", &self.faulty)];
        parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
    }
}

impl ItemState {
    /// The verdict as one word.
    pub fn name(self) -> &'static str {
        match self {
            Self::Ok => "ok",
            Self::Missing => "missing",
            Self::Faulty => "faulty",
            Self::Optional => "optional",
        }
    }
}

impl fmt::Display for CheckReport {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}\n{}", self.heading(), self.rig_line())?;
        if !self.items.is_empty() {
            writeln!(f)?;
            write_table(f, &self.items)?;
        }
        if !self.problems.is_empty() {
            writeln!(f)?;
        }
        self.problems.iter().try_for_each(|problem| writeln!(f, "problem: {problem}"))
    }
}

fn write_table(f: &mut fmt::Formatter<'_>, items: &[CheckItem]) -> fmt::Result {
    let heading = ["item", "expected", "found", "state", "frames"].map(str::to_owned);
    let row = |item: &CheckItem| {
        let state = item.state.name().to_owned();
        [item.name.clone(), item.expected.clone(), item.found.clone(), state, item.frames()]
    };
    let rows: Vec<[String; 5]> = std::iter::once(heading).chain(items.iter().map(row)).collect();
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths = [0, 1, 2, 3].map(width);
    for [name, expected, found, state, frames] in &rows {
        let [a, b, c, d] = widths;
        let line = format!("{name:a$}  {expected:b$}  {found:c$}  {state:d$}  {frames}");
        writeln!(f, "{}", line.trim_end())?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_aligned() {
        let item = |name: &str, state, missing: &[usize]| CheckItem {
            name: name.to_owned(),
            expected: "40 files".to_owned(),
            found: (40 - missing.len()).to_string(),
            state,
            missing: missing.iter().copied().collect(),
            faulty: FrameRanges::default(),
        };
        let report = CheckReport {
            dir: PathBuf::from("drive"),
            layout: Some(Layout::KittiRaw),
            id: "drive".to_owned(),
            rig: None,
            rig_is_assumed: false,
            frame_count: 40,
            stereo_frames: 40,
            laser_frames: 36,
            items: vec![
                item("left images", ItemState::Ok, &[]),
                item("laser scans", ItemState::Optional, &[17, 30, 31, 32]),
            ],
            problems: vec![],
        };
        assert!(report.usable());
        let expected = "drive (kitti-raw), frames: 40\nrig: unknown\n\n\
                        item         expected  found  state     frames\n\
                        left images  40 files  40     ok\n\
                        laser scans  40 files  36     optional  missing 17, 30..33\n";
        assert_eq!(report.to_string(), expected);
    }
}
