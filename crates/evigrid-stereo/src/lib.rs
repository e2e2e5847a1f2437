//! Matchers: SAD cost volume, winner-take-all, peak ratio, left-right check.
