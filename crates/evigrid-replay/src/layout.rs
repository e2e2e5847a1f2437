use std::fmt;
use std::path::Path;

use crate::check_folder::Inspection;
use crate::{CheckReport, ReplayError, Sequence};

/// Arrangement of the files of a data set. Every layout describes itself in its own module; `Layout::ALL`
/// lists them.
#[derive(Clone, Copy)]
pub struct Layout(pub(crate) &'static LayoutSpec);

/// Description of one layout: everything that the rest of the project needs to know of it.
pub(crate) struct LayoutSpec {
    /// Name as it stands in tables and in `datasets/*.toml`, in kebab case.
    pub name: &'static str,
    /// Files and folders of such a data set, for a reader.
    pub wants: &'static str,
    /// Whether a folder has something that only this layout has. True of an incomplete folder, too.
    pub fits: fn(&Path) -> bool,
    /// Opens a folder of this layout.
    pub open: fn(&Path) -> Result<Box<dyn Sequence>, ReplayError>,
    /// Looks at each thing that such a folder should hold.
    pub check: fn(&mut Inspection),
}

impl Layout {
    /// Name as it stands in tables and in `datasets/*.toml`.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// Files and folders that a data set of this layout holds.
    pub fn wants(self) -> &'static str {
        self.0.wants
    }

    /// Opens a folder of this layout.
    ///
    /// # Errors
    /// If something that every frame needs is missing or wrong.
    pub fn open(self, dir: &Path) -> Result<Box<dyn Sequence>, ReplayError> {
        (self.0.open)(dir)
    }

    /// Looks through a folder of this layout.
    pub(crate) fn check(self, dir: &Path) -> CheckReport {
        let mut inspection = Inspection::new(dir);
        inspection.report.layout = Some(self);
        let opened = self.open(dir);
        if let Ok(sequence) = &opened {
            inspection.opened(sequence.info());
        }
        (self.0.check)(&mut inspection);
        // Whatever kept the recording from opening is among the problems, even if no item shows it.
        if let Err(error) = opened {
            inspection.problem(&error);
        }
        inspection.report
    }
}

impl PartialEq for Layout {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Layout {}

impl fmt::Debug for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_tuple("Layout").field(&self.name()).finish()
    }
}

impl fmt::Display for Layout {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(self.name())
    }
}
