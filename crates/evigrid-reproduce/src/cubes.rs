//! Cells as cubes, drawn in a slanted view: what is near the camera covers what is far.

use plotters::prelude::RGBColor;

use crate::cells::blend;
use crate::chart::{Marks, Point, Series};

/// A slanted view: how far a metre ahead moves things to the right and up, metres.
#[derive(Debug, Clone, Copy)]
pub struct Slant(pub [f64; 2]);

/// A cube: its lower corner in metres (ahead, left, up).
pub type Corner = [f64; 3];

impl Slant {
    /// Where a place is drawn: to the right and up, metres.
    pub fn place(self, [ahead, left, up]: Corner) -> Point {
        (-left + self.0[0] * ahead, up + self.0[1] * ahead)
    }
}

/// The three faces of all cubes that are seen from before, from the right and from above; far layers first.
pub fn cubes(
    slant: Slant,
    mut corners: Vec<Corner>,
    edge_m: f64,
    nearest: RGBColor,
    farthest: RGBColor,
) -> Vec<Series> {
    corners.sort_by(|a, b| b[0].total_cmp(&a[0]));
    let [last, first] = [corners.first(), corners.last()].map(|c| c.map_or(0.0, |c| c[0]));
    let mut series = Vec::new();
    for layer in corners.chunk_by(|a, b| (a[0] - b[0]).abs() < 0.5 * edge_m) {
        let share = (layer[0][0] - first) / (last - first).max(edge_m);
        let colour = blend(nearest, farthest, share);
        series.extend(faces(slant, layer, edge_m, colour));
    }
    series
}

/// The faces of the cubes of one layer, shaded.
pub fn faces(slant: Slant, layer: &[Corner], edge_m: f64, colour: RGBColor) -> [Series; 3] {
    let black = RGBColor(0, 0, 0);
    let side = blend(black, colour, 0.55);
    let top = blend(colour, RGBColor(255, 255, 255), 0.45);
    // A front covers the sides and tops of its neighbours in the layer.
    [(SIDE, side), (TOP, top), (FRONT, blend(black, colour, 0.85))].map(|(face, colour)| {
        let areas = layer.iter().map(|corner| outline(slant, *corner, edge_m, face)).collect();
        Series::new("", colour, Marks::Areas(areas))
    })
}

/// The four corners of a face, each as edges to go (ahead, left, up).
type Face = [[f64; 3]; 4];
const FRONT: Face = [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
const SIDE: Face = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 0.0, 1.0], [0.0, 0.0, 1.0]];
const TOP: Face = [[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 1.0], [0.0, 1.0, 1.0]];

fn outline(slant: Slant, corner: Corner, edge_m: f64, face: Face) -> Vec<Point> {
    face.map(|go| slant.place([0, 1, 2].map(|a| corner[a] + edge_m * go[a]))).to_vec()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::chart::BLUE;

    const SLANT: Slant = Slant([0.3, 0.22]);

    #[test]
    fn far_layers_come_first_and_have_three_faces() {
        let shown = cubes(SLANT, vec![[1.0, 0.0, 0.0], [5.0, 0.0, 0.0], [1.0, 1.0, 0.0]], 0.5, BLUE, BLUE);
        assert_eq!(shown.len(), 6);
        let count = |series: &Series| match &series.marks {
            Marks::Areas(areas) => areas.len(),
            _ => 0,
        };
        assert_eq!(shown.iter().map(count).collect::<Vec<_>>(), [1, 1, 1, 2, 2, 2]);
    }

    #[test]
    fn left_is_left_and_far_is_up() {
        let near = SLANT.place([0.0, 0.0, 0.0]);
        assert!(SLANT.place([0.0, 1.0, 0.0]).0 < near.0);
        assert!(SLANT.place([1.0, 0.0, 0.0]).1 > near.1);
    }
}
