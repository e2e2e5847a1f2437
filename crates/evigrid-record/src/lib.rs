//! The Rerun recording of a run: the camera, the map coloured by what the laser says of each cell, the scores, and a
//! layout that shows them at once. The only crate that names rerun.

mod blocks;
mod blueprint;
mod camera;
mod classes;
mod curve_plot;
mod disparity_image;
mod laser;
mod layout;
mod map;
mod recorder;
mod rrd;
mod series;
mod ticks;
mod top_view;
mod trajectory;

pub use recorder::Recorder;
