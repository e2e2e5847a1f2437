//! A whole run of the binary: what it writes, and that it is the same every time.
#![allow(clippy::unwrap_used, missing_docs)]

mod common;

use std::collections::BTreeSet;
use std::fs;
use std::io::Read;
use std::path::Path;

use common::{TinyDrive, command, evigrid, names, path, stderr, stdout};

/// An int32 [N,3] array of an npz file.
fn voxels(file: &Path, array: &str) -> Vec<[i32; 3]> {
    let bytes = npy(file, array);
    let values: Vec<i32> = npyz::NpyFile::new(&bytes[..]).unwrap().into_vec().unwrap();
    values.chunks_exact(3).map(|v| [v[0], v[1], v[2]]).collect()
}

fn npy(file: &Path, array: &str) -> Vec<u8> {
    let mut zip = zip::ZipArchive::new(fs::File::open(file).unwrap()).unwrap();
    let mut bytes = Vec::new();
    zip.by_name(&format!("{array}.npy")).unwrap().read_to_end(&mut bytes).unwrap();
    bytes
}

fn summary(out: &Path) -> Vec<std::collections::HashMap<String, String>> {
    csv::Reader::from_path(out.join("summary.csv")).unwrap().deserialize().map(Result::unwrap).collect()
}

#[test]
fn the_built_in_world_writes_everything_and_the_counts_can_be_recomputed() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let output = evigrid(&["run", "--frames", "0..3", "--out", path(&out)]);
    assert!(output.status.success(), "{}", stderr(&output));
    let mut expected = vec![
        "config.toml",
        "curve.winner-take-all.csv",
        "frames.csv",
        "map.winner-take-all.npz",
        "run.json",
        "summary.csv",
        "summary.md",
        "summary.plan.csv",
        "timing.csv",
        "truth.npz",
    ];
    if cfg!(feature = "rerun") {
        expected.push("recording.rrd");
        expected.sort_unstable();
    }
    assert_eq!(names(&out), expected);
    assert!(stdout(&output).contains("| winner-take-all |"));

    // Hits and mistakes from the files alone.
    let log_odds: Vec<f32> = npyz::NpyFile::new(&npy(&out.join("map.winner-take-all.npz"), "log_odds")[..])
        .unwrap()
        .into_vec()
        .unwrap();
    let map = voxels(&out.join("map.winner-take-all.npz"), "indices");
    assert_eq!(map.len(), log_odds.len());
    let occupied: BTreeSet<_> =
        map.iter().zip(&log_odds).filter(|(_, l)| **l > 0.0).map(|(v, _)| *v).collect();
    let truth: BTreeSet<_> = voxels(&out.join("truth.npz"), "occupied").into_iter().collect();
    let observed: BTreeSet<_> = voxels(&out.join("truth.npz"), "observed").into_iter().collect();
    let hits = occupied.intersection(&truth).count();
    let mistakes: Vec<_> = occupied.difference(&truth).collect();
    let seen = mistakes.iter().filter(|v| observed.contains(**v)).count();
    let row = &summary(&out)[0];
    let number = |column: &str| row[column].parse::<usize>().unwrap();
    assert!(hits > 100, "{hits}");
    assert_eq!(number("hits"), hits);
    assert_eq!(number("mistakes"), mistakes.len());
    assert_eq!(number("mistakes_observed"), seen);
    assert_eq!(number("missed"), truth.len() - hits);
    assert_eq!(number("true_cells"), truth.len());

    // The last row of frames.csv says the same.
    let last =
        csv::Reader::from_path(out.join("frames.csv")).unwrap().into_records().last().unwrap().unwrap();
    assert_eq!((&last[2], &last[4]), ("2", &hits.to_string()[..]));
}

