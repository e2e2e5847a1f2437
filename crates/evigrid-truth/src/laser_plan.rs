use std::sync::atomic::{AtomicBool, Ordering};

use evigrid_core::LaserScan;
use evigrid_grid::PlanSpec;
use nalgebra::{Point3, Vector3};
use rayon::prelude::*;

/// Rays per task.
const RAYS_PER_TASK: usize = 2048;

/// What one scan, of one or several scanners, tells of the ground: where something stands, where nothing does, and
/// where it says nothing.
///
/// A cell is occupied if a point in it lies within a band of heights over the ground. It is free if a ray passes over
/// it below the top of the band, or ends in it below the band, before the ray comes to an occupied cell: what lies
/// behind that is not known, even if the ray goes on above it. So where two scanners contradict each other, occupied
/// wins.
#[derive(Debug, Clone)]
pub struct LaserPlan {
    spec: PlanSpec,
    occupied: Vec<bool>,
    free: Vec<bool>,
}

/// How heights are read.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PlanBand {
    /// Height of the ground in the map frame, metres.
    pub ground_m: f64,
    /// Obstacles reach into this band of heights over the ground, metres.
    pub band_m: [f64; 2],
    /// Rays that end nearer are dropped (they hit the vehicle), metres.
    pub min_range_m: f64,
}

/// A ray in the map frame.
struct Ray {
    from: Point3<f64>,
    to: Point3<f64>,
}

impl LaserPlan {
    /// The plan of a scan over these cells of the map frame.
    pub fn of(scan: &LaserScan, spec: PlanSpec, band: &PlanBand) -> Self {
        let rays: Vec<Ray> = rays(scan, band.min_range_m).collect();
        let top_m = band.ground_m + band.band_m[1];
        let mut occupied = vec![false; spec.cell_count()];
        for ray in &rays {
            let is_in_band = ray.to.z >= band.ground_m + band.band_m[0] && ray.to.z <= top_m;
            if let (true, Some(cell)) = (is_in_band, spec.cell_of([ray.to.x, ray.to.y])) {
                occupied[cell] = true;
            }
        }
        let passed: Vec<AtomicBool> = (0..spec.cell_count()).map(|_| AtomicBool::new(false)).collect();
        rays.par_iter().with_min_len(RAYS_PER_TASK).for_each(|ray| {
            walk(&spec, ray, &mut |cell, height_m| {
                if occupied[cell] {
                    return false;
                }
                if height_m <= top_m {
                    passed[cell].store(true, Ordering::Relaxed);
                }
                true
            });
        });
        let free = passed.into_iter().map(AtomicBool::into_inner).collect();
        Self { spec, occupied, free }
    }

    /// The cells, in the map frame.
    pub fn spec(&self) -> &PlanSpec {
        &self.spec
    }

    /// Whether something stands in each cell, by flat index.
    pub fn occupied(&self) -> &[bool] {
        &self.occupied
    }

    /// Whether each cell is free, by flat index. Cells that are neither are not known.
    pub fn free(&self) -> &[bool] {
        &self.free
    }
}

fn rays(scan: &LaserScan, min_range_m: f64) -> impl Iterator<Item = Ray> {
    let pose = scan.map_from_laser();
    let place = |p: [f32; 3]| Vector3::from(p.map(f64::from));
    scan.points().iter().enumerate().filter_map(move |(n, point)| {
        let start = scan.origins().map_or(Vector3::zeros(), |origins| place(origins[n]));
        let end = place(*point);
        let far_enough = (end - start).norm() >= min_range_m;
        far_enough.then(|| Ray { from: pose * Point3::from(start), to: pose * Point3::from(end) })
    })
}

/// Visits the cells below a ray from its start to its end, with the ray's height in the middle of its way over each
/// (Amanatides and Woo 1987), until `visit` says no. Cells outside of the plan are passed over.
fn walk(spec: &PlanSpec, ray: &Ray, visit: &mut impl FnMut(usize, f64) -> bool) {
    let from = spec.to_cells([ray.from.x, ray.from.y]);
    let to = spec.to_cells([ray.to.x, ray.to.y]);
    let way = [to[0] - from[0], to[1] - from[1]];
    let (first, last) = clip(spec.shape(), from, way);
    if first >= last {
        return;
    }
    // A little inside, so that the first cell is the one that the ray enters.
    let start = (first + 1e-9).min(last);
    let at = |t: f64| [0, 1].map(|a| from[a] + t * way[a]);
    let mut cell = at(start).map(|v| v.floor() as i64);
    // Shares of the way at which the next border is crossed, and between two borders.
    let delta = way.map(|w| if w == 0.0 { f64::INFINITY } else { 1.0 / w.abs() });
    let mut next = [0, 1].map(|a| match way[a] {
        0.0 => f64::INFINITY,
        w if w > 0.0 => (cell[a] as f64 + 1.0 - from[a]) / w,
        w => (cell[a] as f64 - from[a]) / w,
    });
    let mut entered = first;
    while entered < last {
        let axis = usize::from(next[1] < next[0]);
        let left = next[axis].min(last);
        let height_m = ray.from.z + 0.5 * (entered + left) * (ray.to.z - ray.from.z);
        if spec.flat(cell).is_some_and(|flat| !visit(flat, height_m)) {
            return;
        }
        entered = next[axis];
        next[axis] += delta[axis];
        cell[axis] += if way[axis] > 0.0 { 1 } else { -1 };
    }
}

