//! Scores against brute force and against numbers worked out by hand.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_grid::{GridSettings, GridSpec, LayerKind};
use evigrid_metrics::{Score, Scores, VoxelReference, count, curve, within_tolerance};
use proptest::prelude::*;

fn spec() -> GridSpec {
    let settings = GridSettings { x_m: [0.0, 1.2], y_m: [0.0, 0.8], z_m: [0.0, 0.6], cell_size_m: 0.2 };
    GridSpec::new(&settings).unwrap()
}

fn row_of(cells: usize) -> GridSpec {
    let settings =
        GridSettings { x_m: [0.0, 0.2 * cells as f64], y_m: [0.0, 0.2], z_m: [0.0, 0.2], cell_size_m: 0.2 };
    GridSpec::new(&settings).unwrap()
}

/// A row of five cells: hit, mistake seen by the laser, mistake unseen, missed as free, missed unseen.
#[test]
fn counts_by_hand() {
    let map = [1.0, 0.1, 2.0, -1.0, f32::NAN, 0.0];
    let reference = VoxelReference {
        spec: &spec(),
        occupied: &[true, false, false, true, true, false],
        observed: &[true, true, false, true, true, true],
        in_view: None,
    };
    let c = count(&map, &reference);
    assert_eq!((c.hits, c.mistakes, c.mistakes_observed), (1, 2, 1));
    assert_eq!((c.missed(), c.missed_free, c.missed_unknown, c.touched), (2, 1, 1, 5));
    assert!((c.precision() - 1.0 / 3.0).abs() < 1e-15 && (c.recall() - 1.0 / 3.0).abs() < 1e-15);
    assert!((c.f1() - 1.0 / 3.0).abs() < 1e-15);
    let (precision, f1) = (c.precision_observed(), c.f1_observed());
    assert!((precision - 0.5).abs() < 1e-15 && (f1 - 0.4).abs() < 1e-15);
    // Of the two missed cells the camera could see one.
    let in_view = [true, false, false, false, true, true];
    let seen = VoxelReference { in_view: Some(&in_view), ..reference };
    let c = count(&map, &seen);
    assert_eq!((c.missed(), c.missed_in_view, seen.true_cells_in_view()), (2, 1, Some(2)));
    // 1 hit, 1 mistake observed, 1 missed in view.
    assert!((c.recall_in_view() - 0.5).abs() < 1e-15 && (c.f1_in_view() - 0.5).abs() < 1e-15);
    assert_eq!((count(&map, &reference).missed_in_view, reference.true_cells_in_view()), (0, None));
}

#[test]
fn an_empty_map_has_no_precision_but_an_f1_of_zero() {
    let reference =
        VoxelReference { spec: &spec(), occupied: &[true, false], observed: &[true, true], in_view: None };
    let c = count(&[f32::NAN, -1.0], &reference);
    assert!(c.precision().is_nan());
    assert_eq!((c.recall(), c.f1()), (0.0, 0.0));
    assert_eq!(c.f1_observed(), 0.0);
    let tolerant = within_tolerance(&[f32::NAN, -1.0], &reference, 0.0);
    assert!(tolerant.accuracy.is_nan());
    assert_eq!((tolerant.completeness, tolerant.f_score), (0.0, 0.0));
}

#[test]
fn the_curve_by_hand() {
    // By falling threshold: hit at 3, mistake at 2, hit at 1; one true cell is never found, one mistake below
    // -4.
    let map = [3.05, 2.05, 1.05, f32::NAN, -4.05];
    let occupied = [true, false, true, true, false];
    let curve = curve(
        &map,
        &VoxelReference { spec: &spec(), occupied: &occupied, observed: &[true; 5], in_view: None },
    );
    let at = |threshold: f32| *curve.points.iter().find(|p| p.log_odds == threshold).unwrap();
    assert_eq!((at(4.0).hits, at(4.0).mistakes), (0, 0));
    assert_eq!((at(3.0).hits, at(3.0).mistakes), (1, 0));
    assert_eq!((at(2.0).hits, at(2.0).mistakes), (1, 1));
    assert_eq!((at(0.0).hits, at(0.0).mistakes), (2, 1));
    assert_eq!((at(-5.0).hits, at(-5.0).mistakes), (2, 2));
    // Hits over mistakes: up to 1 at 0 mistakes, level to 1 mistake, up to 2, level to the end at 3 mistakes.
    assert!((curve.area() - (1.0 + 2.0 + 2.0) / 9.0).abs() < 1e-12, "{}", curve.area());
    // Recall rises by a third at precision 1 and by a third at precision 2/3.
    assert!((curve.average_precision() - (1.0 + 2.0 / 3.0) / 3.0).abs() < 1e-12);
}

