use evigrid_grid::{SafetyLabel, SafetyMap};

use crate::columns::Columns;

/// Marks potential drop-off edges (section VI): cells at the boundary of safe ground, next to an unknown cell,
/// with a lower column at most `reach` cells away.
pub(crate) fn mark_drop_offs(map: &mut SafetyMap, columns: &Columns, reach: usize) {
    for cell in columns.examined() {
        let Some(height) = columns.height(cell).filter(|_| map.labels()[cell].is_safe() == Some(true)) else {
            continue;
        };
        let unknown = columns.spec().neighbours(cell).any(|n| map.labels()[n] == SafetyLabel::Unknown);
        let is_lower = |n: usize| columns.height(n).is_some_and(|other| other < height);
        if unknown && columns.spec().around(cell, reach).any(is_lower) {
            map.mark_drop_off(cell);
        }
    }
}
