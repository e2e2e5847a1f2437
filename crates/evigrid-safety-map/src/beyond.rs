//! Unsafe cells that the paper leaves unknown or takes for safe. (Own additions.)

use std::collections::VecDeque;

use evigrid_grid::{SafetyLabel, SafetyMap};

use crate::columns::Columns;
use crate::segments::Segments;

/// Holes: empty columns beside safe ground that were seen through at the height of that ground, given by its
/// plane. A drop-off hides the ground below it from the camera, but not that there is no floor beyond its edge.
/// `is_free` tells whether a cell was seen through at a height in the map frame, metres.
pub(crate) fn mark_holes(
    map: &mut SafetyMap,
    columns: &Columns,
    segments: &Segments,
    is_free: &dyn Fn(usize, f64) -> bool,
) -> Vec<bool> {
    let mut is_hole = vec![false; map.labels().len()];
    let safe = columns.examined().filter(|&cell| map.labels()[cell].is_safe() == Some(true));
    // A cell with the segment whose plane it is held against; a hole hands its own on.
    let mut open: VecDeque<(usize, usize)> =
        safe.filter_map(|cell| Some((cell, segments.of(cell)?))).collect();
    while let Some((cell, segment)) = open.pop_front() {
        let Some(plane) = segments.list[segment].plane else { continue };
        for other in columns.spec().neighbours(cell) {
            let empty = columns.is_examined(other) && columns.get(other).is_none() && !is_hole[other];
            if empty && is_free(other, plane.height_m(columns.spec().centre_m(other))) {
                is_hole[other] = true;
                map.set(other, SafetyLabel::NonGround, None);
                open.push_back((other, segment));
            }
        }
    }
    is_hole
}

/// Edges: safe cells next to a hole or to lower unsafe ground. Part of such a cell hangs over the drop.
pub(crate) fn mark_edges(map: &mut SafetyMap, columns: &Columns, is_hole: &[bool]) {
    let is_edge = |&cell: &usize| {
        let Some(height) = columns.height(cell).filter(|_| map.labels()[cell].is_safe() == Some(true)) else {
            return false;
        };
        columns.spec().neighbours(cell).any(|other| {
            let lower = columns.height(other).is_some_and(|there| there < height);
            is_hole[other] || (lower && map.labels()[other] == SafetyLabel::NonGround)
        })
    };
    let edges: Vec<usize> = columns.examined().filter(is_edge).collect();
    edges.into_iter().for_each(|cell| map.set(cell, SafetyLabel::NonGround, None));
}

/// Enclosed cells: unknown ones that no way over safe and unknown cells within the planning radius connects
/// with the robot.
pub(crate) fn mark_enclosed(map: &mut SafetyMap, columns: &Columns, segments: &Segments) {
    let Some(start) = segments.list.first() else { return };
    let mut is_reached = vec![false; map.labels().len()];
    let is_open = |map: &SafetyMap, cell: usize| {
        columns.is_examined(cell) && map.labels()[cell].is_safe() != Some(false)
    };
    let mut open: Vec<usize> = start.cells.iter().map(|&cell| cell as usize).collect();
    open.retain(|&cell| is_open(map, cell));
    open.iter().for_each(|&cell| is_reached[cell] = true);
    while let Some(cell) = open.pop() {
        for other in columns.spec().neighbours(cell) {
            if !is_reached[other] && is_open(map, other) {
                is_reached[other] = true;
                open.push(other);
            }
        }
    }
    let enclosed = |&cell: &usize| !is_reached[cell] && map.labels()[cell] == SafetyLabel::Unknown;
    let enclosed: Vec<usize> = columns.examined().filter(enclosed).collect();
    enclosed.into_iter().for_each(|cell| map.set(cell, SafetyLabel::NonGround, None));
}
