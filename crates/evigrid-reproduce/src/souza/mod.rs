//! The figures of Souza, Maia, Goncalves, "3D Probabilistic Occupancy Grid to Robotic Mapping with Stereo Vision" (2012), and
//! whether its claim holds. The paper publishes no numbers.

mod cubes;
mod drifting;
mod fig1;
mod fig7;
mod fig9;
mod matchers;
mod matching;
mod motion_error;
mod motion_picture;
mod motion_sweep;
mod robot;

use std::path::PathBuf;

use anyhow::Result;

use crate::job::{Make, make_items};
use crate::{Folders, Tools};

/// All items. (Figs 2 to 6 and 8 are sketches and photographs.)
const ITEMS: [(&str, Make); 5] = [
    ("fig1", fig1::make),
    ("fig7", fig7::make),
    ("fig9", fig9::make),
    ("motion-error", motion_error::make),
    ("matching", matching::make),
];

/// Makes one item or all of them.
pub fn reproduce(item: Option<&str>, folders: &Folders, tools: &mut Tools<'_>) -> Result<Vec<PathBuf>> {
    make_items("souza", &ITEMS, item, folders, tools)
}
