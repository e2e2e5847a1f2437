//! Semi-global matching, pixel by pixel, as the definitions say.

use evigrid_core::{GrayImage, Matching, NO_COST};
use evigrid_stereo::{PixelCost, SemiGlobalSettings};

use crate::common::{check_match, parabola_offset};

/// A pair, and how it is matched.
#[derive(Debug, Clone, Copy)]
pub struct Case<'a> {
    pub s: SemiGlobalSettings,
    pub min_disparity: i64,
    pub disparities: i64,
    pub uniqueness_percent: i64,
    pub left: &'a GrayImage,
    pub right: &'a GrayImage,
}

/// A pixel of an image whose border is repeated outwards.
fn pixel(image: &GrayImage, x: i64, y: i64) -> i64 {
    let inside = |v: i64, n: usize| v.clamp(0, n as i64 - 1) as usize;
    i64::from(image.row(inside(y, image.height()))[inside(x, image.width())])
}

fn sobel(image: &GrayImage, x: i64, y: i64, cap: i64) -> i64 {
    let column = |x: i64| pixel(image, x, y - 1) + 2 * pixel(image, x, y) + pixel(image, x, y + 1);
    (column(x + 1) - column(x - 1)).clamp(-cap, cap) + cap
}

/// Birchfield and Tomasi's cost of two functions of x.
fn birchfield_tomasi(left: &dyn Fn(i64) -> i64, right: &dyn Fn(i64) -> i64, x: i64, xr: i64) -> i64 {
    let one_way = |value: i64, other: &dyn Fn(i64) -> i64, at: i64| {
        let halves = [other(at), (other(at) + other(at - 1)) / 2, (other(at) + other(at + 1)) / 2];
        let (low, high) = (*halves.iter().min().unwrap(), *halves.iter().max().unwrap());
        (value - high).max(low - value).max(0)
    };
    one_way(left(x), right, xr).min(one_way(right(xr), left, x))
}

fn pixel_cost(case: &Case<'_>, x: i64, y: i64, d: i64) -> i64 {
    let (width, cap) = (case.left.width() as i64, case.s.sobel_cap as i64);
    let inside = |x: i64| x.clamp(0, width - 1);
    let xr = (x - d).max(0);
    match case.s.pixel_cost {
        PixelCost::AbsoluteDifference => (pixel(case.left, x, y) - pixel(case.right, xr, y)).abs(),
        PixelCost::BirchfieldTomasi => {
            let slopes = birchfield_tomasi(
                &|x| sobel(case.left, inside(x), y, cap),
                &|x| sobel(case.right, inside(x), y, cap),
                x,
                xr,
            );
            let greys = birchfield_tomasi(&|x| pixel(case.left, x, y), &|x| pixel(case.right, x, y), x, xr);
            slopes + greys / 4
        }
        PixelCost::Census => {
            let darker = |image: &GrayImage, x: i64, dx: i64, dy: i64| {
                pixel(image, x + dx, y + dy) < pixel(image, x, y)
            };
            let offsets = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| (dx, dy)));
            offsets.filter(|&(dx, dy)| darker(case.left, x, dx, dy) != darker(case.right, xr, dx, dy)).count()
                as i64
        }
    }
}

/// Block costs of all hypotheses of all pixels, `[y][x][d]`.
fn block_costs(case: &Case<'_>) -> Vec<Vec<Vec<i64>>> {
    let (width, height) = (case.left.width() as i64, case.left.height() as i64);
    let radius = case.s.block as i64 / 2;
    let shift = cost_shift(&case.s);
    let sum = |x: i64, y: i64, d: i64| {
        let mut sum = 0;
        for dy in -radius..=radius {
            for dx in -radius..=radius {
                sum += pixel_cost(case, (x + dx).clamp(0, width - 1), (y + dy).clamp(0, height - 1), d);
            }
        }
        sum >> shift
    };
    let curve = |x: i64, y: i64| {
        let known = (0..case.disparities).map(|k| case.min_disparity + k).filter(|d| x - d >= 0);
        known.map(|d| sum(x, y, d)).collect()
    };
    (0..height).map(|y| (0..width).map(|x| curve(x, y)).collect()).collect()
}

/// The smallest power of two with which eight path costs fit into 16 bits.
fn cost_shift(s: &SemiGlobalSettings) -> usize {
    let pixel = match s.pixel_cost {
        PixelCost::AbsoluteDifference => 255,
        PixelCost::BirchfieldTomasi => 2 * s.sobel_cap + 63,
        PixelCost::Census => 24,
    };
    (0..).find(|k| 8 * (((pixel * s.block * s.block) >> k) + (s.p2 >> k)) < 65535).unwrap()
}

