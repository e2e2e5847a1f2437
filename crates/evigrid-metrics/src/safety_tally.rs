use evigrid_grid::SafetyMap;

use crate::safety_areas::{AreaTally, add_to_areas};
use crate::safety_cells::PlanningDisc;
use crate::{SafetyCase, SafetyPlaces, SafetyReference};

/// The safety maps of a run counted against the true one, summed over frames.
#[derive(Debug, Clone, PartialEq)]
pub struct SafetyTally {
    /// All cells.
    pub case: SafetyCase,
    /// Cells by where they lie.
    pub places: SafetyPlaces,
    /// Named hazards and safe areas, in the order of the truth.
    pub areas: Vec<AreaTally>,
    /// Edge of a cell of the true map, metres.
    pub cell_size_m: f64,
}

impl SafetyTally {
    /// No frame yet.
    pub fn new(truth: &SafetyReference) -> Self {
        Self {
            case: SafetyCase::default(),
            places: SafetyPlaces::default(),
            areas: truth.areas().iter().cloned().map(AreaTally::new).collect(),
            cell_size_m: truth.map().spec().cell_size_m(),
        }
    }

    /// Adds the map after a frame, given by its position in the run, from 0.
    pub fn add(&mut self, found: &SafetyMap, truth: &SafetyReference, disc: PlanningDisc, position: usize) {
        self.case.add(&SafetyCase::new(found, truth, Some(disc)));
        self.places.add(found, truth, disc, position);
        add_to_areas(&mut self.areas, found, truth, disc);
    }
}
