//! The summary of a run as a page that a person reads.

use std::fmt::Write as _;

use evigrid_grid::LayerKind;
use evigrid_metrics::{Kind, Score, Scores};

use crate::safety_tables::hazards_page;
use crate::{MethodResult, RunInfo, RunResult};

/// Words for a source of truth.
struct Words {
    /// In front of the numbers of true cells.
    says: &'static str,
    /// Where nothing could be scored.
    no_scores: &'static str,
    /// Meaning of the counts.
    counts: &'static str,
}

const LASER: Words = Words {
    says: "The laser says",
    no_scores: "No laser scan came with these frames: the maps are not scored.",
    counts: "Hits: occupied in the map and for the laser. Mistakes: occupied in the map alone. \
             Missed: occupied for the laser alone.",
};

const EXACT: Words = Words {
    says: "The exact truth",
    no_scores: "There is no exact truth for these maps: they are not scored.",
    counts: "Hits: occupied in the map and in truth. Mistakes: occupied in the map alone. \
             Missed: occupied in truth alone.",
};

/// What stands instead of scores where all maps are safety maps.
const NO_LABELS: &str = "No true safety labels came with these frames (synthetic worlds have them, with \
                         truth.source = exact): the maps are not scored.";

const HAZARDS_NOTE: &str = "When the robot is nearest: share of the cells within the planning radius that are right \
                            (unsafe, or safe in a safe area), and that are wrong; the rest is unknown. From: how \
                            far the robot was when half of them were right for the first time.";

/// The result of a run as Markdown.
pub fn markdown_summary(info: &RunInfo, result: &RunResult) -> String {
    let words = if info.truth == "exact" { EXACT } else { LASER };
    let mut text = heading(info, result);
    if !LayerKind::ALL.into_iter().any(|kind| result.has_scores(kind)) {
        let only_safety = info.methods.iter().all(|method| method.layers == [LayerKind::Safety]);
        let _ = writeln!(text, "{}", if only_safety { NO_LABELS } else { words.no_scores });
        return text;
    }
    if let Some(scores) = any_scores(result, LayerKind::Voxels) {
        let _ = writeln!(text, "{}: {}.\n", words.says, reference(scores));
        text += &markdown_table(&result.methods, LayerKind::Voxels);
    }
    if !result.without_laser.is_empty() {
        let _ = writeln!(
            text,
            "\nFrames without a laser scan (mapped, but not in the reference): {}.",
            result.without_laser.iter().map(usize::to_string).collect::<Vec<_>>().join(", ")
        );
    }
    if result.has_scores(LayerKind::Voxels) || result.has_scores(LayerKind::Plan) {
        let _ = writeln!(text, "\n{}", words.counts);
    }
    for (kind, heading) in [(LayerKind::Plan, "Ground plan"), (LayerKind::Safety, "Safety")] {
        if result.has_scores(kind) {
            let _ = writeln!(text, "\n## {heading}\n");
            text += &markdown_table(&result.methods, kind);
        }
    }
    hazards(&mut text, result);
    text
}

/// What the maps say of each named hazard and safe area.
fn hazards(text: &mut String, result: &RunResult) {
    let rows = hazards_page(result);
    let Some(header) = rows.first() else { return };
    let _ = writeln!(text, "\n## Hazards and safe areas\n\n{HAZARDS_NOTE}\n");
    let line = |row: &[String]| format!("| {} |", row.join(" | "));
    let _ = writeln!(text, "{}\n|{}", line(header), " --- |".repeat(header.len()));
    rows[1..].iter().for_each(|row| {
        let _ = writeln!(text, "{}", line(row));
    });
}

fn heading(info: &RunInfo, result: &RunResult) -> String {
    let [nx, ny, nz] = info.spec.shape();
    let c = info.spec.cell_size_m();
    let first = info.frames.first().copied().unwrap_or(0);
    let last = info.frames.last().copied().unwrap_or(0);
    format!(
        "# {}\n\n{} frames ({first} to {last}), {} x {} x {} m in cells of {c} m.\n\n",
        info.dataset,
        result.frames,
        nx as f64 * c,
        ny as f64 * c,
        nz as f64 * c
    )
}

fn any_scores(result: &RunResult, kind: LayerKind) -> Option<&Scores> {
    result.methods.iter().find_map(|method| method.scores_of(kind))
}

