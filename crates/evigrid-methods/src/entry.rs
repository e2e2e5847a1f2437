use evigrid_core::SettingError;
use evigrid_grid::{GridSpec, LayerKind, Mapper, MapperFamily, Method, Needs};
use schemars::Schema;
use toml::Table;

/// Why a method could not be set or built.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum MethodError {
    /// A setting outside its domain.
    #[error(transparent)]
    Setting(#[from] SettingError),
    /// A key that does not exist, or a value of another type; the message is one line.
    #[error("{0}")]
    Value(String),
}

type Build = fn(GridSpec, &Table) -> Result<Box<dyn Mapper>, MethodError>;

/// A method without its type: its description, and its functions over settings as TOML tables.
#[derive(Debug, Clone, Copy)]
pub struct Entry {
    /// The name on the command line, in tables, and as the section of the settings.
    pub name: &'static str,
    /// One line on what the method does and where it comes from.
    pub summary: &'static str,
    /// The inputs that the method cannot do without.
    pub needs: Needs,
    /// The kinds of maps that the method shows.
    pub layers: &'static [LayerKind],
    /// Schema of the settings; descriptions are the doc comments of their fields.
    pub schema: fn() -> Schema,
    /// The default settings.
    pub(crate) defaults: fn() -> Table,
    /// The section of the settings as TOML, header first: with all keys, shortest numbers, in the order of
    /// declaration.
    pub(crate) section: fn(&Table) -> Result<String, MethodError>,
    check: fn(&Table) -> Result<(), MethodError>,
    build: Build,
    families: fn(GridSpec, &[&Table]) -> Result<Vec<Family>, MethodError>,
}

/// Maps of one method that are built together.
pub struct Family {
    /// Positions, in the list of settings that were given, of the maps in the order of the family.
    pub members: Vec<usize>,
    /// The maps.
    pub mapper: Box<dyn MapperFamily>,
}

impl Entry {
    /// The entry of a type.
    pub const fn of<M: Method>() -> Self {
        Self {
            name: M::NAME,
            summary: M::SUMMARY,
            needs: M::NEEDS,
            layers: M::LAYERS,
            schema: || schemars::schema_for!(M::Settings),
            defaults: || written::<M>(&M::Settings::default()).unwrap_or_default(),
            section: |table| section::<M>(&parse::<M>(table)?),
            check: |table| Ok(M::check(&parse::<M>(table)?)?),
            build: |spec, table| Ok(M::build(spec, &parse::<M>(table)?)?),
            families: families::<M>,
        }
    }

    /// `Ok` if these settings are possible.
    ///
    /// # Errors
    /// If a key is unknown or a value is of another type or outside its domain.
    pub fn check(&self, settings: &Table) -> Result<(), MethodError> {
        (self.check)(settings)
    }

    /// An empty map over a grid.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn build(&self, spec: GridSpec, settings: &Table) -> Result<Box<dyn Mapper>, MethodError> {
        (self.build)(spec, settings)
    }

    /// Empty maps over a grid for many settings, those that are cheaper together in one family.
    ///
    /// # Errors
    /// As [`Self::check`].
    pub fn families(&self, spec: GridSpec, settings: &[&Table]) -> Result<Vec<Family>, MethodError> {
        (self.families)(spec, settings)
    }
}

/// The settings of a table, which may lack keys.
pub(crate) fn parse<M: Method>(table: &Table) -> Result<M::Settings, MethodError> {
    let one_line = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    table
        .clone()
        .try_into()
        .map_err(|e: toml::de::Error| MethodError::Value(format!("{}: {}", M::NAME, one_line(e.message()))))
}

fn section<M: Method>(settings: &M::Settings) -> Result<String, MethodError> {
    let section = std::collections::BTreeMap::from([(M::NAME, settings)]);
    toml::to_string(&section).map_err(|e| MethodError::Value(format!("{}: {e}", M::NAME)))
}

/// The settings as a table, by way of their text, in which singles have their shortest decimals.
fn written<M: Method>(settings: &M::Settings) -> Result<Table, MethodError> {
    of_section(M::NAME, &section::<M>(settings)?)
}

/// The table of a section that was written with its header.
pub(crate) fn of_section(name: &str, text: &str) -> Result<Table, MethodError> {
    let mut all: Table = text.parse().map_err(|e| MethodError::Value(format!("{name}: {e}")))?;
    match all.remove(name) {
        Some(toml::Value::Table(table)) => Ok(table),
        _ => Ok(Table::new()),
    }
}

fn families<M: Method>(spec: GridSpec, settings: &[&Table]) -> Result<Vec<Family>, MethodError> {
    let settings: Vec<M::Settings> =
        settings.iter().map(|table| parse::<M>(table)).collect::<Result<_, _>>()?;
    let mut groups: Vec<Vec<usize>> = Vec::new();
    for (number, own) in settings.iter().enumerate() {
        match groups.iter_mut().find(|group| M::shares(&settings[group[0]], own)) {
            Some(group) => group.push(number),
            None => groups.push(vec![number]),
        }
    }
    let mut families = Vec::new();
    for members in groups {
        let shared: Vec<M::Settings> = members.iter().map(|&number| settings[number].clone()).collect();
        let together = if shared.len() > 1 { M::build_family(spec, &shared)? } else { None };
        match together {
            Some(mapper) => families.push(Family { members, mapper }),
            None => {
                for (number, own) in members.into_iter().zip(&shared) {
                    let mapper: Box<dyn MapperFamily> = Box::new(M::build(spec, own)?);
                    families.push(Family { members: vec![number], mapper });
                }
            }
        }
    }
    Ok(families)
}
