//! Sweeps of the binary: their points are those of single runs, and a kill at any moment changes nothing.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;
use std::time::Duration;

use common::{TinyDrive, command, evigrid, names, path, stderr, stdout, sweep, sweep_plan as plan};

/// All files below a folder, by their path in it.
fn files(dir: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    let mut open = vec![dir.to_owned()];
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let entry = entry.unwrap().path();
            if entry.is_dir() {
                open.push(entry);
            } else {
                found.insert(entry.strip_prefix(dir).unwrap().to_owned(), fs::read(entry).unwrap());
            }
        }
    }
    found
}

fn rows(table: &Path) -> Vec<BTreeMap<String, String>> {
    csv::Reader::from_path(table).unwrap().deserialize().map(Result::unwrap).collect()
}

/// Both kinds of keys: those of which maps share the drawing, and those of the matcher, the map and the
/// reference.
const MIXED: &str = "winner-take-all.peak_ratio = { from = 1.0, to = 1.2, step = 0.1 }\n\
    stereo.window = [5, 7]\n\"winner-take-all.max_depth_m\" = [7, 25.5]\n\"truth.max_range_m\" = [80, 8.05]";

#[test]
fn points_are_single_runs_byte_for_byte() {
    let drive = TinyDrive::new(3);
    let (out, single) = (drive.root.path().join("out"), drive.root.path().join("single"));
    let output = sweep(&plan(&drive, "maps = true", MIXED), &out);
    assert!(output.status.success(), "{}", stderr(&output));
    let table = rows(&out.join("points.csv"));
    assert_eq!(table.len(), 24);
    let mut summaries = Vec::new();
    for row in &table {
        let point = out.join("points").join(&row["point"]);
        let config = point.join("config.toml");
        let run = evigrid(&["run", "--config", path(&config), "--out", path(&single)]);
        assert!(run.status.success(), "{}", stderr(&run));
        let (found, expected) = (files(&point), files(&single));
        assert_eq!(found.len(), 7, "{:?}", found.keys());
        for (name, bytes) in &found {
            assert!(expected[name] == *bytes, "{} of {row:?} differs", name.display());
        }
        for (column, cell) in &rows(&single.join("summary.csv"))[0] {
            assert_eq!(&row[column], cell, "{column}");
        }
        let config = fs::read_to_string(config).unwrap();
        assert!(config.contains(&format!("window = {}\n", row["stereo.window"])));
        assert!(config.contains(&format!("peak_ratio = {}\n", row["winner-take-all.peak_ratio"])));
        summaries.push(found[Path::new("map.winner-take-all.npz")].clone());
    }
    summaries.sort();
    summaries.dedup();
    assert_eq!(summaries.len(), 12, "every map differs, but for the settings of the reference");
}

#[test]
fn a_sweep_writes_its_tables_and_curves() {
    let drive = TinyDrive::new(2);
    let out = drive.root.path().join("out");
    let output = sweep(&plan(&drive, "name = \"mine\"", MIXED), &out);
    assert!(output.status.success(), "{}", stderr(&output));
    let id = "2011_09_26_drive_9999";
    let curves = [format!("curves.{id}.csv"), format!("curves.{id}.svg")];
    assert_eq!(names(&out), [&curves[0], &curves[1], "points", "points.csv", "sweep.md", "sweep.toml"]);
    assert!(stdout(&output).contains("# Sweep mine") && stdout(&output).contains("24 points"));
    // Lines along the key with the most values: one for each combination of the others.
    let table = rows(&out.join(&curves[0]));
    let lines: std::collections::BTreeSet<_> = table.iter().map(|row| &row["line"]).collect();
    assert_eq!((table.len(), lines.len()), (24, 8), "{lines:?}");
    assert!(
        lines.iter().any(|l| *l == "winner-take-all, window 5, max_range_m 80, max_depth_m 7"),
        "{lines:?}"
    );
    let svg = fs::read_to_string(out.join(&curves[1])).unwrap();
    assert!(svg.starts_with("<svg") && svg.contains("mistakes (cells)"));
    assert_eq!(svg.matches("<circle").count(), 24, "a dot for every point");
    // The plan as resolved makes the same sweep.
    let again = drive.root.path().join("again");
    assert!(sweep(&out.join("sweep.toml"), &again).status.success());
    assert_eq!(files(&out), files(&again));
}

#[test]
fn a_run_with_sweeps_is_the_sweep_around_it() {
    let drive = TinyDrive::new(2);
    let [a, b] = ["a", "b"].map(|name| drive.root.path().join(name));
    let output =
        drive.run(&a, &["--sweep", "winner-take-all.peak_ratio=1..1.2:0.1", "--sweep", "run.stride=[1, 2]"]);
    assert!(output.status.success(), "{}", stderr(&output));
    let keys = "\"winner-take-all.peak_ratio\" = [1.0, 1.1, 1.2]\nrun.stride = [1, 2]";
    assert!(sweep(&plan(&drive, "", keys), &b).status.success());
    let table = fs::read_to_string(a.join("points.csv")).unwrap();
    assert_eq!(table.lines().count(), 7);
    assert_eq!(
        table.replace(",1,", ",1.0,"),
        fs::read_to_string(b.join("points.csv")).unwrap().replace(",1,", ",1.0,")
    );
}