/// The part of a way that lies over the plan, as shares of it.
fn clip(shape: [usize; 2], from: [f64; 2], way: [f64; 2]) -> (f64, f64) {
    let (mut first, mut last) = (0.0_f64, 1.0_f64);
    for a in 0..2 {
        let ends = [-from[a], shape[a] as f64 - from[a]];
        if way[a] == 0.0 {
            if ends[0] > 0.0 || ends[1] <= 0.0 {
                return (1.0, 0.0);
            }
        } else {
            let [near, far] = if way[a] > 0.0 { ends } else { [ends[1], ends[0]] }.map(|end| end / way[a]);
            (first, last) = (first.max(near), last.min(far));
        }
    }
    (first, last)
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_core::Pose;

    const BAND: PlanBand = PlanBand { ground_m: -1.0, band_m: [0.3, 1.8], min_range_m: 0.5 };

    fn plan(points: &[[f32; 3]]) -> LaserPlan {
        let scan = LaserScan::new(points.to_vec(), Pose::identity()).unwrap();
        LaserPlan::of(&scan, PlanSpec::of_area([-1.0, 9.0], [-2.0, 2.0], 1.0).unwrap(), &BAND)
    }

    /// The row of cells along x at y = 0..1: occupied, free or unknown.
    fn row(plan: &LaserPlan) -> String {
        let cells = (0..10).map(|i| plan.spec().flat([i, 2]).unwrap());
        cells
            .map(|c| {
                if plan.occupied()[c] {
                    '#'
                } else if plan.free()[c] {
                    '.'
                } else {
                    '?'
                }
            })
            .collect()
    }

    #[test]
    fn rays_free_their_way_and_points_of_the_band_are_occupied() {
        // The scanner stands at x = 0, 1 m over the ground, in the second cell.
        assert_eq!(row(&plan(&[[4.5, 0.5, 0.0]])), "?....#????");
        // Points below the band are ground, those above say nothing of where they are.
        assert_eq!(row(&plan(&[[4.5, 0.5, -1.0]])), "?.....????");
        assert_eq!(row(&plan(&[[6.5, 0.4, 2.0]])), "?...??????");
        // Behind an obstacle nothing is known, but what is seen there.
        assert_eq!(row(&plan(&[[3.5, 0.5, 0.0], [7.5, 0.6, 0.2]])), "?...#???#?");
        // On the vehicle.
        assert_eq!(row(&plan(&[[0.3, 0.2, 0.0]])), "??????????");
    }

    #[test]
    fn of_two_scanners_the_one_that_sees_something_is_right() {
        let points = vec![[4.5, 0.5, 0.0], [8.5, 0.5, 0.0]];
        let origins = vec![[0.5, 0.5, 0.0], [0.2, 0.5, 0.0]];
        let scan = LaserScan::new(points, Pose::identity()).unwrap().with_origins(origins).unwrap();
        let spec = PlanSpec::of_area([-1.0, 9.0], [-2.0, 2.0], 1.0).unwrap();
        assert_eq!(row(&LaserPlan::of(&scan, spec, &BAND)), "?....#???#");
    }

    /// Dense samples along the ray lie in the cells that it visits, in their order.
    #[test]
    fn the_walk_is_that_of_dense_samples() {
        let spec = PlanSpec::of_area([-3.0, 5.0], [-2.0, 4.0], 0.5).unwrap();
        let mut state = 5_u64;
        let mut random = || {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            (state >> 40) as f64 / f64::from(1 << 24) * 16.0 - 8.0
        };
        for n in 0..300 {
            let mut point = || Point3::new(random(), random(), random());
            let mut ray = Ray { from: point(), to: point() };
            if n % 7 == 0 {
                ray.to.x = ray.from.x;
            }
            let mut sampled = Vec::new();
            for k in 0..=40_000 {
                let at = ray.from + (ray.to - ray.from) * (f64::from(k) / 40_000.0);
                if let Some(cell) = spec.cell_of([at.x, at.y]).filter(|cell| sampled.last() != Some(cell)) {
                    sampled.push(cell);
                }
            }
            let mut walked = Vec::new();
            walk(&spec, &ray, &mut |cell, _| {
                walked.push(cell);
                true
            });
            // Samples can miss a corner that is cut by less than their distance.
            let mut rest = walked.iter();
            assert!(sampled.iter().all(|cell| rest.any(|other| other == cell)), "{sampled:?} {walked:?}");
            assert!(walked.len() <= sampled.len() + 2);
        }
    }
}
