use std::fmt;
use std::path::PathBuf;

use evigrid_core::{Mounting, StereoRig};

use crate::{FrameRanges, Layout};

/// Findings on a data set: what it should hold, what it holds, and what is wrong with it. Prints as a table.
#[derive(Debug, Clone)]
pub struct CheckReport {
    /// The folder that was looked at.
    pub dir: PathBuf,
    /// Layout of the folder, if one fits.
    pub layout: Option<Layout>,
    /// Name of the recording; empty if it could not be opened.
    pub id: String,
    /// The rig, if the recording could be opened.
    pub rig: Option<StereoRig>,
    /// Whether the rig is an assumption, for want of a calibration, so that metric depths are nominal.
    pub rig_is_assumed: bool,
    /// How the left camera stands over the ground, if the recording could be opened and tells.
    pub mounting: Option<Mounting>,
    /// Frames that the left images promise: `0..frame_count`.
    pub frame_count: usize,
    /// Frames with both images, of the right size.
    pub stereo_frames: usize,
    /// Frames with a laser scan. Mapping needs none; the truth is built from these frames alone.
    pub laser_frames: usize,
    /// Everything that was looked for, and how it stands.
    pub items: Vec<CheckItem>,
    /// Everything that is wrong, one line each: what, expected, found, path.
    pub problems: Vec<String>,
}

/// One thing that a data set should hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct CheckItem {
    /// Name of the thing, e.g. `left images`.
    pub name: String,
    /// Content that should be there, e.g. `40 files`.
    pub expected: String,
    /// Content that is there.
    pub found: String,
    /// Verdict on the thing.
    pub state: ItemState,
    /// Frames that lack the thing.
    pub missing: FrameRanges,
    /// Frames whose file of this kind is wrong.
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

    /// Line on the mounting of the camera; `None` for a recording that could not be opened.
    fn mounting_line(&self) -> Option<String> {
        self.rig?;
        Some(match self.mounting {
            Some(Mounting { height_m, pitch_rad, .. }) => {
                let pitch_deg = (pitch_rad.to_degrees() * 100.0).round() / 100.0;
                format!("camera {height_m} m above the ground, pitch {pitch_deg} degrees")
            }
            None => "mounting over the ground: not told by the data set \
                     (--set input.mounting=[height_m, pitch_deg])"
                .to_owned(),
        })
    }
}

impl CheckItem {
    /// An item that no single frame lacks.
    pub(crate) fn new(name: &str, expected: &str, found: &str, state: ItemState) -> Self {
        Self {
            name: name.to_owned(),
            expected: expected.to_owned(),
            found: found.to_owned(),
            state,
            missing: FrameRanges::default(),
            faulty: FrameRanges::default(),
        }
    }

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
        if let Some(line) = self.mounting_line() {
            writeln!(f, "{line}")?;
        }
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
            layout: Some(Layout::KITTI_RAW),
            id: "drive".to_owned(),
            rig: None,
            rig_is_assumed: false,
            mounting: None,
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
