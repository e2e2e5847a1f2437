//! Safe ground from laser scans alone.

use std::collections::VecDeque;

use evigrid_core::LaserScan;
use evigrid_grid::safe_ground::{Plan, SafetyRules, Segments, Surface, Verdict};
use evigrid_grid::{Moments, PlanSpec, SafetyLabel, SafetyMap};
use nalgebra::Point3;

use crate::heights::Heights;

/// Safety labels by the rules of Murarka and Kuipers 2009 on the heights that laser points give each cell, all
/// scans together. What the laser cannot know is unknown.
///
/// - A point counts within the planning radius of the robot, if it is not higher over the robot's floor than
///   the robot. Of the points in a cell those count that the laser saw from nearest, and from up to 1 m farther.
/// - The height of a cell is the median of its points, its roughness the height from their lowest to their highest
///   tenth. A cell with too few points is *not seen*.
/// - A cell is *ground* if it is not rougher than `max_step_m`, an *edge or obstacle* if it is rougher than that
///   by more than the scatter of the laser, and *unclear* between the two.
/// - The normal of a ground cell is that of the plane through the ground cells around it that it continues into.
/// - Segments and their verdicts are those of the exact truth ([`Plan`]), with [`CONTINUITY_M`] in place of its
///   finer limit.
/// - Ground that nothing safe leads to is unsafe only if the laser saw what is between. It is unknown if it is small
///   or thin, or if as many of its cells as it takes to drive there are connected with safe ground by cells that
///   the laser has not seen, or by unclear ones between ground of one height.
#[derive(Debug)]
pub struct LaserSafety {
    spec: PlanSpec,
    rules: SafetyRules,
    min_range_m: f64,
    cells: Vec<Heights>,
}

/// The robot while a scan is taken.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RobotPlace {
    /// Its place in the map frame, metres.
    pub at_m: [f64; 2],
    /// Height of the floor that it stands on, in the map frame, metres.
    pub floor_m: f64,
    /// Its height, metres.
    pub height_m: f64,
    /// Its planning radius, metres.
    pub radius_m: f64,
}

/// Cells with fewer points are not seen.
const MIN_POINTS: u32 = 5;
/// Level ground looks so rough to the laser: a tenth lies below and a tenth above 2.56 deviations of 2 cm (the
/// accuracy of the Velodyne HDL-64E by its data sheet), metres.
const SCATTER_M: f64 = 0.05;
/// Neighbouring ground cells are on one surface if their planes differ by no more, metres: two deviations of the
/// difference between two medians of few points each.
const CONTINUITY_M: f64 = 0.03;
/// What is deeper below the robot's floor counts as so deep, metres: it is out of reach all the same, and a point
/// that is wrong by kilometres takes no memory.
const DEEP_M: f64 = 3.0;
/// The plane of a cell is fitted to ground cells so far around it, metres.
const PLANE_REACH_M: f64 = 0.35;

/// What the laser knows of a cell.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Seen {
    Nothing,
    Unclear,
    Edge,
    Ground(f64),
}

impl LaserSafety {
    /// A truth without any scan. Points nearer to the laser than `min_range_m` are dropped.
    pub fn new(spec: PlanSpec, rules: SafetyRules, min_range_m: f64) -> Self {
        let rules = SafetyRules { continuity_m: CONTINUITY_M, ..rules };
        Self { spec, rules, min_range_m, cells: vec![Heights::default(); spec.cell_count()] }
    }

    /// Adds the points of a scan.
    pub fn add_scan(&mut self, scan: &LaserScan, robot: &RobotPlace) {
        let [x, y] = robot.at_m;
        let top_m = robot.floor_m + robot.height_m;
        let origins = scan.origins();
        for (index, point) in scan.points().iter().enumerate() {
            let point = Point3::from(point.map(f64::from));
            let start = origins.map_or(Point3::origin(), |all| Point3::from(all[index].map(f64::from)));
            let at = scan.map_from_laser() * point;
            let away = (at.x - x) * (at.x - x) + (at.y - y) * (at.y - y);
            let counts = at.z < top_m && away <= robot.radius_m * robot.radius_m;
            let range_m = (point - start).norm();
            if !counts || range_m < self.min_range_m {
                continue;
            }
            if let Some(cell) = self.spec.cell_of([at.x, at.y]) {
                self.cells[cell].add(at.z.max(robot.floor_m - DEEP_M), range_m);
            }
        }
    }

