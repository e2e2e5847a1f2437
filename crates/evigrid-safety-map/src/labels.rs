//! Labels of segments and cells (section VI, Algorithm 2).

use std::collections::BTreeMap;

use evigrid_grid::{SafetyLabel, SafetyMap};

use crate::beyond::{mark_edges, mark_enclosed, mark_holes};
use crate::columns::Columns;
use crate::edges::mark_drop_offs;
use crate::robot::Robot;
use crate::segments::{Segment, Segments};
use crate::settings::{SafetyMapSettings, Spread};

/// State of a segment while its label is sought.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum State {
    Unexamined,
    NonGround,
    Unknown,
    Safe,
}

/// The safety map of a height map, around a robot whose floor is in the layer `floor_layer`. `is_free` tells
/// whether a cell was seen through at a height in the map frame, metres.
pub fn label_columns(
    columns: &Columns,
    robot: &Robot,
    floor_layer: i32,
    settings: &SafetyMapSettings,
    is_free: &dyn Fn(usize, f64) -> bool,
) -> SafetyMap {
    let segments = Segments::find(columns, robot, floor_layer, settings);
    let states = segment_states(columns, &segments, settings);
    let mut map = cell_labels(columns, &segments, &states, settings);
    mark_drop_offs(&mut map, columns, settings.edge_reach);
    let mut is_hole = vec![false; map.labels().len()];
    if settings.hole_at > 0 {
        is_hole = mark_holes(&mut map, columns, &segments, is_free);
    }
    if settings.edges_unsafe {
        mark_edges(&mut map, columns, &is_hole);
    }
    if settings.enclosed_unsafe {
        mark_enclosed(&mut map, columns, &segments);
    }
    map
}

/// Algorithm 2 but for its last step.
fn segment_states(columns: &Columns, segments: &Segments, settings: &SafetyMapSettings) -> Vec<State> {
    let mut states: Vec<State> = segments.list.iter().map(|s| first_state(s, settings)).collect();
    if states.is_empty() {
        return states;
    }
    let borders = Borders::find(columns, segments, settings);
    states[0] = State::Safe;
    // L_S: safe segments whose neighbours have not been examined.
    let mut to_examine = vec![0];
    while let Some(safe) = to_examine.pop() {
        for (neighbour, agreeing) in borders.of(safe) {
            let open = match settings.spread {
                Spread::Unexamined => states[neighbour] == State::Unexamined,
                Spread::Any => states[neighbour] != State::Safe,
            };
            if open && agreeing >= settings.min_border_cells {
                states[neighbour] = State::Safe;
                to_examine.push(neighbour);
            }
        }
    }
    states
}

/// Steps 1 to 4: steep segments are unsafe, small and thin ones unknown, and so are those without a plane.
fn first_state(segment: &Segment, settings: &SafetyMapSettings) -> State {
    let boundary = segment.cells.len() - segment.interior;
    let thin = (segment.interior as f64) < settings.min_interior_per_boundary * boundary as f64;
    match segment.plane {
        None => State::Unknown,
        _ if segment.cells.len() < settings.min_segment_cells || thin => State::Unknown,
        Some(plane) if plane.slope_deg() > settings.max_slope_deg => State::NonGround,
        Some(_) => State::Unexamined,
    }
}

/// Where segments meet: for each pair, the lower number first, how many of the boundary cells of either, next
/// to the other (c_RS), have planes of nearly one height.
struct Borders(BTreeMap<[usize; 2], usize>);

impl Borders {
    fn find(columns: &Columns, segments: &Segments, settings: &SafetyMapSettings) -> Self {
        let mut agreeing = BTreeMap::new();
        let mut others = Vec::new();
        for (own, segment) in segments.list.iter().enumerate() {
            for &cell in &segment.cells {
                others.clear();
                for neighbour in columns.spec().neighbours(cell as usize) {
                    match segments.of(neighbour) {
                        Some(other) if other != own && !others.contains(&other) => others.push(other),
                        _ => {}
                    }
                }
                let at_m = columns.spec().centre_m(cell as usize);
                for &other in &others {
                    let planes = [segment.plane, segments.list[other].plane];
                    let [Some(own_plane), Some(other_plane)] = planes else { continue };
                    let step_m = (own_plane.height_m(at_m) - other_plane.height_m(at_m)).abs();
                    if step_m < settings.max_step_m {
                        *agreeing.entry([own.min(other), own.max(other)]).or_insert(0) += 1;
                    }
                }
            }
        }
        Self(agreeing)
    }

    /// The segments that border on a segment, with the number of agreeing cells.
    fn of(&self, segment: usize) -> impl Iterator<Item = (usize, usize)> {
        self.0.iter().filter_map(move |(&[a, b], &agreeing)| match segment {
            _ if segment == a => Some((b, agreeing)),
            _ if segment == b => Some((a, agreeing)),
            _ => None,
        })
    }
}

/// Labels of all cells: those of their segments; other columns are unsafe, and cells without a column unknown.
fn cell_labels(
    columns: &Columns,
    segments: &Segments,
    states: &[State],
    settings: &SafetyMapSettings,
) -> SafetyMap {
    let mut map = SafetyMap::of(*columns.spec(), SafetyLabel::Unexamined);
    for cell in columns.examined() {
        let nobody_knows = segments.list.is_empty() || columns.get(cell).is_none();
        let label = if nobody_knows { SafetyLabel::Unknown } else { SafetyLabel::NonGround };
        map.set(cell, label, None);
    }
    for (segment, state) in segments.list.iter().zip(states) {
        let plane = segment.plane.map(|plane| map.add_plane(plane.by_normal()));
        let slope_deg = segment.plane.map_or(0.0, |plane| plane.slope_deg());
        let label = match state {
            State::Safe if slope_deg > settings.level_slope_deg => SafetyLabel::Inclined,
            State::Safe => SafetyLabel::Level,
            State::Unknown => SafetyLabel::Unknown,
            State::NonGround | State::Unexamined => SafetyLabel::NonGround,
        };
        segment.cells.iter().for_each(|&cell| map.set(cell as usize, label, plane));
    }
    map
}
