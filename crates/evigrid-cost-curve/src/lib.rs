//! Brandao et al.: winner-take-all occupancy mapping after Elfes.
