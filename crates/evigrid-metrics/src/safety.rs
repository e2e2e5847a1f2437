use evigrid_grid::{PlanSpec, SafetyLabel, SafetyMap, SafetyPlane};

use crate::ratio;
use crate::robust_plane::robust_plane;
use crate::safety_cells::{JudgedCell, PlanningDisc, judged_cells};
use crate::safety_reference::SafetyReference;

/// A safety map counted against the true one, after one frame or summed over frames.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct SafetyCase {
    /// All cells in reach that the truth classifies.
    pub strict: SafetyCounts,
    /// Those of them that are not next to a border between safe and unsafe cells.
    pub beside_borders: SafetyCounts,
    /// Truly inclined cells that the map classifies.
    pub inclined: usize,
    /// Those of them that are inclined in the map too.
    pub inclined_found: usize,
    /// Planes of safe ground on truly level ground.
    pub level_planes: PlaneErrors,
    /// Planes of safe ground on truly inclined ground.
    pub inclined_planes: PlaneErrors,
}

/// Sums of the errors of planes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct PlaneErrors {
    /// Number of planes.
    pub count: usize,
    /// Sum of the angles between found and true normals, degrees.
    pub angle_deg: f64,
    /// Sum of the mean distances of the found planes from the true ones, metres.
    pub distance_m: f64,
    /// Sum of the squares of the angles, square degrees.
    pub angle_deg2: f64,
    /// Sum of the squares of the distances, square metres.
    pub distance_m2: f64,
}

/// Cells that the true map classifies, counted by what the found map says of them. Positive means unsafe
/// (Murarka and Kuipers 2009).
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub struct SafetyCounts {
    /// Unsafe in both.
    pub true_positives: usize,
    /// Safe in truth, unsafe in the map.
    pub false_positives: usize,
    /// Safe in both.
    pub true_negatives: usize,
    /// Unsafe in truth, safe in the map.
    pub false_negatives: usize,
    /// Safe in truth, not classified in the map.
    pub unclassified_safe: usize,
    /// Unsafe in truth, not classified in the map.
    pub unclassified_unsafe: usize,
}

impl SafetyCase {
    /// Looks up every cell of the true map in the found one by its centre; `disc` is the part that counts, all
    /// of it if none.
    pub fn new(found: &SafetyMap, truth: &SafetyReference, disc: Option<PlanningDisc>) -> Self {
        let (mut case, mut planes) = (Self::default(), PlanePairs::new(found, truth));
        for cell in judged_cells(found, truth, disc) {
            case.count(&cell, truth.is_at_border(cell.flat));
            if let Some(found_at) = cell.found_at.filter(|_| cell.found.is_safe() == Some(true)) {
                planes.add(found_at, cell.flat);
            }
        }
        planes.judge(&mut case);
        case
    }

    fn count(&mut self, cell: &JudgedCell, is_at_border: bool) {
        let found = cell.found.is_safe();
        *self.strict.of(cell.safe, found) += 1;
        if !is_at_border {
            *self.beside_borders.of(cell.safe, found) += 1;
        }
        if cell.truth == SafetyLabel::Inclined && found.is_some() {
            self.inclined += 1;
            self.inclined_found += usize::from(cell.found == SafetyLabel::Inclined);
        }
    }

    /// Adds the counts of another frame.
    pub fn add(&mut self, other: &Self) {
        self.strict.add(&other.strict);
        self.beside_borders.add(&other.beside_borders);
        self.inclined += other.inclined;
        self.inclined_found += other.inclined_found;
        self.level_planes.add(&other.level_planes);
        self.inclined_planes.add(&other.inclined_planes);
    }

    /// Share of the truly inclined cells that the map classifies which are inclined in it; NaN if it
    /// classifies none.
    pub fn inclined_rate(&self) -> f64 {
        ratio(self.inclined_found, self.inclined)
    }

    /// The errors of all planes.
    pub fn planes(&self) -> PlaneErrors {
        let mut all = self.level_planes;
        all.add(&self.inclined_planes);
        all
    }
}

impl PlaneErrors {
    /// Adds one plane: the angle between its normal and the true one in degrees, and its distance in metres.
    pub fn add_plane(&mut self, angle_deg: f64, distance_m: f64) {
        self.count += 1;
        self.angle_deg += angle_deg;
        self.distance_m += distance_m;
        self.angle_deg2 += angle_deg * angle_deg;
        self.distance_m2 += distance_m * distance_m;
    }

    /// Adds the planes of another frame.
    pub fn add(&mut self, other: &Self) {
        self.count += other.count;
        self.angle_deg += other.angle_deg;
        self.distance_m += other.distance_m;
        self.angle_deg2 += other.angle_deg2;
        self.distance_m2 += other.distance_m2;
    }

    /// Mean angle between found and true normals, degrees; NaN without planes.
    pub fn mean_angle_deg(&self) -> f64 {
        self.angle_deg / self.count as f64
    }

    /// Mean distance of found planes from true ones, centimetres; NaN without planes.
    pub fn mean_distance_cm(&self) -> f64 {
        100.0 * self.distance_m / self.count as f64
    }

    /// Deviation of the angles over the planes, all of which are counted, degrees; NaN without planes.
    pub fn deviation_angle_deg(&self) -> f64 {
        deviation(self.count, self.angle_deg, self.angle_deg2)
    }

    /// Deviation of the distances over the planes, all of which are counted, centimetres; NaN without planes.
    pub fn deviation_distance_cm(&self) -> f64 {
        100.0 * deviation(self.count, self.distance_m, self.distance_m2)
    }
}

