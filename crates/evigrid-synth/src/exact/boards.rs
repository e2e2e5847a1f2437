//! How much of a board the cameras see.

use nalgebra::{Point3, Vector3};

use crate::World;
use crate::shape::Shape;
use crate::view_truth::{LeftViewTruth, PixelTruth};

/// The visible part of a board at a frame.
#[derive(Debug, Clone, PartialEq)]
pub struct BoardView {
    /// The number of the `[[object]]`, copies counted.
    pub thing: usize,
    /// Its name, if it has one.
    pub name: Option<String>,
    /// Depth of its centre along the optical axis of the left camera, metres; negative behind the camera.
    pub distance_m: f64,
    /// Its full width, metres.
    pub width_m: f64,
    /// The width that the left image shows, metres.
    pub visible_left_m: f64,
    /// The width that both images show, metres.
    pub visible_both_m: f64,
}

/// The visible parts of all things that are declared as boards at a frame, given the
/// exact view of the left camera.
///
/// The width runs along the longer of the board's own two level axes, between its bounds. A pixel whose
/// centre shows the front or the back of the board shows the part of the width that its left and right border
/// enclose on the upright plane through the point, no further than the bounds. The visible width is the
/// length of the union of these parts over all pixels; it is right to half a pixel at each border of what is
/// seen. Both images show what a pixel of the left image sees and the right camera sees too.
pub fn boards(world: &World, frame: usize, view: &LeftViewTruth) -> Vec<BoardView> {
    let things = world.contents.things.iter().enumerate().filter(|(_, thing)| thing.is_board);
    things.map(|(index, _)| board_view(world, frame, view, index)).collect()
}

fn board_view(world: &World, frame: usize, view: &LeftViewTruth, index: usize) -> BoardView {
    let thing = &world.contents.things[index];
    let world_from_left = world.true_world_from_left(frame);
    let thing_from_left = thing.world_from_thing(world.time_s(frame)).inverse() * world_from_left;
    let [low, high] = thing.bounds;
    let lengths = high - low;
    let (along, across) = if lengths.x >= lengths.y { (0, 1) } else { (1, 0) };
    let (mut left, mut both) = (Vec::new(), Vec::new());
    for (i, pixel) in view.pixels().iter().enumerate() {
        if pixel.thing != Some(index as u32) || !shows_front(world, pixel, along, across) {
            continue;
        }
        let (x, y) = ((i % view.width()) as f64, (i / view.width()) as f64);
        let direction = |x: f64| thing_from_left.rotation * world.rig.ray(x, y);
        let eye = thing_from_left.translation.vector;
        let depth = direction(x)[across] * pixel.depth_m;
        let place = |x: f64| {
            let ray = direction(x);
            (eye[along] + depth / ray[across] * ray[along]).clamp(low[along], high[along])
        };
        let ends = [place(x - 0.5), place(x + 0.5)];
        if ends.iter().any(|end| end.is_nan()) {
            continue;
        }
        let part = [ends[0].min(ends[1]), ends[0].max(ends[1])];
        left.push(part);
        if pixel.seen_by_right {
            both.push(part);
        }
    }
    let centre = Point3::from((low + high) * 0.5);
    BoardView {
        thing: index,
        name: thing.name.clone(),
        distance_m: (thing_from_left.inverse() * centre).z,
        width_m: lengths[along],
        visible_left_m: length_of_union(left),
        visible_both_m: length_of_union(both),
    }
}

/// Whether a pixel shows a side of a board's box that faces across rather than along the width. Other shapes
/// have no such sides; all of them counts.
fn shows_front(world: &World, pixel: &PixelTruth, along: usize, across: usize) -> bool {
    let Some((part, side)) = pixel.surface else { return false };
    let part = &world.contents.parts[part as usize];
    if !matches!(part.shape, Shape::Box { .. }) {
        return true;
    }
    let axis = (side / 2) as usize;
    let local = Vector3::from_fn(|row, _| if row == axis { 1.0 } else { 0.0 });
    let normal = part.thing_from_local.rotation * local;
    normal[across].abs() > normal[along].abs().max(normal.z.abs())
}

fn length_of_union(mut parts: Vec<[f64; 2]>) -> f64 {
    parts.sort_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    let (mut length, mut end) = (0.0, f64::NEG_INFINITY);
    for [from, to] in parts {
        length += (to - from.max(end)).max(0.0);
        end = end.max(to);
    }
    length
}

#[cfg(test)]
#[path = "boards_tests.rs"]
mod tests;
