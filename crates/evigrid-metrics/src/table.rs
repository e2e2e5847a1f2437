use crate::PlanTally;
use crate::base_rows::{COUNT, ERROR_RATE, RATE, REFERENCE, TIME};
use crate::metric::{Better, Metric, Of, Show, Tolerance};

/// Every metric of the program, in the order of the columns. A row here is all that a metric takes.
pub const METRICS: &[Metric] = &[
    Metric {
        name: "hits",
        better: Better::Higher,
        formula: "occupied and true",
        show: Show::Sweep("hits"),
        of: Of::Voxels(|c| c.counts.hits as f64),
        ..COUNT
    },
    Metric {
        name: "mistakes",
        formula: "occupied and not true",
        show: Show::Sweep("mistakes"),
        of: Of::Voxels(|c| c.counts.mistakes as f64),
        ..COUNT
    },
    // Of the other mistakes the laser knows nothing, so only these are judged.
    Metric {
        name: "mistakes_observed",
        judged: true,
        formula: "occupied, observed and not true: the mistakes that the reference can refute",
        show: Show::Table("of them observed"),
        of: Of::Voxels(|c| c.counts.mistakes_observed as f64),
        ..COUNT
    },
    Metric {
        name: "missed",
        formula: "true and not occupied",
        show: Show::Table("missed"),
        of: Of::Voxels(|c| c.counts.missed() as f64),
        ..COUNT
    },
    Metric {
        name: "precision",
        formula: "hits / (hits + mistakes)",
        show: Show::Sweep("precision"),
        of: Of::Voxels(|c| c.counts.precision()),
        ..RATE
    },
    Metric {
        name: "recall",
        formula: "hits / (hits + missed)",
        show: Show::Sweep("recall"),
        of: Of::Voxels(|c| c.counts.recall()),
        ..RATE
    },
    Metric {
        name: "f1",
        formula: "2 hits / (2 hits + mistakes + missed)",
        show: Show::Main("F1"),
        of: Of::Voxels(|c| c.counts.f1()),
        ..RATE
    },
    Metric {
        name: "true_cells",
        formula: "true cells of the reference",
        show: Show::Table("occupied cells"),
        of: Of::Voxels(|c| c.reference.true_cells() as f64),
        ..REFERENCE
    },
    Metric {
        name: "observed_cells",
        formula: "observed cells of the reference",
        show: Show::Table("observed"),
        of: Of::Voxels(|c| c.reference.observed_cells() as f64),
        ..REFERENCE
    },
    Metric {
        name: "missed_unknown",
        formula: "those of the missed that the map never touched",
        of: Of::Voxels(|c| c.counts.missed_unknown as f64),
        ..COUNT
    },
    Metric {
        name: "touched",
        better: Better::Neither,
        formula: "cells that the map has touched",
        of: Of::Voxels(|c| c.counts.touched as f64),
        ..COUNT
    },
    Metric {
        name: "precision_observed",
        formula: "hits / (hits + mistakes_observed)",
        of: Of::Voxels(|c| c.counts.precision_observed()),
        ..RATE
    },
    Metric {
        name: "f1_observed",
        formula: "2 hits / (2 hits + mistakes_observed + missed)",
        of: Of::Voxels(|c| c.counts.f1_observed()),
        ..RATE
    },
    Metric {
        name: "true_cells_in_view",
        formula: "true cells that hold a return of the laser which projects into the left image of its frame, at \
                  truth.view_depth_m",
        of: Of::Voxels(|c| c.reference.true_cells_in_view().map_or(f64::NAN, |n| n as f64)),
        ..REFERENCE
    },
    Metric {
        name: "recall_in_view",
        formula: "hits / (hits + missed cells in view)",
        of: Of::Voxels(|c| if c.reference.in_view.is_some() { c.counts.recall_in_view() } else { f64::NAN }),
        ..RATE
    },
    Metric {
        name: "f1_in_view",
        formula: "2 hits / (2 hits + mistakes_observed + missed cells in view)",
        show: Show::Table("F1 in view"),
        of: Of::Voxels(|c| if c.reference.in_view.is_some() { c.counts.f1_in_view() } else { f64::NAN }),
        ..RATE
    },
    Metric {
        name: "accuracy",
        formula: "share of the occupied cells with a true cell within T metres (centre to centre)",
        of: Of::VoxelsWithin(|t| t.accuracy),
        ..RATE
    },
    Metric {
        name: "completeness",
        formula: "share of the true cells with an occupied cell within T metres",
        of: Of::VoxelsWithin(|t| t.completeness),
        ..RATE
    },
    Metric {
        name: "f_score",
        formula: "harmonic mean of accuracy and completeness (Knapitsch et al. 2017, Tanks and Temples)",
        show: Show::Table("F within {} m"),
        of: Of::VoxelsWithin(|t| t.f_score),
        ..RATE
    },
    Metric {
        name: "curve_area",
        formula: "area under hits over mistakes, from 0 to as many mistakes as there are true cells, \
                  divided by that number squared",
        show: Show::Table("curve area"),
        of: Of::VoxelsAtEnd(|_, curve| curve.area()),
        ..RATE
    },
    Metric {
        name: "average_precision",
        formula: "sum over the thresholds of the rise in recall times the precision there",
        of: Of::VoxelsAtEnd(|_, curve| curve.average_precision()),
        ..RATE
    },
    Metric {
        name: "plan_hits",
        better: Better::Higher,
        formula: "occupied and true",
        show: Show::Sweep("hits"),
        of: Of::Plan(|c| c.counts.hits as f64),
        ..COUNT
    },
    Metric {
        name: "plan_mistakes",
        formula: "occupied, and free in the reference",
        show: Show::Sweep("mistakes"),
        of: Of::Plan(|c| c.counts.mistakes as f64),
        ..COUNT
    },
    Metric {
        name: "plan_missed",
        formula: "true and not occupied, or true where the plan has no cell",
        show: Show::Table("missed"),
        of: Of::Plan(|c| c.counts.missed as f64),
        ..COUNT
    },
    Metric {
        name: "plan_precision",
        formula: "plan_hits / (plan_hits + plan_mistakes)",
        show: Show::Sweep("precision"),
        of: Of::Plan(|c| c.counts.precision()),
        ..RATE
    },
    Metric {
        name: "plan_recall",
        formula: "plan_hits / (plan_hits + plan_missed)",
        show: Show::Sweep("recall"),
        of: Of::Plan(|c| c.counts.recall()),
        ..RATE
    },
    Metric {
        name: "plan_f1",
        formula: "2 plan_hits / (2 plan_hits + plan_mistakes + plan_missed)",
        show: Show::Main("F1"),
        of: Of::Plan(|c| c.counts.f1()),
        ..RATE
    },
    Metric {
        name: "plan_auc",
        formula: "chance that a true cell of the plan has a higher P than a free one; ties count half, \
                  a cell of which the plan knows nothing has P = 0.5",
        show: Show::Table("AUC"),
        of: Of::Plan(|c| c.auc()),
        ..RATE
    },
    Metric {
        name: "plan_frames_auc",
        formula: "as plan_auc, over the plans of all frames, each against the laser of its own frame, on the cells \
                  within 20 m that the laser knows and the camera looks at",
        show: Show::Table("AUC, frame by frame"),
        of: Of::PlanFrames(|t| t.all().auc()),
        ..RATE
    },
    Metric {
        name: "plan_frames_auc_off_borders",
        formula: "plan_frames_auc without free cells that have an occupied one beside them",
        of: Of::PlanFrames(|t| t.all().auc_off_borders()),
        ..RATE
    },
    Metric {
        name: "plan_frames_band_f1",
        formula: "mean over the bands of 5 m up to 20 m of the best F1 that a threshold of its own gives each",
        show: Show::Table("F1 by bands"),
        of: Of::PlanFrames(PlanTally::band_mean_f1),
        ..RATE
    },
    Metric {
        name: "plan_frames_average_precision",
        formula: "sum over the thresholds of the rise in recall times the precision there, cells as plan_frames_auc",
        of: Of::PlanFrames(|t| t.all().average_precision()),
        ..RATE
    },
    Metric {
        name: "plan_frames_log_loss",
        formula: "mean of -log P of what is so, P within 0.001 and 0.999, cells as plan_frames_auc; 0.693 for a plan \
                  that knows nothing",
        show: Show::Table("log loss"),
        of: Of::PlanFrames(|t| t.all().log_loss()),
        ..ERROR_RATE
    },
    Metric {
        name: "plan_frames_brier",
        formula: "mean square of P - truth (Brier 1950), cells as plan_frames_auc; 0.25 for a plan that knows nothing",
        of: Of::PlanFrames(|t| t.all().brier()),
        ..ERROR_RATE
    },
    Metric {
        name: "safety_fn_rate",
        formula: "FN / (FN + TP): of the unsafe cells that the map classifies, those taken for safe",
        show: Show::Sweep("unsafe taken for safe"),
        of: Of::Safety(|c| c.strict.false_negative_rate()),
        ..ERROR_RATE
    },
    Metric {
        name: "safety_fp_rate",
        formula: "FP / (FP + TN): of the safe cells that the map classifies, those taken for unsafe",
        show: Show::Sweep("safe taken for unsafe"),
        of: Of::Safety(|c| c.strict.false_positive_rate()),
        ..ERROR_RATE
    },
    Metric {
        name: "safety_unclassified",
        formula: "share of the cells in reach that the truth classifies and the map does not",
        show: Show::Sweep("unclassified"),
        of: Of::Safety(|c| c.strict.unclassified_rate()),
        ..ERROR_RATE
    },
    // The main one: both rates above are perfect for a map that classifies next to nothing, this one is not.
    Metric {
        name: "safety_unsafe_found",
        formula: "TP / all unsafe cells of the truth in reach",
        show: Show::Main("unsafe found"),
        of: Of::Safety(|c| c.strict.unsafe_found()),
        ..RATE
    },
    Metric {
        name: "safety_fn_rate_off_borders",
        formula: "safety_fn_rate without cells next to a border between truly safe and unsafe ones",
        show: Show::Table("unsafe taken for safe, off borders"),
        of: Of::Safety(|c| c.beside_borders.false_negative_rate()),
        ..ERROR_RATE
    },
    Metric {
        name: "safety_fp_rate_off_borders",
        formula: "safety_fp_rate without cells next to a border between truly safe and unsafe ones",
        show: Show::Table("safe taken for unsafe, off borders"),
        of: Of::Safety(|c| c.beside_borders.false_positive_rate()),
        ..ERROR_RATE
    },
    Metric {
        name: "safety_inclined_found",
        formula: "of the truly inclined cells that the map classifies, those inclined in the map",
        show: Show::Table("inclined found"),
        of: Of::Safety(|c| c.inclined_rate()),
        ..RATE
    },
    Metric {
        name: "safety_plane_angle_deg",
        unit: "deg",
        tolerance: Tolerance { amount: 0.05, share: 0.0 },
        formula: "mean angle between the normal of a safe plane and that of the true plane below most of its cells",
        show: Show::Table("planes, deg"),
        of: Of::Safety(|c| c.planes().mean_angle_deg()),
        ..ERROR_RATE
    },
    Metric {
        name: "safety_plane_distance_cm",
        unit: "cm",
        tolerance: Tolerance { amount: 0.05, share: 0.0 },
        formula: "mean distance of a safe plane, at the centres of its cells, from the true plane below most of them",
        show: Show::Table("planes, cm"),
        of: Of::Safety(|c| c.planes().mean_distance_cm()),
        ..ERROR_RATE
    },
    Metric {
        name: "safety_inclined_plane_angle_deg",
        unit: "deg",
        tolerance: Tolerance { amount: 0.05, share: 0.0 },
        formula: "safety_plane_angle_deg over truly inclined planes",
        of: Of::Safety(|c| c.inclined_planes.mean_angle_deg()),
        ..ERROR_RATE
    },
    Metric { name: "read_ms", formula: "decoding a frame", ..TIME },
    Metric { name: "match_ms", formula: "matching a frame", ..TIME },
    Metric { name: "integrate_ms", formula: "mapping a frame, per method", ..TIME },
    Metric { name: "truth_ms", formula: "adding a frame to the reference", ..TIME },
    Metric { name: "score_ms", formula: "scoring after a frame, per method", ..TIME },
    Metric {
        name: "peak_memory_mib",
        unit: "MiB",
        tolerance: Tolerance { amount: 4.0, share: 0.2 },
        formula: "peak memory of the whole process",
        ..TIME
    },
];
