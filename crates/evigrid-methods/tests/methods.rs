//! The list of methods and their settings, with a method from outside among them.
#![allow(clippy::unwrap_used, missing_docs)]

use evigrid_core::{SettingError, View};
use evigrid_grid::{
    GridSettings, GridSpec, Layer, LayerKind, LogOddsGrid, MapError, Mapper, MapperFamily, Method, Needs,
};
use evigrid_methods::{Entry, MethodSettings, Methods};
use toml::Table;

/// A method that maps nothing; its maps are built together where `group` is equal.
#[derive(Debug)]
struct Toy(LogOddsGrid);

#[derive(Debug, Clone, PartialEq, serde::Serialize, serde::Deserialize, schemars::JsonSchema)]
#[serde(default, deny_unknown_fields)]
struct ToySettings {
    /// At most 1. Unit: none. Source: this test.
    share: f32,
    /// Maps of one group are built together. Unit: none. Source: this test.
    group: usize,
}

impl Default for ToySettings {
    fn default() -> Self {
        Self { share: 0.1, group: 0 }
    }
}

impl Mapper for Toy {
    fn integrate(&mut self, _: &View<'_>) -> Result<(), MapError> {
        Ok(())
    }

    fn layers(&self) -> Vec<Layer<'_>> {
        vec![Layer::from(&self.0)]
    }
}

/// Maps of one group.
struct ToyFamily(Vec<Toy>);

impl MapperFamily for ToyFamily {
    fn integrate(&mut self, view: &View<'_>) -> Result<(), MapError> {
        self.0.iter_mut().try_for_each(|toy| Mapper::integrate(toy, view))
    }

    fn layers(&self, member: usize) -> Vec<Layer<'_>> {
        Mapper::layers(&self.0[member])
    }
}

impl Method for Toy {
    const NAME: &'static str = "toy";
    const SUMMARY: &'static str = "maps nothing";
    const NEEDS: Needs = Needs::NOTHING;
    const LAYERS: &'static [LayerKind] = &[LayerKind::Voxels];
    type Settings = ToySettings;

    fn check(settings: &ToySettings) -> Result<(), SettingError> {
        evigrid_core::require_setting(settings.share <= 1.0, Self::NAME, "share", "at most 1", settings.share)
    }

    fn build(spec: GridSpec, settings: &ToySettings) -> Result<Box<dyn Mapper>, SettingError> {
        Self::check(settings)?;
        Ok(Box::new(Self(LogOddsGrid::unknown(spec))))
    }

    fn shares(a: &ToySettings, b: &ToySettings) -> bool {
        a.group == b.group
    }

    fn build_family(
        spec: GridSpec,
        members: &[ToySettings],
    ) -> Result<Option<Box<dyn MapperFamily>>, SettingError> {
        let toys = members.iter().map(|_| Self(LogOddsGrid::unknown(spec))).collect();
        Ok(Some(Box::new(ToyFamily(toys))))
    }
}

fn spec() -> GridSpec {
    GridSpec::new(&GridSettings::default()).unwrap()
}

fn table(text: &str) -> Table {
    text.parse().unwrap()
}

#[test]
fn every_method_builds_an_empty_map_of_the_kinds_that_it_names() {
    let methods = Methods::default().with::<Toy>();
    assert!(methods.iter().count() > 8);
    for method in methods.iter() {
        let settings = MethodSettings::defaults(methods.clone()).table(method.name);
        let mapper = method.build(spec(), &settings).unwrap();
        let kinds: Vec<LayerKind> = Mapper::layers(&*mapper).iter().map(Layer::kind).collect();
        assert_eq!(kinds, method.layers, "{}", method.name);
    }
}

#[test]
fn defaults_are_those_of_the_type_and_stand_in_the_file_as_a_person_would_write_them() {
    let settings = MethodSettings::defaults(Methods::default().with::<Toy>());
    assert_eq!(settings.of::<Toy>().unwrap(), ToySettings::default());
    let text = settings.to_toml().unwrap();
    assert!(text.ends_with("\n[toy]\nshare = 0.1\ngroup = 0\n"), "{text}");
    let mut again = MethodSettings::defaults(Methods::default().with::<Toy>());
    again.take(&mut table(&text)).unwrap();
    assert_eq!(again, settings);
}

#[test]
fn a_section_may_lack_keys_but_not_invent_them() {
    let mut settings = MethodSettings::defaults(Methods::default().with::<Toy>());
    let mut all = table("[toy]\ngroup = 3\n[other]\nkey = 1\n");
    settings.take(&mut all).unwrap();
    assert_eq!(settings.of::<Toy>().unwrap(), ToySettings { group: 3, ..ToySettings::default() });
    assert_eq!(all, table("[other]\nkey = 1\n"), "sections that belong to no method stay");
    let wrong = settings.take(&mut table("[toy]\ngroop = 3\n")).unwrap_err().to_string();
    assert!(wrong.contains("toy") && wrong.contains("groop"), "{wrong}");
    assert!(!wrong.contains('\n'), "{wrong}");
}

#[test]
fn values_are_checked_by_the_method() {
    let entry = Entry::of::<Toy>();
    assert!(entry.check(&table("share = 1.0")).is_ok());
    let wrong = entry.check(&table("share = 1.5")).unwrap_err().to_string();
    assert!(wrong.contains("toy.share") && wrong.contains("1.5"), "{wrong}");
    assert!(entry.build(spec(), &table("share = 1.5")).is_err());
    let wrong = entry.check(&table("share = \"much\"")).unwrap_err().to_string();
    assert!(wrong.contains("toy"), "{wrong}");
}

#[test]
fn settings_that_share_a_drawing_make_one_family_and_keep_their_order() {
    let settings: Vec<Table> = [0, 1, 0, 2, 1].map(|group| table(&format!("group = {group}"))).to_vec();
    let settings: Vec<&Table> = settings.iter().collect();
    let families = Entry::of::<Toy>().families(spec(), &settings).unwrap();
    let members: Vec<_> = families.iter().map(|family| family.members.clone()).collect();
    assert_eq!(members, [vec![0, 2], vec![1, 4], vec![3]]);
}

#[test]
fn a_name_is_found_or_hinted_at() {
    let methods = Methods::default().with::<Toy>().with::<Toy>();
    assert_eq!(methods.iter().filter(|m| m.name == "toy").count(), 1);
    assert!(methods.find("toy").is_some() && methods.find("winner-take-al").is_none());
    assert!(methods.hint("winner-take-al").contains("winner-take-all"));
}
