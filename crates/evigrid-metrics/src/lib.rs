//! Scores of a map against a reference grid.