/// Points that are whole.
fn complete(out: &Path) -> usize {
    let points = out.join("points");
    names(&points).iter().filter(|p| points.join(p).join("run.json").is_file()).count()
}

/// Starts a sweep and kills it as soon as `now` says so. Says whether that was before its end.
fn start_and_kill(plan: &Path, out: &Path, now: impl Fn(Duration) -> bool) -> bool {
    let mut sweep = command(&["sweep", path(plan), "--out", path(out)]);
    let mut child = sweep.stdout(Stdio::null()).stderr(Stdio::null()).spawn().unwrap();
    let start = std::time::Instant::now();
    while !now(start.elapsed()) {
        if child.try_wait().unwrap().is_some() {
            return false;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    child.kill().unwrap();
    !child.wait().unwrap().success()
}

/// Four passes over the drive, of six points each.
const PASSES: &str = "winner-take-all.peak_ratio = { from = 1.0, to = 1.2, step = 0.1 }\n\
    run.stride = [1, 2, 3, 4]\nwinner-take-all.left_right_check = [true, false]";

#[test]
fn a_sweep_that_is_killed_and_restarted_gives_the_same_files() {
    let drive = TinyDrive::new(8);
    let [whole, out] = ["whole", "out"].map(|name| drive.root.path().join(name));
    let plan = plan(&drive, "maps = true", PASSES);
    let start = std::time::Instant::now();
    let output = command(&["sweep", path(&plan), "--out", path(&whole)])
        .env("RAYON_NUM_THREADS", "1")
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", stderr(&output));
    let whole_time = start.elapsed();

    // At moments all over the sweep, each time from the beginning.
    for part in 1..8 {
        let _ = fs::remove_dir_all(&out);
        start_and_kill(&plan, &out, |elapsed| elapsed > whole_time * part / 8);
        assert!(sweep(&plan, &out).status.success());
        assert_eq!(files(&out), files(&whole), "killed after {part}/8 of the time");
    }

    // Again and again, further on each time; what was whole is kept.
    fs::remove_dir_all(&out).unwrap();
    let mut kept: BTreeMap<String, std::time::SystemTime> = BTreeMap::new();
    for points in [1, 2, 7, 15] {
        start_and_kill(&plan, &out, |_| complete(&out) >= points);
        assert!(complete(&out) >= points);
        for (point, written) in &kept {
            assert_eq!(&modified(&out, point), written, "{point} was made again");
        }
        let points = out.join("points");
        let whole_ones = names(&points).into_iter().filter(|p| points.join(p).join("run.json").is_file());
        kept = whole_ones.map(|p| (p.clone(), modified(&out, &p))).collect();
    }
    let output = sweep(&plan, &out);
    assert!(
        stderr(&output).contains(&format!("{} of 24 points are there already", kept.len())),
        "{}",
        stderr(&output)
    );
    assert_eq!(files(&out), files(&whole));
}

fn modified(out: &Path, point: &str) -> std::time::SystemTime {
    fs::metadata(out.join("points").join(point).join("summary.csv")).unwrap().modified().unwrap()
}

#[test]
fn damaged_points_and_points_of_another_build_are_made_again() {
    let drive = TinyDrive::new(2);
    let out = drive.root.path().join("out");
    let plan = plan(&drive, "", "stereo.window = [5, 7, 9]");
    assert!(sweep(&plan, &out).status.success());
    let before = files(&out);
    let points = names(&out.join("points"));
    let file = |point: usize, name: &str| out.join("points").join(&points[point]).join(name);
    fs::write(file(0, "summary.csv"), "dataset\n").unwrap();
    let run = fs::read_to_string(file(1, "run.json")).unwrap();
    fs::write(file(1, "run.json"), run.replace("\"version\": \"", "\"version\": \"9")).unwrap();
    fs::write(out.join("points.csv.partial"), "half").unwrap();
    let output = sweep(&plan, &out);
    let text = stderr(&output);
    assert!(
        text.contains("1 of 3 points are there already") && text.contains("points.csv.partial"),
        "{text}"
    );
    assert_eq!(files(&out), before);
}

#[test]
fn a_broken_frame_stops_the_sweep_and_leaves_no_table() {
    let drive = TinyDrive::new(3);
    let out = drive.root.path().join("out");
    fs::write(drive.image("image_00", 2), "no image").unwrap();
    let output = sweep(&plan(&drive, "", "stereo.window = [5]\nrun.frames = [\"0..2\", \"0..3\"]"), &out);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{text}");
    assert!(text.lines().last().unwrap().starts_with("error: ") && text.contains("0000000002.png"), "{text}");
    assert_eq!(names(&out), ["points"]);
    assert_eq!(complete(&out), 1, "the pass before it is kept");
}