/// Population deviation from the sums of values and of their squares.
fn deviation(count: usize, sum: f64, squares: f64) -> f64 {
    let mean = sum / count as f64;
    // Rounding can make the difference of two equal numbers negative.
    let variance = squares / count as f64 - mean * mean;
    if variance < 0.0 { 0.0 } else { variance.sqrt() }
}

/// The cells of the planes of safe ground, with the true planes below them.
struct PlanePairs<'a> {
    found: &'a SafetyMap,
    truth: &'a SafetyReference,
    /// For each found plane its cells, in both maps.
    cells: Vec<Vec<[usize; 2]>>,
}

impl<'a> PlanePairs<'a> {
    fn new(found: &'a SafetyMap, truth: &'a SafetyReference) -> Self {
        Self { found, truth, cells: vec![Vec::new(); found.planes().len()] }
    }

    fn add(&mut self, found: usize, truth: usize) {
        if let Some(plane) = self.found.plane_numbers()[found] {
            self.cells[plane as usize].push([found, truth]);
        }
    }

    /// Holds each found plane against the true plane that lies below most of its cells.
    fn judge(&self, case: &mut SafetyCase) {
        for (plane, cells) in self.found.planes().iter().zip(&self.cells) {
            let Some(true_plane) = self.true_plane(cells) else { continue };
            let slope_deg = true_plane.normal.z.clamp(-1.0, 1.0).acos().to_degrees();
            // Level ground is exactly level in truth; the paper's limit between the two is 3 degrees.
            let errors = if slope_deg > 3.0 { &mut case.inclined_planes } else { &mut case.level_planes };
            let angle_deg = plane.normal.angle(&true_plane.normal).to_degrees();
            errors.add_plane(angle_deg, mean_distance_m(plane, &true_plane, self.found.spec(), cells));
        }
    }

    /// The true plane of these cells: the one that most of them lie on, or that of their measured heights.
    fn true_plane(&self, cells: &[[usize; 2]]) -> Option<SafetyPlane> {
        let (map, heights_m) = (self.truth.map(), self.truth.heights_m());
        if !heights_m.is_empty() {
            let point = |&[_, cell]: &[usize; 2]| {
                let [x, y] = map.spec().centre_m(cell);
                [x, y, heights_m[cell]]
            };
            return robust_plane(cells.iter().map(point).filter(|point| point[2].is_finite()).collect());
        }
        let mut votes = vec![0_u32; map.planes().len()];
        for plane in cells.iter().filter_map(|&[_, truth]| map.plane_numbers()[truth]) {
            votes[plane as usize] += 1;
        }
        let most = votes.iter().copied().max().filter(|&most| most > 0)?;
        let number = votes.iter().position(|&count| count == most)?;
        Some(map.planes()[number])
    }
}

/// Mean distance of the points of a found plane over the centres of its cells from a true plane.
fn mean_distance_m(found: &SafetyPlane, truth: &SafetyPlane, spec: &PlanSpec, cells: &[[usize; 2]]) -> f64 {
    let distance = |&[cell, _]: &[usize; 2]| {
        let [x, y] = spec.centre_m(cell);
        let z = found.height_m([x, y]).unwrap_or(f64::INFINITY);
        (truth.normal.x * x + truth.normal.y * y + truth.normal.z * z - truth.offset_m).abs()
    };
    cells.iter().map(distance).sum::<f64>() / cells.len() as f64
}

impl SafetyCounts {
    /// Adds the counts of other cells.
    pub fn add(&mut self, other: &Self) {
        self.true_positives += other.true_positives;
        self.false_positives += other.false_positives;
        self.true_negatives += other.true_negatives;
        self.false_negatives += other.false_negatives;
        self.unclassified_safe += other.unclassified_safe;
        self.unclassified_unsafe += other.unclassified_unsafe;
    }

    /// The count of cells that are safe or not in truth, and in the map (`None`: not classified there).
    pub(crate) fn of(&mut self, safe: bool, found: Option<bool>) -> &mut usize {
        match (safe, found) {
            (false, Some(false)) => &mut self.true_positives,
            (true, Some(false)) => &mut self.false_positives,
            (true, Some(true)) => &mut self.true_negatives,
            (false, Some(true)) => &mut self.false_negatives,
            (true, None) => &mut self.unclassified_safe,
            (false, None) => &mut self.unclassified_unsafe,
        }
    }

    /// Number of cells that are unsafe in truth.
    pub fn truly_unsafe(&self) -> usize {
        self.true_positives + self.false_negatives + self.unclassified_unsafe
    }

    /// Number of cells that are safe in truth.
    pub fn truly_safe(&self) -> usize {
        self.true_negatives + self.false_positives + self.unclassified_safe
    }

    /// Number of cells that the map does not classify.
    pub fn unclassified(&self) -> usize {
        self.unclassified_safe + self.unclassified_unsafe
    }

    /// Share of the unsafe cells that the map classifies which it takes for safe; NaN if it classifies none.
    pub fn false_negative_rate(&self) -> f64 {
        ratio(self.false_negatives, self.false_negatives + self.true_positives)
    }

    /// Share of the safe cells that the map classifies which it takes for unsafe; NaN if it classifies none.
    pub fn false_positive_rate(&self) -> f64 {
        ratio(self.false_positives, self.false_positives + self.true_negatives)
    }

    /// Share of the true map's classified cells that the map does not classify; NaN if there are none.
    pub fn unclassified_rate(&self) -> f64 {
        ratio(self.unclassified(), self.truly_safe() + self.truly_unsafe())
    }

    /// Share of the true map's unsafe cells that are unsafe in the map too; NaN if there are none.
    pub fn unsafe_found(&self) -> f64 {
        ratio(self.true_positives, self.truly_unsafe())
    }
}
