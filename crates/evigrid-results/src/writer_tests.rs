use std::fs;
use std::path::Path;

use evigrid_grid::{Layer, LayerKind};
use evigrid_metrics::{Scores, VoxelReference};
use serde_json::{Value, json};

use crate::npz::Npz;
use crate::test_run::{OBSERVED, OCCUPIED, hybrid, info, plan, result, safety, safety_scores, voxels};
use crate::{
    FrameRow, Kept, MethodMaps, ResultsFolder, ResultsWriter, RunInfo, RunResult, StageTime, TruthFile,
    has_maps,
};

/// Writes the run of the tests, with one frame.
fn write(dir: &Path, info: &RunInfo, result: &RunResult, kept: Kept) {
    let (folder, _) = ResultsFolder::open(dir).unwrap();
    let mut writer = ResultsWriter::create(&folder, info, json!({ "commit": "c0ffee" }), kept).unwrap();
    let (voxels, plan, safety) = (voxels(), plan(), safety());
    let truth = VoxelReference { spec: &info.spec, occupied: &OCCUPIED, observed: &OBSERVED, in_view: None };
    let scores = [Scores::voxels(voxels.values(), &truth, &info.tolerances_m), safety_scores()];
    let frame = FrameRow {
        frame: 2,
        stamp_ns: 100_000_000,
        scans: 1,
        matched_pixels: 7,
        scores: vec![&scores[..1], &scores],
    };
    writer.frame(&frame).unwrap();
    let time = |method, stage, ms| StageTime { frame: 2, method, stage, ms };
    writer.times(&[time(None, "match", 1.25), time(Some(1), "integrate", 0.5)], Some(12.34)).unwrap();
    let layers = [vec![Layer::from(&voxels)], vec![(&voxels).into(), (&plan).into(), (&safety).into()]];
    let mut maps = layers.map(MethodMaps::from);
    maps[1].hybrid = Some(hybrid());
    let truth = TruthFile { voxels: Some(truth), safety: Some(&safety) };
    folder.publish(writer.finish(result, &maps, Some(truth)).unwrap()).unwrap();
}

fn names(dir: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(dir).unwrap().map(|e| e.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

const ALL: Kept = Kept { frames: true, maps: true };

#[test]
fn every_file_is_written() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), &info(), &result(), ALL);
    let expected = "config.toml curve.all.csv curve.line.csv frames.csv frames.plan.csv frames.safety.csv \
        hazards.safety.csv map.all.npz map.all.pgm map.all.yaml map.line.npz model.all.ply places.safety.csv \
        plan.all.npz run.json safety.all.npz summary.csv summary.md \
        summary.plan.csv summary.safety.csv timing.csv truth.npz truth.safety.npz";
    assert_eq!(names(dir.path()).join(" "), expected);
    assert!(has_maps(dir.path(), &info()));
    fs::remove_file(dir.path().join("plan.all.npz")).unwrap();
    assert!(!has_maps(dir.path(), &info()));
}

#[test]
fn tables_of_frames() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), &info(), &result(), ALL);
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    let scores = "1,1,1,1,0.500000,0.500000,0.500000,2,4,0,3,0.500000,0.500000,,,,1.000000,1.000000,1.000000";
    assert_eq!(
        read("frames.csv"),
        format!(
            "dataset,method,frame,stamp_ns,hits,mistakes,mistakes_observed,missed,precision,recall,f1,\
             true_cells,observed_cells,missed_unknown,touched,precision_observed,f1_observed,true_cells_in_view,\
             recall_in_view,f1_in_view,accuracy_0.2m,\
             completeness_0.2m,f_score_0.2m,scans,matched_pixels\n\
             yard,line,2,100000000,{scores},1,7\nyard,all,2,100000000,{scores},1,7\n"
        )
    );
    assert_eq!(
        read("frames.safety.csv"),
        "dataset,method,frame,stamp_ns,\
         safety_fn_rate,safety_fp_rate,safety_unclassified,safety_unsafe_found,\
         safety_fn_rate_off_borders,safety_fp_rate_off_borders,safety_inclined_found,\
         safety_plane_angle_deg,safety_plane_distance_cm,safety_inclined_plane_angle_deg\n\
         yard,all,2,100000000,0.000000,,0.000000,1.000000,0.000000,,,,,\n"
    );
    assert!(
        read("frames.plan.csv").ends_with("plan_auc\nyard,all,2,100000000,,,,,,,\n"),
        "no plan scores yet"
    );
    assert_eq!(
        read("timing.csv"),
        "frame,method,stage,ms,peak_memory_mib\n2,,match,1.250,12.3\n2,all,integrate,0.500,12.3\n"
    );
}

