//! Synthetic worlds: shapes, renderer and simulated laser, as a sequence of frames.