/// The sizes of the reference, in one line.
fn reference(scores: &Scores) -> String {
    let sizes = scores.list.iter().filter(|score| score.metric.kind == Kind::Reference);
    let sizes = sizes.filter_map(|score| Some(format!("{} {}", score.shown(), score.heading()?)));
    sizes.collect::<Vec<_>>().join(", ")
}

/// The scores of one kind of layer as a Markdown table: a row per method that was scored. Empty without any.
pub fn markdown_table(methods: &[MethodResult], kind: LayerKind) -> String {
    let mut text = String::new();
    let Some(scores) = methods.iter().find_map(|method| method.scores_of(kind)) else { return text };
    let headings: Vec<String> = columns(scores).filter_map(Score::heading).collect();
    let _ = writeln!(text, "| method | {} |", headings.join(" | "));
    let _ = writeln!(text, "|{}", " --- |".repeat(headings.len() + 1));
    for method in methods {
        if let Some(scores) = method.scores_of(kind) {
            let cells: Vec<String> = columns(scores).map(Score::shown).collect();
            let _ = writeln!(text, "| {} | {} |", method.method, cells.join(" | "));
        }
    }
    text
}

/// The scores of a table: all with a heading but the sizes of the reference.
fn columns(scores: &Scores) -> impl Iterator<Item = &Score> {
    scores.list.iter().filter(|s| s.metric.kind != Kind::Reference && s.heading().is_some())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::MethodInfo;
    use crate::test_run::{info, result};

    const START: &str =
        "# yard\n\n2 frames (0 to 2), 1.2000000000000002 x 0.2 x 0.2 m in cells of 0.2 m.\n\n";

    #[test]
    fn every_kind_of_layer_has_its_table() {
        let row = "1 | 1 | 1 | 1 | 0.500 | 0.500 | 0.500 | - | 1.000 | 0.500 |";
        let expected = format!(
            "{START}The laser says: 2 occupied cells, 4 observed.\n\n\
             | method | hits | mistakes | of them observed | missed | precision | recall | F1 | \
             F1 in view | F within 0.2 m | curve area |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n\
             | line | {row}\n| all | {row}\n\n\
             Frames without a laser scan (mapped, but not in the reference): 2.\n\n\
             Hits: occupied in the map and for the laser. Mistakes: occupied in the map alone. \
             Missed: occupied for the laser alone.\n\n\
             ## Ground plan\n\n\
             | method | hits | mistakes | missed | precision | recall | F1 | AUC |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- |\n\
             | line | 1 | 0 | 1 | 1.000 | 0.500 | 0.667 | 0.750 |\n\
             | all | 1 | 0 | 1 | 1.000 | 0.500 | 0.667 | 0.750 |\n\n\
             ## Safety\n\n\
             | method | unsafe taken for safe | safe taken for unsafe | unclassified | unsafe found | \
             unsafe taken for safe, off borders | safe taken for unsafe, off borders | inclined found | \
             planes, deg | planes, cm |\n\
             | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n\
             | all | 0.000 | - | 0.000 | 1.000 | 0.000 | - | - | - | - |\n\n\
             ## Hazards and safe areas\n\n{HAZARDS_NOTE}\n\n\
             | area | kind | all |\n| --- | --- | --- |\n| kerb | step | 100 %, from 0.0 m |\n"
        );
        assert_eq!(markdown_summary(&info(), &result()), expected);
    }

    #[test]
    fn an_exact_truth_is_no_laser() {
        let result = RunResult { without_laser: Vec::new(), ..result() };
        let text = markdown_summary(&RunInfo { truth: "exact", ..info() }, &result);
        assert!(text.contains("The exact truth: 2 occupied cells, 4 observed.\n"), "{text}");
        assert!(
            text.contains("Hits: occupied in the map and in truth.") && !text.contains("laser"),
            "{text}"
        );
    }

    #[test]
    fn maps_that_were_not_scored_are_not_in_a_table() {
        let mut result = result();
        result.methods.iter_mut().for_each(|method| (method.scores, method.safety) = (Vec::new(), None));
        let expected = format!("{START}No laser scan came with these frames: the maps are not scored.\n");
        assert_eq!(markdown_summary(&info(), &result), expected);
        let safety = |method: MethodInfo| MethodInfo { layers: vec![LayerKind::Safety], ..method };
        let methods = info().methods.into_iter().map(safety).collect();
        let text = markdown_summary(&RunInfo { methods, ..info() }, &result);
        assert!(text.contains("No true safety labels"), "{text}");
    }
}