    /// Median height of the points in each cell in the map frame, metres; NaN where the laser saw too few.
    pub fn heights_m(&self) -> Vec<f64> {
        let height = |cell: &Heights| if cell.count() < MIN_POINTS { f64::NAN } else { cell.at_share(0.5) };
        self.cells.iter().map(height).collect()
    }

    /// The labels, for a robot that starts at a place. If there is no ground as high as its floor, nothing is
    /// known.
    pub fn map(&self, start: &RobotPlace) -> SafetyMap {
        let seen: Vec<Seen> = self.cells.iter().map(|cell| self.seen(cell)).collect();
        let surfaces: Vec<Option<Surface>> = (0..seen.len()).map(|cell| self.surface(&seen, cell)).collect();
        let plan = Plan {
            shape: self.spec.shape(),
            cell_size_m: self.spec.cell_size_m(),
            surfaces: &surfaces,
            rules: &self.rules,
        };
        let mut map = SafetyMap::unknown(self.spec);
        let segments = plan.segments();
        let Some(first) = self.first_segment(&plan, &segments, start) else { return map };
        let verdicts = plan.verdicts(&segments, first);
        let is_safe = |cell: usize| segments.of_cell[cell].is_some_and(|s| verdicts[s] == Verdict::Safe);
        let ways = self.cells_led_to(&seen, is_safe);
        let led_to = |segment: usize| segments.cells[segment].iter().filter(|&&cell| ways[cell]).count();
        let cannot_tell = |segment: usize| {
            led_to(segment) >= self.rules.min_border_cells || plan.is_small_or_thin(&segments, segment)
        };
        let open: Vec<bool> = (0..verdicts.len()).map(cannot_tell).collect();
        for cell in 0..seen.len() {
            let of_segment = segments.of_cell[cell].map(|segment| match verdicts[segment] {
                Verdict::Safe => self.safe_label(surfaces[cell].as_ref()),
                Verdict::Unreached if open[segment] => SafetyLabel::Unknown,
                Verdict::Steep | Verdict::Unreached => SafetyLabel::NonGround,
                Verdict::Unknown => SafetyLabel::Unknown,
            });
            let label = match seen[cell] {
                Seen::Edge => SafetyLabel::NonGround,
                _ => of_segment.unwrap_or(SafetyLabel::Unknown),
            };
            map.set(cell, label, None);
        }
        map
    }

    fn seen(&self, cell: &Heights) -> Seen {
        if cell.count() < MIN_POINTS {
            return Seen::Nothing;
        }
        match cell.at_share(0.9) - cell.at_share(0.1) {
            rough_m if rough_m <= self.rules.max_step_m => Seen::Ground(cell.at_share(0.5)),
            rough_m if rough_m <= self.rules.max_step_m + SCATTER_M => Seen::Unclear,
            _ => Seen::Edge,
        }
    }

    /// The surface of a ground cell: its height, and the slope of the least-squares plane of its own height and those
    /// of the cells around that it continues into.
    fn surface(&self, seen: &[Seen], cell: usize) -> Option<Surface> {
        let Seen::Ground(height_m) = seen[cell] else { return None };
        let mut moments = Moments::default();
        for (other, there_m) in self.continued(seen, cell, height_m) {
            let [x, y] = self.spec.centre_m(other);
            moments.add([x, y, there_m]);
        }
        Some(Surface { height_m, normal: moments.plane()?.by_normal().normal })
    }

