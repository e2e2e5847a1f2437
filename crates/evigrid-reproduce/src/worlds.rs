//! The table and the pictures of docs/synthetic.md: every built-in world, and how hard it is to
//! match beside real data. An item is a built-in world or a world's TOML file: its picture
//! alone, and its row of the table.

use std::fmt::Write as _;
use std::path::PathBuf;

use anyhow::{Context, Result};
use evigrid_core::Pose;
use evigrid_replay::Sequence;
use evigrid_synth::{LeftViewTruth, SyntheticSequence, World};

use crate::difficulty::{CheckedMatcher, Difficulty};
use crate::picture::stereo_panels;
use crate::safety_maps::safety_maps;
use crate::{Folders, Group, Items, write_file};

/// One line of the table.
struct Row {
    name: String,
    what: String,
    frames: usize,
    difficulty: Difficulty,
}

/// The frames that show what a world is for, where the middle one does not.
const SHOWN: [(&str, usize); 7] = [
    ("safety-1", 95),
    ("safety-2", 110),
    ("safety-3", 150),
    ("safety-4", 150),
    ("safety-5", 165),
    ("board-textured", 141),
    ("board-plain", 141),
];

/// The real data beside the worlds: id, where its truth comes from, frames.
const REAL: [(&str, &str, &[usize]); 2] = [
    ("2011_09_26_drive_0013", "truth: laser projected into the left image", &[0, 20, 39]),
    ("middlebury-cones", "truth: structured light", &[0]),
];

/// The group of the built-in worlds.
pub const GROUP: Group = Group {
    name: "worlds",
    items: Items::Together {
        names: || World::builtin_names().collect(),
        make: |item, folders, tools| reproduce(item, folders, tools.report),
    },
};

fn reproduce(item: Option<&str>, folders: &Folders, report: &mut dyn FnMut(&str)) -> Result<Vec<PathBuf>> {
    let out = folders.out.join("worlds");
    let mut matcher = CheckedMatcher::new()?;
    let mut files = Vec::new();
    if let Some(item) = item {
        let (row, picture) = world(item, &mut matcher)?;
        report(&markdown_table(std::slice::from_ref(&row)));
        files.push(out.join(format!("{}.jpg", row.name)));
        write_file(&files[0], &picture)?;
        return Ok(files);
    }
    let mut rows = Vec::new();
    for name in World::builtin_names() {
        report(name);
        let (row, picture) = world(name, &mut matcher).with_context(|| format!("world {name}"))?;
        rows.push(row);
        files.push(out.join(format!("{name}.jpg")));
        write_file(files.last().unwrap_or(&out), &picture)?;
    }
    for (id, truth, frames) in REAL {
        report(id);
        match real(id, truth, frames, folders, &mut matcher)? {
            Some(row) => rows.push(row),
            None => log::warn!("data set {id} is not below {}: its row is left out", folders.data.display()),
        }
    }
    report("safety maps");
    files.push(out.join("safety-maps.png"));
    write_file(&out.join("safety-maps.png"), &safety_maps()?)?;
    for (name, text) in [("difficulty.csv", csv_table(&rows)?), ("difficulty.md", markdown_table(&rows))] {
        files.push(out.join(name));
        write_file(&out.join(name), text.as_bytes())?;
    }
    Ok(files)
}

/// The first, the middle and the last frame count.
fn world(name: &str, matcher: &mut CheckedMatcher) -> Result<(Row, Vec<u8>)> {
    let world = World::open(name)?;
    let (last, sequence) = (world.frame_count() - 1, SyntheticSequence::new(world.clone()));
    let mut frames = vec![0, last / 2, last];
    frames.dedup();
    let mut see = |index: usize| -> Result<_> {
        let frame = sequence.frame(index, &Pose::identity())?;
        let truth = LeftViewTruth::new(&world, index).disparity()?;
        let matched = matcher.run(&frame)?;
        Ok((frame, truth, matched))
    };
    let mut difficulty = Difficulty::default();
    for &index in &frames {
        let (_, truth, matched) = see(index)?;
        difficulty.add(&matched, &truth)?;
    }
    let shown = SHOWN.iter().find(|(shown, _)| *shown == name).map_or(last / 2, |&(_, index)| index);
    let (frame, truth, matched) = see(shown)?;
    let picture = stereo_panels(frame.left(), &truth, &matched)?;
    let rig = sequence.info().rig;
    let what = format!("{}x{}, f {} px, b {} m", rig.width, rig.height, rig.focal_px, rig.baseline_m);
    Ok((Row { name: world.name().to_owned(), what, frames: last + 1, difficulty }, picture))
}

/// `None` if the data set is not there.
fn real(
    id: &str,
    truth_from: &str,
    frames: &[usize],
    folders: &Folders,
    matcher: &mut CheckedMatcher,
) -> Result<Option<Row>> {
    let known =
        evigrid_replay::find_dataset(id)?.with_context(|| format!("no data set {id} in datasets/"))?;
    let dir = known.dir_below(&folders.data);
    if !dir.exists() {
        return Ok(None);
    }
    let sequence = evigrid_replay::open(&dir)?;
    let mut difficulty = Difficulty::default();
    for &index in frames {
        let frame = sequence.frame(index, &Pose::identity())?;
        let truth = match frame.laser() {
            Some(scan) => evigrid_truth::projected_disparity(scan, frame.rig(), frame.map_from_left())?,
            None => evigrid_replay::middlebury_truth(&dir)?,
        };
        difficulty.add(&matcher.run(&frame)?, &truth)?;
    }
    Ok(Some(Row { name: id.to_owned(), what: truth_from.to_owned(), frames: frames.len(), difficulty }))
}

fn csv_table(rows: &[Row]) -> Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record([
        "world",
        "what",
        "frames",
        "valid_percent",
        "over_1_px_percent",
        "over_3_px_percent",
    ])?;
    for Row { name, what, frames, difficulty } in rows {
        let [over_1, over_3] = difficulty.wrong_percent();
        let [valid, over_1, over_3] = [difficulty.valid_percent(), over_1, over_3].map(|p| format!("{p:.1}"));
        writer.write_record([name, what, &frames.to_string(), &valid, &over_1, &over_3])?;
    }
    Ok(String::from_utf8(writer.into_inner()?)?)
}

fn markdown_table(rows: &[Row]) -> String {
    let mut text = String::from(
        "| world | rig, or where the truth comes from | frames | valid, % | of these off by > 1 px, % | > 3 \
         px, % |\n\
         | --- | --- | --- | --- | --- | --- |\n",
    );
    for Row { name, what, frames, difficulty } in rows {
        let (valid, [over_1, over_3]) = (difficulty.valid_percent(), difficulty.wrong_percent());
        let _ = writeln!(text, "| `{name}` | {what} | {frames} | {valid:.1} | {over_1:.1} | {over_3:.1} |");
    }
    text
}