#[test]
fn threads_do_not_change_a_byte() {
    let dir = tempfile::tempdir().unwrap();
    let run = |threads: &str| {
        let out = dir.path().join(threads);
        let output =
            command(&["run", "--frames", "0..3", "--set", "output.recording=false", "--out", path(&out)])
                .env("RAYON_NUM_THREADS", threads)
                .output()
                .unwrap();
        assert!(output.status.success(), "{}", stderr(&output));
        out
    };
    let (one, two) = (run("1"), run("2"));
    for name in names(&one) {
        if name != "timing.csv" && name != "run.json" {
            assert!(
                fs::read(one.join(&name)).unwrap() == fs::read(two.join(&name)).unwrap(),
                "{name} differs"
            );
        }
    }
}

#[test]
fn the_written_settings_give_the_same_run_again() {
    let drive = TinyDrive::new(4);
    let (first, again) = (drive.root.path().join("first"), drive.root.path().join("again"));
    let more = ["--stride", "2", "--frames", "1..", "--set", "winner-take-all.peak_ratio=1.1"];
    assert!(drive.run(&first, &more).status.success());
    let config = first.join("config.toml");
    let output = evigrid(&["run", "--config", path(&config), "--out", path(&again)]);
    assert!(output.status.success(), "{}", stderr(&output));
    for name in ["config.toml", "summary.csv", "frames.csv", "map.winner-take-all.npz"] {
        assert!(fs::read(first.join(name)).unwrap() == fs::read(again.join(name)).unwrap(), "{name} differs");
    }
    assert_eq!(summary(&again)[0]["frames"], "2", "frames 1 and 3");
}

