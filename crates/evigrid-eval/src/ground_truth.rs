use evigrid_core::Frame;
use evigrid_grid::GridSpec;
use evigrid_metrics::Reference;
use evigrid_truth::{LaserTruth, SettingError, TruthSettings};

/// The reference of a run so far, and the frames that gave it nothing.
#[derive(Debug)]
pub(crate) struct GroundTruth {
    truth: LaserTruth,
    without_laser: Vec<usize>,
}

impl GroundTruth {
    /// Before the first frame.
    pub fn new(spec: GridSpec, settings: TruthSettings) -> Result<Self, SettingError> {
        Ok(Self { truth: LaserTruth::new(spec, settings)?, without_laser: Vec::new() })
    }

    /// Adds a frame's scan, if it has one.
    pub fn add(&mut self, frame: &Frame) {
        match frame.laser() {
            Some(scan) => self.truth.add_scan(scan),
            None => self.without_laser.push(frame.index()),
        }
    }

    /// `None` while there was no laser scan.
    pub fn if_any(&self) -> Option<&LaserTruth> {
        (self.truth.scans() > 0).then_some(&self.truth)
    }

    /// The same for scoring.
    pub fn reference(&self) -> Option<Reference<'_>> {
        self.if_any().map(|truth| Reference {
            spec: truth.spec(),
            occupied: truth.occupied(),
            observed: truth.observed(),
        })
    }

    /// Numbers of the frames that had no scan.
    pub fn without_laser(&self) -> &[usize] {
        &self.without_laser
    }
}
