//! The Rerun recording of a run: the camera, maps coloured by their truth, the scores, and a layout that
//! shows them at once. The only crate that names rerun.
//!
//! A recording is a list of parts (`parts.rs`). A part writes its entities and names its views; `layout.rs`
//! arranges the views of all parts.

mod blocks;
mod blueprint;
mod camera;
mod classes;
mod curve_plot;
mod disparity_image;
mod hybrid;
mod labelled_image;
mod laser;
mod layout;
mod map;
mod part;
mod parts;
mod plan;
mod plan_ground;
mod recorder;
mod roc_plot;
mod rrd;
mod safety;
mod safety_verdict;
mod series;
mod sight;
mod summary;
mod ticks;
mod top_view;
mod trajectory;

pub use recorder::Recorder;