#[test]
fn a_frame_without_a_scan_is_mapped_but_not_in_the_reference() {
    let drive = TinyDrive::new(3);
    fs::remove_file(drive.scan(1)).unwrap();
    let out = drive.root.path().join("out");
    let output = drive.run(&out, &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    let row = &summary(&out)[0];
    assert_eq!((&row["frames"][..], &row["frames_without_laser"][..]), ("3", "1"));
    assert!(stdout(&output).contains("Frames without a laser scan (mapped, but not in the reference): 1."));
    let scans: Vec<_> = csv::Reader::from_path(out.join("frames.csv"))
        .unwrap()
        .into_deserialize::<std::collections::HashMap<String, String>>()
        .map(|row| row.unwrap()["scans"].clone())
        .collect();
    assert_eq!(scans, ["1", "1", "2"]);
}

#[test]
fn a_drive_without_laser_is_mapped_but_not_scored() {
    let drive = TinyDrive::new(2);
    fs::remove_dir_all(drive.dir().join("velodyne_points")).unwrap();
    let out = drive.root.path().join("out");
    let output = drive.run(&out, &[]);
    assert!(output.status.success(), "{}", stderr(&output));
    assert!(!names(&out).contains(&"truth.npz".to_owned()));
    assert_eq!(summary(&out)[0]["hits"], "");
    assert!(stdout(&output).contains("not scored"));
}

/// Files that only an earlier run wrote must not stand beside this one's tables.
#[test]
fn files_of_an_earlier_run_do_not_stay() {
    let drive = TinyDrive::new(2);
    let out = drive.root.path().join("out");
    assert!(drive.run(&out, &[]).status.success());
    assert!(names(&out).contains(&"truth.npz".to_owned()));
    fs::write(out.join("my_notes.txt"), "").unwrap();
    fs::remove_dir_all(drive.dir().join("velodyne_points")).unwrap();
    assert!(drive.run(&out, &[]).status.success());
    assert!(!names(&out).contains(&"truth.npz".to_owned()));
    assert!(names(&out).contains(&"my_notes.txt".to_owned()));
}

/// A run that fails at its last step leaves all files of the run before.
#[test]
fn a_run_that_fails_late_leaves_the_old_files() {
    let drive = TinyDrive::new(3);
    let out = drive.root.path().join("out");
    assert!(drive.run(&out, &["--frames", "0..1"]).status.success());
    let read = || names(&out).iter().map(|n| fs::read(out.join(n)).unwrap()).collect::<Vec<_>>();
    let before = read();
    fs::write(drive.scan(2), [0; 7]).unwrap();
    assert_eq!(drive.run(&out, &[]).status.code(), Some(2));
    assert!(read() == before);
}

#[test]
fn a_disparity_written_by_one_run_feeds_another() {
    let drive = TinyDrive::new(2);
    let (first, second) = (drive.root.path().join("first"), drive.root.path().join("second"));
    assert!(drive.run(&first, &["--set", "output.disparity=true"]).status.success());
    assert_eq!(names(&first.join("disparity")), ["0000000000.png", "0000000001.png"]);
    let input = format!("input.disparity_dir={}", path(&first.join("disparity")));
    let output = drive.run(&second, &["--set", &input, "--set", "output.disparity=true"]);
    assert!(output.status.success(), "{}", stderr(&output));
    for name in names(&first.join("disparity")) {
        let read = |out: &Path| image::open(out.join("disparity").join(&name)).unwrap().into_luma16();
        assert!(read(&first) == read(&second), "{name}");
    }
    let missing = drive.run(&second, &["--set", "input.disparity_dir=nowhere"]);
    assert_eq!(missing.status.code(), Some(2));
    assert!(stderr(&missing).contains("nowhere/0000000000.png"), "{}", stderr(&missing));
}

#[test]
fn a_killed_run_leaves_the_old_files_and_the_next_one_says_so() {
    let dir = tempfile::tempdir().unwrap();
    let out = dir.path().join("out");
    let args = |frames: &'static str| vec!["run", "--frames", frames, "--out", path(&out)];
    assert!(evigrid(&args("0..1")).status.success());
    let before: Vec<_> = names(&out).iter().map(|n| fs::read(out.join(n)).unwrap()).collect();
    let whole = names(&out);

    let mut run = command(&args("0..24")).stderr(std::process::Stdio::null()).spawn().unwrap();
    while !out.join("frames.csv.partial").exists() {
        assert!(run.try_wait().unwrap().is_none(), "the run ended before it could be killed");
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    run.kill().unwrap();
    run.wait().unwrap();
    for (name, bytes) in whole.iter().zip(&before) {
        assert!(fs::read(out.join(name)).unwrap() == *bytes, "{name} changed");
    }
    let output = evigrid(&args("0..1"));
    assert!(output.status.success());
    assert!(stderr(&output).contains("did not finish"), "{}", stderr(&output));
    assert!(stderr(&output).contains("frames.csv.partial"));
    assert_eq!(names(&out), whole);
}

#[test]
fn a_map_that_the_program_wrote_scores_the_same() {
    let drive = TinyDrive::new(3);
    let out = drive.root.path().join("out");
    assert!(drive.run(&out, &[]).status.success());
    let map = out.join("map.winner-take-all.npz");
    let dir = drive.dir();
    let args = ["score", path(&map), "--dataset", path(&dir), "--set", "grid.x_m=[0, 20]"];
    let output = evigrid(&args);
    assert!(output.status.success(), "{}", stderr(&output));
    let row = stdout(&output).lines().find(|l| l.starts_with("| map.winner-take-all |")).unwrap().to_owned();
    let cells: Vec<_> = row.split('|').map(str::trim).collect();
    let summary = &summary(&out)[0];
    assert_eq!(
        cells[2..6],
        [&summary["hits"], &summary["mistakes"], &summary["mistakes_observed"], &summary["missed"]]
    );
}

#[test]
fn the_list_of_methods_shows_every_setting() {
    let output = evigrid(&["methods"]);
    assert!(output.status.success());
    let text = stdout(&output);
    for part in ["winner-take-all.peak_ratio = 1.5", "grid.cell_size_m = 0.2 m", "truth.max_range_m = 80.0 m"]
    {
        assert!(text.contains(part), "{part} is missing");
    }
    for line in text.lines().filter(|l| l.trim_start().starts_with("Source:")) {
        assert!(line.trim().len() > "Source: ".len(), "a setting without a source");
    }
}
