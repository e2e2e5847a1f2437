//! How the views of a recording are arranged in the window.

use rerun::blueprint::components::{BackgroundKind, VisualBounds2D as Bounds};
use rerun::datatypes::Range2D;
use rerun::external::re_sdk_types::blueprint::archetypes::{Background, VisualBounds2D};

use crate::blueprint::{Node, Pane};
use crate::part::Slot;

/// The whole window: maps and text on the left, images and scores on the right. Places without a view are
/// left out.
pub(crate) fn window(panes: Vec<(Slot, Pane)>) -> Node {
    let mut panes: Vec<_> = panes.into_iter().map(Some).collect();
    let mut of = |wanted: Slot| -> Vec<Node> {
        let taken = panes.iter_mut().filter_map(|pane| pane.take_if(|(slot, _)| *slot == wanted));
        taken.map(|(_, pane)| Node::View(pane)).collect()
    };
    let left = [(0.56, of(Slot::Space)), (0.145, of(Slot::Above)), (0.295, of(Slot::Text))];
    let images = of(Slot::Image).into_iter().map(|image| (0.17, vec![image]));
    let right: Vec<_> = images.chain([(0.33, of(Slot::Scores)), (0.33, of(Slot::Curve))]).collect();
    Node::columns(vec![(0.63, rows(left)), (0.37, rows(right))])
}

/// Places one below the other, each with its views as tabs.
fn rows(places: impl IntoIterator<Item = (f32, Vec<Node>)>) -> Node {
    let filled = places.into_iter().filter(|(_, nodes)| !nodes.is_empty());
    Node::rows(filled.map(|(share, nodes)| (share, Node::tabs(nodes))).collect())
}

/// The part of a 2-D view that is seen.
pub(crate) fn bounds(x_range: [f64; 2], y_range: [f64; 2]) -> VisualBounds2D {
    let range = Range2D { x_range: x_range.into(), y_range: y_range.into() };
    VisualBounds2D::new(Bounds::from(range))
}

/// A background on which colours stand out.
pub(crate) fn dark() -> Background {
    Background::new(BackgroundKind::SolidColor).with_color(rerun::Color::from_rgb(14, 15, 18))
}