#[test]
fn the_area_is_cut_where_mistakes_outnumber_the_truth() {
    // One true cell found at 2, together with four mistakes: the line to (4, 1) is cut at one mistake.
    let reference = VoxelReference {
        spec: &spec(),
        occupied: &[true, false, false, false, false],
        observed: &[true; 5],
        in_view: None,
    };
    let curve = curve(&[2.05; 5], &reference);
    assert!((curve.area() - 0.5 * 0.25).abs() < 1e-12, "{}", curve.area());
}

fn cells() -> impl Strategy<Value = (Vec<f32>, Vec<bool>)> {
    let n = spec().cell_count();
    let log_odds = prop_oneof![Just(f32::NAN), Just(-1.0_f32), Just(0.0), Just(0.8)];
    let sparse = prop::bool::weighted(0.1);
    (prop::collection::vec(log_odds, n), prop::collection::vec(sparse, n))
}

proptest! {
    #[test]
    fn tolerance_equals_all_pairs(
        (map, truth) in cells(),
        tolerance in prop_oneof![Just(0.2), Just(0.4), Just(0.35)],
    ) {
        let spec = spec();
        let observed = vec![true; truth.len()];
        let reference = VoxelReference { spec: &spec, occupied: &truth, observed: &observed, in_view: None };
        let found = within_tolerance(&map, &reference, tolerance);
        let distance = |a: usize, b: usize| {
            let (a, b) = (spec.centre_m(a), spec.centre_m(b));
            (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
        };
        let occupied: Vec<_> = (0..map.len()).filter(|&i| map[i] > 0.0).collect();
        let truths: Vec<_> = (0..map.len()).filter(|&i| truth[i]).collect();
        let share = |from: &[usize], to: &[usize]| {
            let near = from.iter().filter(|&&a| to.iter().any(|&b| distance(a, b) <= tolerance + 1e-9));
            near.count() as f64 / from.len() as f64
        };
        let (accuracy, completeness) = (share(&occupied, &truths), share(&truths, &occupied));
        let same = |a: f64, b: f64| a == b || a.is_nan() && b.is_nan();
        prop_assert!(same(found.accuracy, accuracy), "{} {accuracy}", found.accuracy);
        prop_assert!(same(found.completeness, completeness), "{} {completeness}", found.completeness);
    }
}

/// Larger than one task's share, with the occupied cells spread over all tasks.
#[test]
fn large_grids_equal_a_plain_loop() {
    let settings = GridSettings { x_m: [0.0, 8.0], y_m: [0.0, 8.0], z_m: [0.0, 6.0], cell_size_m: 0.2 };
    let spec = GridSpec::new(&settings).unwrap();
    let n = spec.cell_count();
    assert!(n > 40_000);
    let hash = |i: usize, salt: u64| (i as u64 + salt).wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 40;
    let map: Vec<f32> = (0..n)
        .map(|i| match hash(i, 1) % 100 {
            0..2 => 1.5,
            2..30 => -0.5,
            _ => f32::NAN,
        })
        .collect();
    let occupied: Vec<bool> = (0..n).map(|i| hash(i, 7) % 100 < 2).collect();
    let observed: Vec<bool> = (0..n).map(|i| hash(i, 9) % 2 == 0).collect();
    let reference = VoxelReference { spec: &spec, occupied: &occupied, observed: &observed, in_view: None };

    let counts = count(&map, &reference);
    let number = |holds: &dyn Fn(usize) -> bool| (0..n).filter(|&i| holds(i)).count();
    assert_eq!(counts.hits, number(&|i| map[i] > 0.0 && occupied[i]));
    assert_eq!(counts.mistakes, number(&|i| map[i] > 0.0 && !occupied[i]));
    assert_eq!(counts.mistakes_observed, number(&|i| map[i] > 0.0 && !occupied[i] && observed[i]));
    assert_eq!(counts.missed_free, number(&|i| map[i] <= 0.0 && occupied[i]));
    assert_eq!(counts.missed_unknown, number(&|i| map[i].is_nan() && occupied[i]));
    assert_eq!(counts.touched, number(&|i| !map[i].is_nan()));

    let near = |from: &[usize], to: &[usize]| {
        let distance = |a: usize, b: usize| {
            let (a, b) = (spec.centre_m(a), spec.centre_m(b));
            (0..3).map(|i| (a[i] - b[i]).powi(2)).sum::<f64>().sqrt()
        };
        let found = from.iter().filter(|&&a| to.iter().any(|&b| distance(a, b) <= 0.4 + 1e-9)).count();
        found as f64 / from.len() as f64
    };
    let ours: Vec<usize> = (0..n).filter(|&i| map[i] > 0.0).collect();
    let truths: Vec<usize> = (0..n).filter(|&i| occupied[i]).collect();
    let tolerant = within_tolerance(&map, &reference, 0.4);
    assert_eq!(tolerant.accuracy, near(&ours, &truths));
    assert_eq!(tolerant.completeness, near(&truths, &ours));
}

/// The columns that results of all versions have, in their order.
#[test]
fn columns_keep_their_names_and_order() {
    let after_a_frame = "hits,mistakes,mistakes_observed,missed,precision,recall,f1,\
        true_cells,observed_cells,missed_unknown,touched,precision_observed,f1_observed,\
        true_cells_in_view,recall_in_view,f1_in_view,\
        accuracy_0.2m,completeness_0.2m,f_score_0.2m,accuracy_1m,completeness_1m,f_score_1m";
    let columns = |at_end| Scores::columns(LayerKind::Voxels, &[0.2, 1.0], at_end).join(",");
    assert_eq!(columns(false), after_a_frame);
    assert_eq!(columns(true), format!("{after_a_frame},curve_area,average_precision"));
}

#[test]
fn the_table_says_what_its_parts_say() {
    let map = [1.0, 0.1, 2.0, -1.0, f32::NAN, 0.0];
    let reference = VoxelReference {
        spec: &row_of(6),
        occupied: &[true, false, false, true, true, false],
        observed: &[true, true, false, true, true, true],
        in_view: None,
    };
    let scores = Scores::voxels_at_end(&map, &reference, &[0.2]);
    let columns: Vec<String> = scores.list.iter().map(Score::column).collect();
    assert_eq!(columns, Scores::columns(LayerKind::Voxels, &[0.2], true));
    let after_a_frame: Vec<String> =
        Scores::voxels(&map, &reference, &[0.2]).list.iter().map(Score::column).collect();
    assert_eq!(after_a_frame, Scores::columns(LayerKind::Voxels, &[0.2], false));
    let (counts, tolerant) = (count(&map, &reference), within_tolerance(&map, &reference, 0.2));
    let curve = curve(&map, &reference);
    for (column, value) in [
        ("hits", 1.0),
        ("mistakes", 2.0),
        ("mistakes_observed", 1.0),
        ("missed", 2.0),
        ("precision", counts.precision()),
        ("recall", counts.recall()),
        ("f1", counts.f1()),
        ("true_cells", 3.0),
        ("observed_cells", 5.0),
        ("missed_unknown", 1.0),
        ("touched", 5.0),
        ("precision_observed", 0.5),
        ("f1_observed", 0.4),
        ("accuracy_0.2m", tolerant.accuracy),
        ("completeness_0.2m", tolerant.completeness),
        ("f_score_0.2m", tolerant.f_score),
        ("curve_area", curve.area()),
        ("average_precision", curve.average_precision()),
    ] {
        assert_eq!(scores.get(column), Some(value), "{column}");
    }
    assert_eq!(scores.get("f_score"), None, "a tolerant score has a distance");
    assert_eq!(scores.main().unwrap().metric.name, "f1");
    assert_eq!(scores.curve, Some(curve));
}

#[test]
fn cells_and_headings() {
    let reference =
        VoxelReference { spec: &row_of(2), occupied: &[true, false], observed: &[true, true], in_view: None };
    let scores = Scores::voxels_at_end(&[f32::NAN, -1.0], &reference, &[0.2]);
    let cell = |column| scores.score(column).unwrap().cell();
    assert_eq!(cell("hits"), "0");
    assert_eq!(cell("recall"), "0.000000");
    assert_eq!(cell("precision"), "", "0 / 0");
    let score = scores.score("f_score_0.2m").unwrap();
    assert_eq!((score.heading().unwrap(), score.shown()), ("F within 0.2 m".into(), "0.000".into()));
    assert_eq!(scores.score("touched").unwrap().heading(), None);
}
