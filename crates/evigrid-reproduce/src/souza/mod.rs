//! The figures of Souza, Maia, Aroca, Goncalves: "Probabilistic robotic grid mapping based on occupancy and elevation
//! information". Each item becomes ITEM.csv and ITEM.svg.

mod matching;

use std::path::PathBuf;

use anyhow::Result;

use crate::job::{self, Make};
use crate::{Folders, Tools};

/// All items, in the order of the paper.
const ITEMS: [(&str, Make); 1] = [("matching", matching::make)];

/// Makes one item or all of them; of all, those whose data are not there are left out and named.
pub fn reproduce(item: Option<&str>, folders: &Folders, tools: &mut Tools<'_>) -> Result<Vec<PathBuf>> {
    job::make_items("souza", &ITEMS, item, folders, tools)
}
