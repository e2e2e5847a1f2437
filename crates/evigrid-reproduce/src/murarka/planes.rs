//! Section VII-C: angle and distance between the planes of safe ground in a map and the true ones, in five random
//! frames of each data set, and in all frames.

use anyhow::Result;
use evigrid_core::stable_hash;
use evigrid_metrics::{PlaneErrors, SafetyCase};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::journeys::{entries, whole};
use super::published::PLANES;
use super::worlds::{Entry, WORLDS};
use crate::chart::{Axis, BLUE, Corner, DARK, GREY, Marks, ORANGE, Panel, Point, Series, Sheet, rectangle};
use crate::job::Job;
use crate::journey::Journey;
use crate::table::rounded;

/// Frames of each world that the paper draws.
const DRAWN: usize = 5;
/// Seed of the draw that the table shows.
const SEED: u64 = 2009;
/// Other draws, by the seeds from 0 on, that tell how much depends on the draw.
const OTHER_DRAWS: u64 = 1000;

/// Which planes: name, and the errors of a frame.
type Kind = (&'static str, fn(&SafetyCase) -> PlaneErrors);
const KINDS: [Kind; 3] = [
    ("all", SafetyCase::planes),
    ("level", |case| case.level_planes),
    ("inclined", |case| case.inclined_planes),
];

/// The frames of all worlds, one list of journeys per world.
type Worlds = [Vec<Journey>];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let mut worlds = Vec::new();
    for world in WORLDS {
        worlds.push(whole(job, world)?);
    }
    let (mut rows, mut draws) = (vec![published()], Vec::new());
    for (number, entry) in entries().iter().enumerate() {
        rows.extend(rows_of(entry, number, &worlds));
        draws.push(draws_of(entry, number, &worlds));
    }
    let header = [
        "matcher",
        "method",
        "frames",
        "world",
        "planes_of",
        "planes",
        "angle_deg",
        "angle_deviation_deg",
        "distance_cm",
        "distance_deviation_cm",
    ];
    job.write_table(&header, rows)?;
    let header = [
        "matcher",
        "method",
        "draws",
        "angle_deg_5_percent",
        "angle_deg_95_percent",
        "distance_cm_5_percent",
        "distance_cm_95_percent",
    ];
    job.write_more("draws", &header, draws)?;
    let drawn_numbers: Vec<String> = WORLDS
        .iter()
        .zip(&worlds)
        .map(|(name, journeys)| format!("{name} {:?}", drawn(name, &journeys[0], SEED)))
        .collect();
    job.write_picture(&sheet(&worlds, &drawn_numbers.join(", ")))
}

fn published() -> Vec<String> {
    let names = ["paper", "safety-map", "drawn", "all", "all", ""].map(str::to_owned);
    let [angle, distance] = PLANES;
    names.into_iter().chain([angle, distance].concat().into_iter().map(|v| rounded(v, 2))).collect()
}

/// Rows of one map: in the drawn frames and in all, all planes and level and inclined ones apart, over all worlds
/// and in each.
fn rows_of(entry: &Entry, number: usize, worlds: &Worlds) -> Vec<Vec<String>> {
    let mut rows = Vec::new();
    for frames in [Some(SEED), None] {
        for (kind, of) in KINDS {
            let each: Vec<PlaneErrors> = errors(worlds, number, frames, of);
            let names = [entry.matcher, entry.method, if frames.is_some() { "drawn" } else { "all" }];
            let everywhere = [("all", total(&each))].into_iter().chain(WORLDS.into_iter().zip(each));
            rows.extend(everywhere.map(|(world, errors)| row(names, world, kind, &errors)));
        }
    }
    rows
}

fn row(names: [&str; 3], world: &str, kind: &str, errors: &PlaneErrors) -> Vec<String> {
    let numbers = values(errors).concat().into_iter().map(|v| rounded(v, 2));
    let names = names.into_iter().chain([world, kind]).map(str::to_owned);
    names.chain([errors.count.to_string()]).chain(numbers).collect()
}

/// Mean and deviation of the angles in degrees, and of the distances in centimetres.
fn values(errors: &PlaneErrors) -> [[f64; 2]; 2] {
    [
        [errors.mean_angle_deg(), errors.deviation_angle_deg()],
        [errors.mean_distance_cm(), errors.deviation_distance_cm()],
    ]
}

