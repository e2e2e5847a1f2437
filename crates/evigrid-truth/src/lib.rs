//! Laser scans and poses to the reference occupancy grid.
