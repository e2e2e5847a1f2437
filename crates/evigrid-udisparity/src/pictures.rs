//! The grid for people: the maps of the paper's Fig. 2, and the image with what they say, as in its Fig. 6.

use evigrid_grid::{Picture, Pictures, PixelLabel};

use crate::{CellProbabilities, LevelView, UDisparityGrid};

/// Obstacle pixels of a cell that are drawn brightest.
const MANY: f64 = 40.0;
/// P below this is free, and above that occupied (Perrollaz et al. 2012, 6.2).
const FREE: f32 = 0.4;
const OCCUPIED: f32 = 0.75;

/// Far cells are at the top, near ones at the bottom, as in the image.
pub(crate) fn pictures(grid: &UDisparityGrid, view: &LevelView) -> Pictures {
    let picture = |name, share: &dyn Fn(usize, usize) -> f64| {
        let (width, height) = (grid.columns(), grid.disparities());
        let cells = (1..=height).flat_map(|d| (0..width).map(move |u| (u, d)));
        let shares = cells.map(|(u, d)| (255.0 * share(u, d).clamp(0.0, 1.0)).round() as u8).collect();
        Picture { name, width, height, shares }
    };
    let p = |of: fn(&CellProbabilities) -> f64| move |u: usize, d: usize| of(&grid.probabilities(u, d));
    let list = vec![
        picture("obstacle pixels", &|u, d| f64::from(grid.counts(u, d).observed) / MANY),
        picture("road around", &|u, d| f64::from(grid.counts(u, d).road) / 9.0),
        picture("visible", &p(|p| p.visible)),
        picture("obstacle confidence", &p(|p| p.confidence)),
        picture("road confidence", &p(|p| p.road)),
        picture("occupancy", &p(|p| p.total)),
    ];
    Pictures { list, labels: labels(grid, view) }
}

/// Where something stands the image is occupied up to the largest height; where the road is free it is free.
fn labels(grid: &UDisparityGrid, view: &LevelView) -> Vec<PixelLabel> {
    let (width, height) = (view.rig.width, view.rig.height);
    let total = |u: usize, d: usize| grid.total()[(d - 1) * width + u];
    let mut level = vec![PixelLabel::Unknown; width * height];
    for u in 0..width {
        for v in 0..height {
            let ground = (v as f64 - view.rig.centre_y_px) * view.rig.baseline_m / view.height_m;
            let d = (ground + 0.5).floor();
            if d >= 1.0 && d <= grid.disparities() as f64 && total(u, d as usize) < FREE {
                level[v * width + u] = PixelLabel::Free;
            }
        }
        for d in (1..=grid.disparities()).filter(|&d| total(u, d) > OCCUPIED) {
            grid.rows().of(d).for_each(|v| level[v * width + u] = PixelLabel::Occupied);
        }
    }
    let pixel = |n: usize| {
        let [u, v] = view.level_pixel(n % width, n / width)?.map(|place| (place + 0.5).floor());
        let is_in = u >= 0.0 && v >= 0.0 && u < width as f64 && v < height as f64;
        is_in.then(|| level[v as usize * width + u as usize])
    };
    (0..width * height).map(|n| pixel(n).unwrap_or(PixelLabel::Unknown)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Parameters, Pixels};
    use evigrid_core::{GroundPlane, Mounting, StereoRig};

    /// Road everywhere below the horizon, and a box at disparity 8 in columns 10 to 20.
    #[test]
    fn the_road_is_free_and_the_box_is_occupied() {
        let rig = StereoRig {
            width: 40,
            height: 60,
            focal_px: 50.0,
            centre_x_px: 19.5,
            centre_y_px: 20.0,
            baseline_m: 0.4,
        };
        let ground = GroundPlane::below(&Mounting::over_middle(1.0, 0.0)).disparities(&rig);
        let view = LevelView::new(&rig, &ground).unwrap();
        let parameters =
            Parameters { false_positive: 0.02, false_negative: 0.02, tau_obstacle: 0.1, tau_road: 0.1 };
        let mut grid = UDisparityGrid::new(&view, 1.5, 16, parameters, true);
        // v_0(8) = 20 + 8 / 0.4 = 40.
        let is_box = |u: usize, v: usize| (10..=20).contains(&u) && (15..40).contains(&v);
        let road = |v: usize| (0.4 * (v as f64 - 20.0) + 0.5).floor().max(0.0) as u16;
        let pixel = |n: usize, of: &dyn Fn(usize, usize) -> u16| of(n % 40, n / 40);
        let all = |of: &dyn Fn(usize, usize) -> u16| (0..40 * 60).map(|n| pixel(n, of)).collect();
        grid.fill(&Pixels {
            width: 40,
            height: 60,
            obstacles: all(&|u, v| if is_box(u, v) { 8 } else { 0 }),
            road: all(&|u, v| if is_box(u, v) { 0 } else { road(v) }),
        });
        let pictures = pictures(&grid, &view);
        let label = |u: usize, v: usize| pictures.labels[v * 40 + u];
        assert_eq!(label(15, 30), PixelLabel::Occupied);
        assert_eq!([label(30, 50), label(15, 55), label(5, 45)], [PixelLabel::Free; 3]);
        assert_eq!(label(30, 5), PixelLabel::Unknown);
        let names: Vec<_> = pictures.list.iter().map(|picture| picture.name).collect();
        assert_eq!((names.len(), names[5]), (6, "occupancy"));
        // Row 7 is disparity 8.
        assert!(pictures.list[5].shares[7 * 40 + 15] > 200 && pictures.list[5].shares[9 * 40 + 30] < 60);
    }
}