/// The errors of one map, world by world, in the frames of a draw or in all.
fn errors(
    worlds: &Worlds,
    number: usize,
    draw: Option<u64>,
    of: fn(&SafetyCase) -> PlaneErrors,
) -> Vec<PlaneErrors> {
    let of_world = |(name, journeys): (&str, &Vec<Journey>)| {
        let journey = &journeys[number];
        let frames = draw.map(|seed| drawn(name, journey, seed));
        let counts = |frame: &usize| frames.as_ref().is_none_or(|frames| frames.contains(frame));
        let cases = journey.cases.iter().filter(|(frame, _)| counts(frame));
        total(&cases.map(|(_, case)| of(case)).collect::<Vec<_>>())
    };
    WORLDS.into_iter().zip(worlds).map(of_world).collect()
}

fn total(all: &[PlaneErrors]) -> PlaneErrors {
    let mut sum = PlaneErrors::default();
    all.iter().for_each(|errors| sum.add(errors));
    sum
}

/// Numbers of the frames of a world that a draw takes among those in which the robot has moved, each at most once:
/// those with the smallest random numbers. They do not depend on the map.
fn drawn(world: &str, journey: &Journey, seed: u64) -> Vec<usize> {
    let mut rng = ChaCha8Rng::seed_from_u64(stable_hash(&format!("{seed} {world}")));
    let mut lots: Vec<(u64, usize)> =
        journey.cases.iter().map(|(frame, _)| (rng.next_u64(), *frame)).collect();
    lots.sort_unstable();
    let mut frames: Vec<usize> = lots.into_iter().take(DRAWN).map(|(_, frame)| frame).collect();
    frames.sort_unstable();
    frames
}

/// How far the means over the drawn frames lie apart if other frames are drawn.
fn draws_of(entry: &Entry, number: usize, worlds: &Worlds) -> Vec<String> {
    let mut found = [Vec::new(), Vec::new()];
    for seed in 0..OTHER_DRAWS {
        let means = values(&total(&errors(worlds, number, Some(seed), SafetyCase::planes)));
        found.iter_mut().zip(means).for_each(|(list, [mean, _])| list.push(mean));
    }
    let names = [entry.matcher.to_owned(), entry.method.to_owned(), OTHER_DRAWS.to_string()];
    let ends = found.into_iter().flat_map(ends).map(|v| rounded(v, 2));
    names.into_iter().chain(ends).collect()
}

/// The values that a twentieth of a list lies below, and above; nothing but NaN of an empty one.
fn ends(mut list: Vec<f64>) -> [f64; 2] {
    list.retain(|v| !v.is_nan());
    list.sort_by(f64::total_cmp);
    let skipped = list.len() / 20;
    let at = |n: usize| list.get(n).copied().unwrap_or(f64::NAN);
    [at(skipped), at(list.len().saturating_sub(1 + skipped))]
}

fn sheet(worlds: &Worlds, drawn: &str) -> Sheet {
    Sheet {
        title: "Planes of safe ground against the true ones (Murarka and Kuipers 2009, VII-C)".into(),
        notes: vec![
            "dots: mean over all planes; lines: plus and minus the deviation; grey band: the paper, on its own \
             recordings"
                .into(),
            format!("frames drawn with seed {SEED}: {drawn}"),
        ],
        columns: 2,
        panel: (760, 400),
        panels: vec![
            panel(worlds, 0, "angle between the normals (degrees)"),
            panel(worlds, 1, "mean distance of the planes (cm)"),
        ],
    }
}