    /// The ground cells around a cell, with their heights, that lead to it over neighbours which differ by no more
    /// than the steepest drivable ground would.
    fn continued(&self, seen: &[Seen], cell: usize, height_m: f64) -> Vec<(usize, f64)> {
        let (c, rise) = (self.spec.cell_size_m(), self.rules.max_slope_deg.to_radians().tan());
        let reach = (PLANE_REACH_M / c).ceil() as usize;
        let (limit_m, [i, j]) = (rise * c + CONTINUITY_M, self.spec.cell(cell));
        let is_near = |other: usize| {
            let [k, l] = self.spec.cell(other);
            k.abs_diff(i) <= reach && l.abs_diff(j) <= reach
        };
        let (mut found, mut next) = (vec![(cell, height_m)], 0);
        while let Some(&(from, from_m)) = found.get(next) {
            next += 1;
            for other in self.spec.neighbours(from).filter(|&other| is_near(other)) {
                let Seen::Ground(there_m) = seen[other] else { continue };
                if (there_m - from_m).abs() <= limit_m && !found.iter().any(|&(known, _)| known == other) {
                    found.push((other, there_m));
                }
            }
        }
        found
    }

    /// The segment of the ground cell nearest to the robot that is as high as its floor but for a step. Segments that
    /// are small or thin do not count: the laser sees little of the ground beside the vehicle.
    fn first_segment(&self, plan: &Plan<'_>, segments: &Segments, robot: &RobotPlace) -> Option<usize> {
        let away = |&cell: &usize| {
            let [x, y] = self.spec.centre_m(cell);
            libm::hypot(x - robot.at_m[0], y - robot.at_m[1])
        };
        let is_floor = |&cell: &usize| {
            let limit_m = self.rules.max_step_m + self.rules.max_slope_deg.to_radians().tan() * away(&cell);
            let large =
                segments.of_cell[cell].is_some_and(|segment| !plan.is_small_or_thin(segments, segment));
            large
                && plan.surfaces[cell]
                    .is_some_and(|surface| (surface.height_m - robot.floor_m).abs() <= limit_m)
        };
        let nearest = (0..plan.surfaces.len()).filter(is_floor).min_by(|a, b| away(a).total_cmp(&away(b)))?;
        segments.of_cell[nearest]
    }

    /// The ground cells that may be reached from safe ground over cells that the laser has not seen, or over unclear
    /// ones if they are as high as the safe ground on the other side but for a step.
    fn cells_led_to(&self, seen: &[Seen], is_safe: impl Fn(usize) -> bool) -> Vec<bool> {
        let (mut led_to, mut passed) = (vec![false; seen.len()], vec![false; seen.len()]);
        // A cell, the height of the safe ground that leads there, and whether a cell on the way was not seen.
        let safe = (0..seen.len()).filter(|&cell| is_safe(cell)).filter_map(|cell| match seen[cell] {
            Seen::Ground(height_m) => Some((cell, height_m, false)),
            _ => None,
        });
        let mut open: VecDeque<(usize, f64, bool)> = safe.collect();
        while let Some((cell, height_m, unseen)) = open.pop_front() {
            for other in self.spec.neighbours(cell) {
                match seen[other] {
                    Seen::Edge => {}
                    Seen::Ground(there_m) => {
                        let agrees = (there_m - height_m).abs() <= self.rules.max_step_m;
                        led_to[other] |= passed[cell] && (unseen || agrees);
                    }
                    Seen::Nothing | Seen::Unclear if passed[other] => {}
                    Seen::Nothing | Seen::Unclear => {
                        passed[other] = true;
                        open.push_back((other, height_m, unseen || seen[other] == Seen::Nothing));
                    }
                }
            }
        }
        led_to
    }

    fn safe_label(&self, surface: Option<&Surface>) -> SafetyLabel {
        let slope_deg = surface.map_or(0.0, |surface| surface.slope_rad().to_degrees());
        if slope_deg > self.rules.level_slope_deg { SafetyLabel::Inclined } else { SafetyLabel::Level }
    }
}