/// Eq. 13 of Hirschmueller (2008): path costs of direction (dx, dy), added to the sums.
fn add_paths(case: &Case<'_>, costs: &[Vec<Vec<i64>>], dx: i64, dy: i64, sums: &mut [Vec<Vec<i64>>]) {
    let (width, height) = (case.left.width() as i64, case.left.height() as i64);
    let shift = cost_shift(&case.s);
    let mut paths: Vec<Vec<Vec<i64>>> = vec![vec![vec![]; width as usize]; height as usize];
    let rows: Vec<i64> = if dy < 0 { (0..height).rev().collect() } else { (0..height).collect() };
    let columns: Vec<i64> = if dx < 0 { (0..width).rev().collect() } else { (0..width).collect() };
    for &y in &rows {
        for &x in &columns {
            let (px, py) = (x - dx, y - dy);
            let inside = (0..width).contains(&px) && (0..height).contains(&py);
            let before = if inside { paths[py as usize][px as usize].clone() } else { vec![] };
            let step = (pixel(case.left, x, y) - pixel(case.left, px, py)).abs().max(1) as usize;
            let p2 = if case.s.adapt_p2 { (case.s.p2 / step).max(case.s.p1) } else { case.s.p2 };
            let (p1, p2) = ((case.s.p1 >> shift) as i64, (p2 >> shift) as i64);
            let path = |d: usize, cost: i64| {
                let Some(&lowest) = before.iter().min() else { return cost };
                let mut best = lowest + p2;
                for (e, &value) in before.iter().enumerate() {
                    let penalty = match d.abs_diff(e) {
                        0 => 0,
                        1 => p1,
                        _ => continue,
                    };
                    best = best.min(value + penalty);
                }
                cost + best - lowest
            };
            let curve: Vec<i64> =
                costs[y as usize][x as usize].iter().enumerate().map(|(d, &cost)| path(d, cost)).collect();
            for (sum, value) in sums[y as usize][x as usize].iter_mut().zip(&curve) {
                *sum += value;
            }
            paths[y as usize][x as usize] = curve;
        }
    }
}

/// Sums of all paths, `[y][x][d]`, for the hypotheses that exist.
pub fn path_sums(case: &Case<'_>) -> Vec<Vec<Vec<i64>>> {
    let costs = block_costs(case);
    let mut sums: Vec<Vec<Vec<i64>>> =
        costs.iter().map(|row| row.iter().map(|curve| vec![0; curve.len()]).collect()).collect();
    let straight = [(1, 0), (-1, 0), (0, 1), (0, -1)];
    let diagonal = [(1, 1), (-1, 1), (1, -1), (-1, -1)];
    for (dx, dy) in straight.into_iter().chain(diagonal).take(case.s.paths) {
        add_paths(case, &costs, dx, dy, &mut sums);
    }
    sums
}

fn winner(curve: &[i64]) -> Option<usize> {
    let lowest = curve.iter().min()?;
    curve.iter().position(|c| c == lowest)
}

pub fn check_pixel(case: &Case<'_>, sums: &[Vec<i64>], out: &Matching, x: usize, y: usize) {
    let curve = &sums[x];
    let volume = out.volume.as_ref().unwrap();
    let paths = case.s.paths as i64;
    let mut stored: Vec<i64> = curve.iter().map(|sum| (sum + paths / 2) / paths).collect();
    stored.resize(case.disparities as usize, i64::from(NO_COST));
    let found: Vec<i64> = volume.curve(x, y).map(i64::from).collect();
    assert_eq!(found, stored, "volume at ({x}, {y})");

    let at = y * case.left.width() + x;
    let disparity = f64::from(out.matches.disparity.values()[at]);
    let unique = |best: &usize| {
        let far = curve.iter().enumerate().filter(|(d, _)| d.abs_diff(*best) > 1);
        far.map(|(_, sum)| sum).all(|sum| sum * (100 - case.uniqueness_percent) >= 100 * curve[*best])
    };
    let Some(best) = winner(curve).filter(unique) else {
        assert!(disparity.is_nan() && out.matches.peak_ratio[at].is_nan(), "({x}, {y})");
        assert_eq!(out.matches.left_right_difference_px[at], u16::MAX);
        return;
    };
    let whole = case.min_disparity as usize + best;
    let mut expected = whole as f64;
    if best > 0 && best + 1 < curve.len() {
        expected += parabola_offset([curve[best - 1], curve[best], curve[best + 1]]);
    }
    check_match(out, x, y, expected, curve);

    // The right image's pixel x - d sees the left image's sums along x - d + d'.
    let right_x = x - whole;
    let right_curve: Vec<i64> = (0..case.disparities as usize)
        .map_while(|k| sums.get(right_x + case.min_disparity as usize + k).map(|curve| curve[k]))
        .collect();
    let difference = winner(&right_curve).unwrap().abs_diff(best);
    assert_eq!(usize::from(out.matches.left_right_difference_px[at]), difference, "({x}, {y})");
}
