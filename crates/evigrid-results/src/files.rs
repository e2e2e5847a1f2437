//! Names of the files of a run and of a sweep. Files are opened by these names, and nothing else in a results
//! folder is ever removed.

use evigrid_grid::LayerKind;

/// All settings of a run.
pub const CONFIG: &str = "config.toml";
/// Recording of a run for the Rerun viewer.
pub const RECORDING: &str = "recording.rrd";
/// Description of a run: data set, frames, methods, settings, build.
pub const RUN: &str = "run.json";
/// Scores of a run as a page that a person reads.
pub const SUMMARY_PAGE: &str = "summary.md";
/// Time and memory of every stage of every frame.
pub const TIMING: &str = "timing.csv";
/// True voxels of a run.
pub const TRUTH: &str = "truth.npz";
/// True safety labels of a run.
pub const SAFETY_TRUTH: &str = "truth.safety.npz";
/// Scores of safety maps by where the cells lie.
pub const SAFETY_PLACES: &str = "places.safety.csv";
/// Named hazards and safe areas in the safety maps of a run.
pub const HAZARDS: &str = "hazards.safety.csv";
/// Ground plans counted frame by frame: by distance, by probability, and over the threshold.
pub const PLAN_BANDS: &str = "bands.plan.csv";
/// See [`PLAN_BANDS`].
pub const PLAN_RELIABILITY: &str = "reliability.plan.csv";
/// See [`PLAN_BANDS`].
pub const PLAN_ROC: &str = "roc.plan.csv";
/// Hits against mistakes over the threshold, one file per method.
pub const CURVE: FileNames = FileNames { before: "curve.", after: ".csv" };
/// A safety map as a picture for ROS's map_server, one file per method.
pub const ROS_PICTURE: FileNames = FileNames { before: "map.", after: ".pgm" };
/// Where that picture lies, and what its grey levels mean.
pub const ROS_YAML: FileNames = FileNames { before: "map.", after: ".yaml" };
/// The 3-D model behind a safety map, one file per method.
pub const MODEL: FileNames = FileNames { before: "model.", after: ".ply" };

/// All points of a sweep with their scores.
pub const POINTS: &str = "points.csv";
/// A sweep as a page that a person reads.
pub const SWEEP_PAGE: &str = "sweep.md";
/// The plan of a sweep with every setting.
pub const SWEEP_PLAN: &str = "sweep.toml";
/// Curves of a sweep as a table, one file per data set.
pub const SWEEP_CURVES: FileNames = FileNames { before: "curves.", after: ".csv" };
/// Curves of a sweep as a picture, one file per data set.
pub const SWEEP_PICTURE: FileNames = FileNames { before: "curves.", after: ".svg" };

/// Names of files that differ in one part: a method or a data set.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct FileNames {
    before: &'static str,
    after: &'static str,
}

impl FileNames {
    /// The name of the file of a method or data set.
    pub fn of(self, name: &str) -> String {
        format!("{}{name}{}", self.before, self.after)
    }

    fn contain(self, file: &str) -> bool {
        file.strip_prefix(self.before).is_some_and(|rest| rest.ends_with(self.after))
    }
}

/// The table of all frames for one kind of layer.
pub fn frames(kind: LayerKind) -> &'static str {
    match kind {
        LayerKind::Voxels => "frames.csv",
        LayerKind::Plan => "frames.plan.csv",
        LayerKind::Safety => "frames.safety.csv",
    }
}

/// The table of final scores for one kind of layer.
pub fn summary(kind: LayerKind) -> &'static str {
    match kind {
        LayerKind::Voxels => "summary.csv",
        LayerKind::Plan => "summary.plan.csv",
        LayerKind::Safety => "summary.safety.csv",
    }
}

/// The final maps of one kind, one file per method.
pub fn map(kind: LayerKind) -> FileNames {
    let before = match kind {
        LayerKind::Voxels => "map.",
        LayerKind::Plan => "plan.",
        LayerKind::Safety => "safety.",
    };
    FileNames { before, after: ".npz" }
}

/// Whether runs write files of this name.
pub fn is_of_run(name: &str) -> bool {
    let of_layer = |kind| name == frames(kind) || name == summary(kind) || map(kind).contain(name);
    [CONFIG, RECORDING, RUN, SUMMARY_PAGE, TIMING, TRUTH, SAFETY_TRUTH, SAFETY_PLACES, HAZARDS]
        .contains(&name)
        || [PLAN_BANDS, PLAN_RELIABILITY, PLAN_ROC].contains(&name)
        || [CURVE, ROS_PICTURE, ROS_YAML, MODEL].iter().any(|names| names.contain(name))
        || LayerKind::ALL.into_iter().any(of_layer)
}

/// Whether sweeps write files of this name, beside the folders of their points.
pub fn is_of_sweep(name: &str) -> bool {
    [POINTS, SWEEP_PAGE, SWEEP_PLAN].contains(&name)
        || [SWEEP_CURVES, SWEEP_PICTURE].iter().any(|names| names.contain(name))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_name_is_ours_only_with_a_part_of_its_own() {
        for name in ["map.line.npz", "plan.a-b.npz", "curve.x.csv", "summary.plan.csv", "truth.safety.npz"] {
            assert!(is_of_run(name), "{name}");
        }
        for name in [
            "map.a-b.pgm",
            "map.a-b.yaml",
            "model.a-b.ply",
            "places.safety.csv",
            "hazards.safety.csv",
            "roc.plan.csv",
        ] {
            assert!(is_of_run(name), "{name}");
        }
        for name in [
            "map.npz",
            "map.pgm",
            "map.yaml",
            "map.line.csv",
            "curves.street.csv",
            "summary.line.csv",
            "plan.toml",
            "",
        ] {
            assert!(!is_of_run(name), "{name}");
        }
        assert!(is_of_sweep(&SWEEP_PICTURE.of("street")) && is_of_sweep("points.csv"));
        assert!(!is_of_sweep("curves.csv") && !is_of_sweep("frames.csv"));
    }
}
