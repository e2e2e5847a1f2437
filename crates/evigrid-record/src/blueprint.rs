//! Writes a layout of the viewer. Done by hand, since the builder that comes with Rerun has neither the eye
//! of a 3-D view nor the bounds of a 2-D view, and gives everything random names.

use std::io::Write;

use anyhow::Result;
use rerun::blueprint::components::{
    ActiveTab, ColumnShare, ContainerKind, IncludedContent, PanelState, PlayState, QueryExpression,
    RootContainer, RowShare,
};
use rerun::external::re_sdk_types::blueprint::archetypes::{
    ContainerBlueprint, PanelBlueprint, TimePanelBlueprint, ViewBlueprint, ViewContents, ViewportBlueprint,
};
use rerun::external::uuid::Uuid;
use rerun::{AsComponents, TimeCell, TimePoint};

use crate::rrd::{Rrd, Store};

/// A part of the window.
pub(crate) enum Node {
    /// Parts beside, above or behind each other, with their shares of the space (tabs have none).
    Container { kind: ContainerKind, parts: Vec<(f32, Node)> },
    /// One view.
    View(Pane),
}

/// One view, with its contents and settings.
pub(crate) struct Pane {
    /// Class of the view, as Rerun calls it: 3D, 2D, TimeSeries, TextDocument.
    pub class: &'static str,
    /// Title.
    pub title: String,
    /// The entity in whose frame things are shown.
    pub origin: String,
    /// Entities that are shown, as query expressions.
    pub contents: Vec<String>,
    /// Settings of the view, by name.
    pub properties: Vec<(&'static str, Box<dyn AsComponents>)>,
}

impl Pane {
    /// A view of everything below an entity, which is also its origin.
    pub fn new(class: &'static str, title: impl Into<String>, origin: &str) -> Self {
        Self {
            class,
            title: title.into(),
            origin: format!("/{origin}"),
            contents: vec!["+ $origin/**".into()],
            properties: Vec::new(),
        }
    }

    /// The view with one more setting.
    #[must_use]
    pub fn with(mut self, name: &'static str, property: impl AsComponents + 'static) -> Self {
        self.properties.push((name, Box::new(property)));
        self
    }
}

impl Node {
    pub fn columns(parts: Vec<(f32, Self)>) -> Self {
        Self::Container { kind: ContainerKind::Horizontal, parts }
    }

    pub fn rows(parts: Vec<(f32, Self)>) -> Self {
        Self::Container { kind: ContainerKind::Vertical, parts }
    }

    /// Parts behind each other, the first in front; a single one needs no tabs.
    pub fn tabs(mut parts: Vec<Self>) -> Self {
        if parts.len() == 1 {
            return parts.remove(0);
        }
        let parts = parts.into_iter().map(|node| (1.0, node)).collect();
        Self::Container { kind: ContainerKind::Tabs, parts }
    }
}

/// Logs a layout and makes it the one that the file opens with. `root` must be a container.
pub(crate) fn write_blueprint<W: Write>(
    rrd: &mut Rrd<W>,
    store: &mut Store,
    root: &Node,
    timeline: &str,
) -> Result<()> {
    rrd.open(store)?;
    let mut writer = BlueprintWriter { rrd, store, ids: 0 };
    let (_, id) = writer.node(root)?;
    let viewport = ViewportBlueprint::new()
        .with_root_container(RootContainer(id.into()))
        .with_auto_layout(false)
        .with_auto_views(false);
    writer.log("viewport", &viewport)?;
    let folded = PanelBlueprint::new().with_state(PanelState::Collapsed);
    writer.log("blueprint_panel", &folded)?;
    writer.log("selection_panel", &folded)?;
    let time = TimePanelBlueprint::new()
        .with_state(PanelState::Collapsed)
        .with_timeline(timeline)
        .with_fps(10.0)
        // Following goes to the last frame: a finished map is what one wants to see first.
        .with_play_state(PlayState::Following);
    writer.log("time_panel", &time)?;
    rrd.activate(store)
}

struct BlueprintWriter<'a, W: Write> {
    rrd: &'a mut Rrd<W>,
    store: &'a mut Store,
    ids: u128,
}

impl<W: Write> BlueprintWriter<'_, W> {
    fn log(&mut self, path: &str, what: &dyn AsComponents) -> Result<()> {
        let at = TimePoint::default().with_index("blueprint", TimeCell::ZERO_SEQUENCE);
        self.rrd.log(self.store, path, &at, what)
    }

    /// Logs a node and all below it; returns its path and identifier. Identifiers differ between layouts,
    /// since a viewer remembers what it knows of a view by its identifier.
    fn node(&mut self, node: &Node) -> Result<(String, Uuid)> {
        self.ids += 1;
        let id = Uuid::from_u128(u128::from(self.store.stem()) << 64 | self.ids);
        match node {
            Node::Container { kind, parts } => {
                let path = format!("container/{id}");
                self.container(&path, *kind, parts)?;
                Ok((path, id))
            }
            Node::View(view) => {
                let path = format!("view/{id}");
                self.view(&path, view)?;
                Ok((path, id))
            }
        }
    }

    fn container(&mut self, path: &str, kind: ContainerKind, parts: &[(f32, Node)]) -> Result<()> {
        let mut paths = Vec::new();
        for (_, part) in parts {
            paths.push(self.node(part)?.0);
        }
        let shares = parts.iter().map(|(share, _)| (*share).into());
        let container = ContainerBlueprint::new(kind)
            .with_contents(paths.iter().map(|p| IncludedContent(p.as_str().into())));
        let container = match (kind, paths.first()) {
            (ContainerKind::Horizontal, _) => container.with_col_shares(shares.map(ColumnShare)),
            (ContainerKind::Vertical, _) => container.with_row_shares(shares.map(RowShare)),
            (ContainerKind::Tabs, Some(first)) => container.with_active_tab(ActiveTab(first.as_str().into())),
            _ => container,
        };
        self.log(path, &container)
    }

    fn view(&mut self, path: &str, view: &Pane) -> Result<()> {
        let contents = ViewContents::new(view.contents.iter().map(|q| QueryExpression(q.as_str().into())));
        self.log(&format!("{path}/ViewContents"), &contents)?;
        let blueprint = ViewBlueprint::new(view.class)
            .with_display_name(view.title.as_str())
            .with_space_origin(view.origin.as_str());
        self.log(path, &blueprint)?;
        for (name, property) in &view.properties {
            self.log(&format!("{path}/{name}"), property.as_ref())?;
        }
        Ok(())
    }
}
