//! Voxel grids, ray walks, log-odds and the three-way belief of a map.