#[test]
fn tables_of_final_scores() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), &info(), &result(), ALL);
    let read = |name: &str| fs::read_to_string(dir.path().join(name)).unwrap();
    let scores = "1,1,1,1,0.500000,0.500000,0.500000,2,4,0,3,0.500000,0.500000,,,,1.000000,1.000000,1.000000,\
        0.500000,0.583333";
    assert_eq!(
        read("summary.csv"),
        format!(
            "dataset,method,frames,hits,mistakes,mistakes_observed,missed,precision,recall,f1,true_cells,\
             observed_cells,missed_unknown,touched,precision_observed,f1_observed,true_cells_in_view,recall_in_view,f1_in_view,accuracy_0.2m,\
             completeness_0.2m,f_score_0.2m,curve_area,average_precision,frames_without_laser\n\
             yard,line,2,{scores},1\nyard,all,2,{scores},1\n"
        )
    );
    let row = "1,0,1,1.000000,0.500000,0.666667,0.750000,,,,,,";
    assert_eq!(
        read("summary.plan.csv"),
        format!(
            "dataset,method,frames,plan_hits,plan_mistakes,plan_missed,plan_precision,plan_recall,plan_f1,\
             plan_auc,plan_frames_auc,plan_frames_auc_off_borders,plan_frames_band_f1,\
             plan_frames_average_precision,plan_frames_log_loss,plan_frames_brier\nyard,line,2,{row}\nyard,all,2,{row}\n"
        )
    );
    assert!(
        read("summary.safety.csv")
            .ends_with("\nyard,line,2,,,,,,,,,,\nyard,all,2,0.000000,,0.000000,1.000000,0.000000,,,,,\n")
    );
    assert_eq!(
        read("hazards.safety.csv"),
        "dataset,method,area,kind,cells,nearest_m,right_at_nearest,wrong_at_nearest,right,wrong,first_m,half_m\n\
         yard,all,kerb,step,1,0.000,1.000000,0.000000,1.000000,0.000000,0.000,0.000\n"
    );
    let places = read("places.safety.csv");
    let lines: Vec<&str> = places.lines().collect();
    assert_eq!(
        lines[..2],
        [
            "dataset,method,place,from_m,to_m,true_positives,false_positives,true_negatives,false_negatives,\
             unclassified_safe,unclassified_unsafe,fn_rate,fp_rate,unclassified",
            "yard,all,ring around the robot,0.000,1.000,1,0,0,0,0,0,0.000000,,0.000000",
        ]
    );
    let curve = read("curve.line.csv");
    let lines: Vec<&str> = curve.lines().collect();
    assert_eq!(lines.len(), 102);
    assert_eq!(lines[0], "threshold,threshold_log_odds,hits,mistakes,precision,recall");
    assert_eq!(lines[1], "0.993307,5.0,0,0,,0.000000");
    assert_eq!(lines[51], "0.500000,0.0,1,1,0.500000,0.500000");
}

#[test]
fn config_and_run_say_how_it_was_made() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), &info(), &result(), ALL);
    assert_eq!(fs::read_to_string(dir.path().join("config.toml")).unwrap(), "[grid]\n");
    let run: Value = serde_json::from_slice(&fs::read(dir.path().join("run.json")).unwrap()).unwrap();
    assert_eq!(
        run,
        json!({
            "format": 1,
            "build": { "commit": "c0ffee" },
            "dataset": "yard",
            "layout": "synthetic",
            "frames": { "first": 0, "last": 2, "count": 2, "stride": 2, "without_laser": [2] },
            "methods": ["line", "all"],
            "settings_hash": "00ff",
            "settings": { "grid": { "cell_size_m": 0.2 }, "truth": { "source": "laser" } },
        })
    );
}

#[test]
fn truth_and_maps_are_voxels_and_labels() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), &info(), &result(), ALL);
    let read = |file: &str, array: &str| {
        let bytes = fs::read(dir.path().join(file)).unwrap();
        Npz::new(&bytes).unwrap().array(array).unwrap().values
    };
    assert_eq!(read("truth.npz", "occupied"), [0.0, 0.0, 0.0, 2.0, 0.0, 0.0]);
    assert_eq!(read("truth.npz", "observed").len(), 12);
    assert_eq!(read("map.all.npz", "log_odds"), [1.0, 2.0, -1.0]);
    assert_eq!(read("plan.all.npz", "probability")[0], 0.75);
    assert_eq!(read("safety.all.npz", "labels"), read("truth.safety.npz", "labels"));
}

/// A point of a sweep keeps no frames, and maps only where they are asked for; without scores there is no
/// table of their kind.
#[test]
fn what_is_not_kept_is_not_written() {
    let dir = tempfile::tempdir().unwrap();
    write(dir.path(), &info(), &result(), ALL);
    let mut unscored = result();
    unscored.methods.iter_mut().for_each(|method| (method.scores, method.safety) = (Vec::new(), None));
    let kept = Kept { frames: false, maps: false };
    write(dir.path(), &info(), &unscored, kept);
    let expected = ["config.toml", "curve.all.csv", "curve.line.csv", "run.json", "summary.csv"];
    assert_eq!(names(dir.path()), expected, "nothing of the run before is left");
    let summary = fs::read_to_string(dir.path().join("summary.csv")).unwrap();
    assert_eq!(summary.lines().nth(1).unwrap(), format!("yard,line,2{},1", ",".repeat(21)));
    assert_eq!(fs::read_to_string(dir.path().join("curve.line.csv")).unwrap().lines().count(), 1);
}

#[test]
fn a_layer_that_is_missing_is_named() {
    let dir = tempfile::tempdir().unwrap();
    let (folder, _) = ResultsFolder::open(dir.path()).unwrap();
    let writer = ResultsWriter::create(&folder, &info(), Value::Null, ALL).unwrap();
    let map = voxels();
    let maps = [vec![Layer::from(&map)], vec![Layer::from(&map)]].map(MethodMaps::from);
    let error = writer.finish(&result(), &maps, None).unwrap_err().to_string();
    assert_eq!(error, format!("all: expected {}, found none", LayerKind::Plan.name()));
    assert!(names(dir.path()).is_empty(), "a run that fails leaves nothing behind");
}
