//! What the metrics of one kind have in common.

use crate::metric::{Better, Kind, Metric, Of, Show, Tolerance};

/// A rate that is better when it is higher. Runs repeat to the last digit, so the tolerance is not for noise:
/// 0.002 is what is too little to care about.
pub(crate) const RATE: Metric = Metric {
    name: "",
    kind: Kind::Rate,
    unit: "0..1",
    better: Better::Higher,
    tolerance: Tolerance { amount: 0.002, share: 0.0 },
    judged: true,
    formula: "",
    show: Show::No,
    of: Of::Run,
};

/// A rate that is better when it is lower.
pub(crate) const ERROR_RATE: Metric = Metric { better: Better::Lower, ..RATE };

/// A count that says again what the rates say, so it is not judged.
pub(crate) const COUNT: Metric = Metric {
    kind: Kind::Count,
    unit: "cells",
    better: Better::Lower,
    tolerance: Tolerance { amount: 0.0, share: 0.01 },
    judged: false,
    ..RATE
};

/// Cells of the reference. Not every machine rounds a synthetic world alike, so a thousandth may differ.
pub(crate) const REFERENCE: Metric = Metric {
    kind: Kind::Reference,
    better: Better::Neither,
    tolerance: Tolerance { amount: 0.0, share: 0.001 },
    ..COUNT
};

/// Time of one stage of a frame: not judged and better when it is lower, as a count. A clock is off by half a
/// millisecond on its own.
pub(crate) const TIME: Metric =
    Metric { kind: Kind::Cost, unit: "ms", tolerance: Tolerance { amount: 0.5, share: 0.2 }, ..COUNT };
