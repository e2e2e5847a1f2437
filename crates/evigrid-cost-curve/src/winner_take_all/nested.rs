//! Evidence and maps of which each accepts only a part of what the one before it accepts.

use std::ops::Range;
use std::sync::atomic::{AtomicI32, Ordering};

use rayon::prelude::*;

use evigrid_grid::{Clamp, FrameEvidence, GridSpec, LogOddsGrid};

/// No evidence in this frame. Lower than the key of every number.
const NONE: i32 = i32::MIN;

/// Evidence of one frame ([`FrameEvidence`]) for several maps at once, each of which accepts only a part of
/// what the map before it accepts: what is offered at level n counts for the first n maps. A ray is then
/// drawn once, not once per map.
#[derive(Debug)]
pub(crate) struct NestedEvidence {
    levels: usize,
    /// Keys by cell, then by level.
    keys: Vec<AtomicI32>,
}

/// The maps that [`NestedEvidence`] is fused into: occupancy grids of log-odds over the same cells.
#[derive(Debug)]
pub(crate) struct NestedMaps {
    spec: GridSpec,
    levels: usize,
    /// Log-odds by cell, then by level; NaN = never touched.
    values: Vec<f32>,
}

impl NestedMaps {
    /// Maps of unknown cells, one per level.
    pub fn unknown(spec: GridSpec, levels: usize) -> Self {
        Self { spec, levels, values: vec![f32::NAN; levels * spec.cell_count()] }
    }

    /// The grid's geometry.
    pub fn spec(&self) -> &GridSpec {
        &self.spec
    }

    /// One of the maps, counted from 0.
    pub fn map(&self, number: usize) -> LogOddsGrid {
        let mut map = LogOddsGrid::unknown(self.spec);
        let values = self.values.iter().skip(number).step_by(self.levels);
        map.values_mut().iter_mut().zip(values).for_each(|(to, from)| *to = *from);
        map
    }
}

impl NestedEvidence {
    /// Empty evidence for a grid of `cell_count` cells and one map per level.
    pub fn new(cell_count: usize, levels: usize) -> Self {
        Self { levels, keys: (0..levels * cell_count).map(|_| AtomicI32::new(NONE)).collect() }
    }

    /// Offers evidence (a key of [`FrameEvidence::key`]) for a cell to the first `level` maps, at least one;
    /// each keeps the largest.
    #[inline]
    pub fn offer(&self, flat: usize, level: usize, key: i32) {
        let slot = &self.keys[flat * self.levels + level - 1];
        if slot.load(Ordering::Relaxed) < key {
            slot.fetch_max(key, Ordering::Relaxed);
        }
    }

    /// How many of the maps have any evidence for a cell: the first so many.
    #[inline]
    pub fn level(&self, flat: usize) -> usize {
        let slots = &self.keys[flat * self.levels..(flat + 1) * self.levels];
        slots.iter().rposition(|slot| slot.load(Ordering::Relaxed) != NONE).map_or(0, |last| last + 1)
    }

    /// How many maps there are.
    pub fn levels(&self) -> usize {
        self.levels
    }

    /// Adds the frame's evidence to the maps as [`FrameEvidence::fuse_into`] does, and empties it for the
    /// next frame. All evidence must lie in the cells with these indices along x; others are not looked at.
    pub fn fuse_into(&mut self, maps: &mut NestedMaps, clamp: Clamp, layers: Range<usize>) {
        let levels = self.levels;
        let layer = maps.spec.strides()[0] * levels;
        let all = layers.start * layer..layers.end * layer;
        let keys = self.keys[all.clone()].par_chunks_mut(layer);
        let values = maps.values[all].par_chunks_mut(layer);
        keys.zip(values).for_each(|(keys, values)| {
            for (keys, values) in keys.chunks_exact_mut(levels).zip(values.chunks_exact_mut(levels)) {
                fuse_cell(keys, values, clamp);
            }
        });
    }
}

/// Adds the evidence of one cell to all maps: from the last level on down, the largest key so far counts.
fn fuse_cell(keys: &mut [AtomicI32], values: &mut [f32], clamp: Clamp) {
    let mut best = NONE;
    for (slot, value) in keys.iter_mut().zip(values).rev() {
        best = best.max(*slot.get_mut());
        *slot.get_mut() = NONE;
        if best != NONE {
            *value = clamp.add(*value, FrameEvidence::log_odds(best));
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use evigrid_grid::GridSettings;
    use proptest::prelude::*;

    const LEVELS: usize = 3;

    fn spec() -> GridSpec {
        let settings = GridSettings { x_m: [0.0, 0.8], y_m: [0.0, 0.4], z_m: [0.0, 0.2], cell_size_m: 0.2 };
        GridSpec::new(&settings).unwrap()
    }

    proptest! {
        /// The slow twin builds every map by itself, with the offers that it accepts.
        #[test]
        fn nested_maps_are_those_of_separate_evidence(
            frames in prop::collection::vec(
                prop::collection::vec((2..6_usize, 1..=LEVELS, -2.0..2.0_f32), 0..12),
                1..4,
            )
        ) {
            let clamp = Clamp { min: -2.5, max: 2.5 };
            let count = spec().cell_count();
            let mut nested = NestedEvidence::new(count, LEVELS);
            let mut maps = NestedMaps::unknown(spec(), LEVELS);
            for offers in &frames {
                for &(cell, level, log_odds) in offers {
                    nested.offer(cell, level, FrameEvidence::key(log_odds));
                    prop_assert!(nested.level(cell) >= level);
                }
                prop_assert_eq!(nested.level(0), 0);
                // Cells 2 to 5 are layers 1 and 2.
                nested.fuse_into(&mut maps, clamp, 1..3);
            }
            for number in 0..LEVELS {
                let mut alone = FrameEvidence::new(count);
                let mut map = LogOddsGrid::unknown(spec());
                for offers in &frames {
                    for &(cell, _, log_odds) in offers.iter().filter(|o| o.1 > number) {
                        alone.offer(cell, FrameEvidence::key(log_odds));
                    }
                    alone.fuse_into(&mut map, clamp);
                }
                let bits =
                    |map: &LogOddsGrid| map.values().iter().map(|v| v.to_bits()).collect::<Vec<_>>();
                prop_assert_eq!(bits(&maps.map(number)), bits(&map));
            }
        }
    }
}
