use std::collections::BTreeMap;

use evigrid_core::{Mounting, Pose};
use evigrid_grid::{LogOddsGrid, Method, SafetyMap};
use evigrid_safety_map::{Robot, SafetyMapping, label_voxels};
use toml::{Table, Value};

use crate::entry::{of_section, parse};
use crate::{Entry, MethodError, Methods};

/// The settings of all methods that a program offers, by name.
#[derive(Debug, Clone, PartialEq)]
pub struct MethodSettings {
    methods: Methods,
    tables: BTreeMap<&'static str, Table>,
}

impl Default for MethodSettings {
    fn default() -> Self {
        Self::defaults(Methods::default())
    }
}

impl MethodSettings {
    /// The defaults of these methods.
    pub fn defaults(methods: Methods) -> Self {
        let tables = methods.iter().map(|entry| (entry.name, (entry.defaults)())).collect();
        Self { methods, tables }
    }

    /// The methods.
    pub fn methods(&self) -> &Methods {
        &self.methods
    }

    /// The settings of the method of this name; empty if there is no such method.
    pub fn table(&self, name: &str) -> Table {
        self.tables.get(name).cloned().unwrap_or_default()
    }

    /// The settings of a method by its type; the defaults if it is not among the methods.
    ///
    /// # Errors
    /// If another type has registered under its name.
    pub fn of<M: Method>(&self) -> Result<M::Settings, MethodError> {
        self.tables.get(M::NAME).map_or_else(|| Ok(M::Settings::default()), parse::<M>)
    }

    /// The safety map of a map of voxels around the robot, by the rules and settings of `safety-map`.
    ///
    /// # Errors
    /// If another type has registered under the name of that method.
    pub fn safety_of_voxels(
        &self,
        voxels: &LogOddsGrid,
        map_from_left: &Pose,
        mounting: Mounting,
    ) -> Result<SafetyMap, MethodError> {
        let settings = self.of::<SafetyMapping>()?;
        Ok(label_voxels(voxels, &Robot::below(map_from_left, mounting), &settings))
    }

    /// Takes the sections of methods out of a table of all settings, and the settings from them.
    ///
    /// # Errors
    /// If a key is unknown or a value is of another type.
    pub fn take(&mut self, all: &mut Table) -> Result<(), MethodError> {
        for entry in self.methods.clone().iter() {
            if let Some(Value::Table(table)) = all.remove(entry.name) {
                let written = of_section(entry.name, &(entry.section)(&table)?)?;
                self.tables.insert(entry.name, written);
            }
        }
        Ok(())
    }

    /// Adds a section for each method to a table of all settings.
    pub fn put(&self, all: &mut Table) {
        all.extend(self.tables.iter().map(|(name, table)| ((*name).to_owned(), Value::Table(table.clone()))));
    }

    /// The sections as TOML, in the order of the methods.
    ///
    /// # Errors
    /// Never for settings that were taken from a table.
    pub fn to_toml(&self) -> Result<String, MethodError> {
        let section = |entry: &Entry| Ok(format!("\n{}", (entry.section)(&self.table(entry.name))?));
        self.methods.iter().map(section).collect()
    }
}
