//! Statements of Table I beyond its numbers, and whether they hold here.

use super::algorithms::Algorithm;
use super::timed::Timed;

/// A statement about rows of one cell size.
pub struct Claim {
    pub cell_size_m: f64,
    pub image: &'static str,
    pub text: &'static str,
    pub ours: f64,
    pub paper: f64,
    pub is_met: bool,
}

/// All of one picture in one cell size.
pub fn claims(rows: &[&Timed]) -> Vec<Claim> {
    let of = |wanted: Algorithm| rows.iter().find(|row| row.algorithm == wanted);
    let (Some(line), Some(pyramid), Some(ray), Some(ray_pyramid)) =
        (of(Algorithm::Line), of(Algorithm::LinePyramid), of(Algorithm::Ray), of(Algorithm::RayPyramid))
    else {
        return Vec::new();
    };
    let ratio = |a: u64, b: u64| a as f64 / b as f64;
    let claim = |text, ours: f64, paper: f64, is_met| {
        let Timed { cell_size_m, image, .. } = **line;
        Claim { cell_size_m, image, text, ours, paper, is_met }
    };
    let drawn = |row: &Timed| row.counters.cells_drawn;
    let different = |row: &Timed| row.counters.different_cells;
    let paper = |row: &Timed| row.paper;
    let fewer = ratio(drawn(line), drawn(pyramid));
    let same = ratio(different(pyramid), different(line));
    let paper_fewer = ratio(paper(line).cells_drawn, paper(pyramid).cells_drawn);
    let paper_same = ratio(paper(pyramid).different_cells, paper(line).different_cells);
    let pixels = ratio(ray.counters.used_pixels, ray_pyramid.counters.used_pixels);
    let paper_pixels = ratio(paper(ray).used_pixels, paper(ray_pyramid).used_pixels);
    let faster = |a: &Timed, b: &Timed| a.fastest_ms / b.fastest_ms;
    let paper_faster = |a: &Timed, b: &Timed| paper(a).ms / paper(b).ms;
    let enough = if line.cell_size_m == 1.0 { 100.0 } else { 10.0 };
    vec![
        claim("line over line-pyramid: cells drawn", fewer, paper_fewer, fewer >= enough),
        claim("line-pyramid over line: different cells", same, paper_same, (same - 1.0).abs() <= 0.1),
        claim("ray over ray-pyramid: used pixels", pixels, paper_pixels, pixels >= 10.0),
        claim(
            "line over line-pyramid: time",
            faster(line, pyramid),
            paper_faster(line, pyramid),
            faster(line, pyramid) > 1.0,
        ),
        claim(
            "ray over ray-pyramid: time",
            faster(ray, ray_pyramid),
            paper_faster(ray, ray_pyramid),
            faster(ray, ray_pyramid) > 1.0,
        ),
        claim(
            "ray-pyramid over line-pyramid: time",
            faster(ray_pyramid, pyramid),
            paper_faster(ray_pyramid, pyramid),
            faster(ray_pyramid, pyramid) > 1.0,
        ),
    ]
}
