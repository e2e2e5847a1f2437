use std::sync::Arc;

use evigrid_core::name_hint;
use evigrid_grid::Method;

use crate::Entry;
use crate::list::BUILT_IN;

/// The methods that a program offers: the built-in ones, and perhaps more.
#[derive(Debug, Clone)]
pub struct Methods(Arc<[Entry]>);

impl Default for Methods {
    fn default() -> Self {
        Self(BUILT_IN.into())
    }
}

impl PartialEq for Methods {
    fn eq(&self, other: &Self) -> bool {
        self.iter().map(|m| m.name).eq(other.iter().map(|m| m.name))
    }
}

impl Methods {
    /// These methods and one more, which replaces one of the same name.
    #[must_use]
    pub fn with<M: Method>(&self) -> Self {
        let others = self.iter().filter(|entry| entry.name != M::NAME).copied();
        Self(others.chain([Entry::of::<M>()]).collect())
    }

    /// All methods, in the order in which they are listed.
    pub fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.0.iter()
    }

    /// The method of a name.
    pub fn find(&self, name: &str) -> Option<&Entry> {
        self.iter().find(|entry| entry.name == name)
    }

    /// A hint for a name that is none: the nearest one.
    pub fn hint(&self, name: &str) -> String {
        name_hint(name, self.iter().map(|entry| entry.name))
    }
}
