//! Where the errors lie: by distance from the robot, on the cells that it drives over later, and by distance from
//! what is unsafe. The paper says that almost all false positives lie beside obstacles.

use anyhow::Result;
use evigrid_metrics::{PlaceCounts, SafetyCounts, SafetyTally};
use evigrid_results::{PLACE_COLUMNS, place_cells};

use super::runs::Runs;
use super::worlds::{Entry, MATCHERS};
use crate::chart::{Axis, BLUE, Corner, GREEN, Marks, ORANGE, PINK, Panel, Series, Sheet};
use crate::job::Job;

const METHODS: [&str; 2] = ["safety-map", "safety-map-plus"];

pub fn make(job: &mut Job<'_, '_>) -> Result<()> {
    let runs = Runs::of(job)?;
    let (mut rows, mut lines) = (Vec::new(), Vec::new());
    for (matcher, _) in MATCHERS {
        for method in METHODS {
            let places = pooled(&runs.tallies(&Entry::plain(matcher, method))?);
            let row = |place: &PlaceCounts| {
                let names = [matcher, method].map(str::to_owned);
                names.into_iter().chain(place_cells(place)).collect::<Vec<_>>()
            };
            rows.extend(places.iter().map(row));
            if matcher != "block" {
                lines.push((format!("{method}, {matcher}"), places));
            }
        }
    }
    let header: Vec<&str> = ["matcher", "method"].into_iter().chain(PLACE_COLUMNS).collect();
    job.write_table(&header, rows)?;
    job.write_picture(&sheet(&lines))
}

/// The counts of all worlds together, place by place.
fn pooled(tallies: &[&SafetyTally]) -> Vec<PlaceCounts> {
    let mut sum: Vec<PlaceCounts> = Vec::new();
    for place in tallies.iter().flat_map(|tally| tally.places.list(tally.cell_size_m)) {
        match sum.iter_mut().find(|known| (known.place, known.range_m) == (place.place, place.range_m)) {
            Some(known) => known.counts.add(&place.counts),
            None => sum.push(place),
        }
    }
    sum
}

type Rate = fn(&SafetyCounts) -> f64;

fn sheet(lines: &[(String, Vec<PlaceCounts>)]) -> Sheet {
    let panel = |title: &str, x: &str, y: &str, place: &'static str, rate: Rate| {
        let series: Vec<Series> = lines
            .iter()
            .zip([BLUE, ORANGE, GREEN, PINK])
            .flat_map(|((name, places), colour)| {
                let own = places.iter().filter(|p| p.place == place && !rate(&p.counts).is_nan());
                let middle = |p: &PlaceCounts| match p.range_m {
                    [Some(from), Some(to)] => 0.5 * (from + to),
                    // The last group has no end.
                    [from, _] => from.unwrap_or(0.0),
                };
                let points: Vec<_> = own.map(|p| (middle(p), 100.0 * rate(&p.counts))).collect();
                let dots = Series::new("", colour, Marks::Dots(points.clone(), 3));
                [Series::new(name, colour, Marks::Line(points)), dots]
            })
            .collect();
        let points = series.iter().flat_map(|s| match &s.marks {
            Marks::Line(points) => points.clone(),
            _ => Vec::new(),
        });
        let [right, top] = points.fold([0.0_f64; 2], |[a, b], (x, y)| [a.max(x), b.max(y)]);
        Panel {
            title: title.into(),
            x: Axis::new(x, 0.0, 1.1 * right),
            y: Axis::new(y, 0.0, (1.3 * top).ceil()),
            series,
            legend: Some(Corner::UpperRight),
        }
    };
    let (ring, near) = ("ring around the robot", "safe, by distance from unsafe");
    let (robot, unsafe_m) =
        ("distance from the robot (m)", "distance from the nearest truly unsafe cell (m)");
    let (fn_rate, fp_rate): (Rate, Rate) =
        (SafetyCounts::false_negative_rate, SafetyCounts::false_positive_rate);
    Sheet {
        title: "Where safety maps err (decr 1, five worlds together)".into(),
        notes: vec!["of the cells that map and truth classify".into()],
        columns: 3,
        panel: (460, 380),
        panels: vec![
            panel("unsafe cells called safe", robot, "false negatives (%)", ring, fn_rate),
            panel("safe cells called unsafe", robot, "false positives (%)", ring, fp_rate),
            panel("safe cells called unsafe", unsafe_m, "false positives (%)", near, fp_rate),
        ],
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::{PlanSpec, SafetyLabel, SafetyMap};
    use evigrid_metrics::{PlanningDisc, SafetyReference};

    #[test]
    fn worlds_are_pooled_place_by_place() {
        let spec = PlanSpec::of_area([0.0, 2.0], [-0.5, 0.5], 1.0).unwrap();
        let map = SafetyMap::of(spec, SafetyLabel::NonGround);
        let truth = SafetyReference::new(map.clone());
        let mut tally = SafetyTally::new(&truth);
        tally.add(&map, &truth, PlanningDisc { at_m: [0.5, 0.0], radius_m: 4.0 }, 0);
        let sum = pooled(&[&tally, &tally]);
        assert_eq!(sum.len(), tally.places.list(1.0).len());
        assert_eq!((sum[0].counts.true_positives, sum[1].counts.true_positives), (2, 2));
    }
}