/// One line per map for the drawn frames, and one below for all.
fn panel(worlds: &Worlds, quantity: usize, label: &str) -> Panel {
    let entries = entries();
    let last = entries.len() as f64 - 1.0;
    let [mean, deviation] = PLANES[quantity];
    let paper = rectangle([(mean - deviation).max(0.0), mean + deviation], [-0.6, last + 1.4]);
    let mut series = vec![
        Series::new("the paper, mean and deviation", GREY, Marks::Areas(vec![paper])),
        Series::new("", DARK, Marks::Line(vec![(mean, -0.6), (mean, last + 1.4)])),
    ];
    let mut end = mean + deviation;
    for (frames, name, colour, off) in
        [(Some(SEED), "5 random frames of each world", BLUE, 0.12), (None, "all frames", ORANGE, -0.12)]
    {
        let mut dots: Vec<Point> = Vec::new();
        for number in 0..entries.len() {
            let [mean, deviation] =
                values(&total(&errors(worlds, number, frames, SafetyCase::planes)))[quantity];
            let y = last - number as f64 + off;
            let ends = vec![((mean - deviation).max(0.0), y), (mean + deviation, y)];
            series.push(Series::new("", colour, Marks::Line(ends)));
            dots.push((mean, y));
            end = end.max(mean + deviation);
        }
        series.push(Series::new(name, colour, Marks::Dots(dots, 5)));
    }
    let names = entries.iter().rev().map(|entry| format!("{}, {}", entry.method, entry.matcher)).collect();
    let y = Axis { names, ..Axis::new("", -0.6, last + 1.4) };
    Panel {
        title: String::new(),
        x: Axis::new(label, 0.0, 1.05 * end),
        y,
        series,
        legend: Some(Corner::LowerRight),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn case(level: &[(f64, f64)], inclined: &[(f64, f64)]) -> SafetyCase {
        let mut case = SafetyCase::default();
        level.iter().for_each(|&(angle, distance)| case.level_planes.add_plane(angle, distance));
        inclined.iter().for_each(|&(angle, distance)| case.inclined_planes.add_plane(angle, distance));
        case
    }

    #[test]
    fn means_and_deviations_over_planes_by_hand() {
        let first = case(&[(1.0, 0.01), (3.0, 0.03)], &[(5.0, 0.02)]);
        let journey = Journey { cases: vec![(0, first), (4, case(&[(3.0, 0.02)], &[]))], shown: None };
        let worlds = vec![vec![journey]];
        let close = |a: [[f64; 2]; 2], b: [[f64; 2]; 2]| {
            a.concat().into_iter().zip(b.concat()).all(|(a, b)| (a - b).abs() < 1e-9)
        };
        let of = |kind: fn(&SafetyCase) -> PlaneErrors| values(&total(&errors(&worlds, 0, None, kind)));
        // Angles 1, 3, 5, 3: mean 3, squares of the differences 4, 0, 4, 0. Distances 1, 3, 2, 2 cm.
        let root = |v: f64| v.sqrt();
        assert!(close(of(KINDS[0].1), [[3.0, root(2.0)], [2.0, root(0.5)]]));
        // Level: 1, 3, 3 degrees, 1, 3, 2 cm.
        assert!(close(of(KINDS[1].1), [[7.0 / 3.0, root(8.0 / 9.0)], [2.0, root(2.0 / 3.0)]]));
        assert!(close(of(KINDS[2].1), [[5.0, 0.0], [2.0, 0.0]]));
    }

    #[test]
    fn frames_are_drawn_once_and_by_the_seed_alone() {
        let journey = |planes: usize| {
            let case = case(&vec![(1.0, 0.1); planes], &[]);
            Journey { cases: (10..60).map(|frame| (frame, case)).collect(), shown: None }
        };
        let frames = drawn("safety-1", &journey(1), SEED);
        assert!(frames.windows(2).all(|pair| pair[0] < pair[1]) && frames.len() == DRAWN);
        assert!(frames.iter().all(|frame| (10..60).contains(frame)));
        assert_eq!(frames, drawn("safety-1", &journey(3), SEED));
        assert_ne!(frames, drawn("safety-2", &journey(1), SEED));
        // Every frame has the same chance: over 1000 draws of 5 from 50 each comes about 100 times.
        let mut times = [0; 60];
        (0..1000).flat_map(|seed| drawn("w", &journey(1), seed)).for_each(|frame| times[frame] += 1);
        assert!(times[10..].iter().all(|n| (60..140).contains(n)), "{times:?}");
    }

    #[test]
    fn a_twentieth_of_the_draws_lies_beyond_each_end() {
        assert_eq!(ends((0..100).map(f64::from).rev().collect()), [5.0, 94.0]);
        assert!(ends(vec![f64::NAN])[0].is_nan());
    }
}
