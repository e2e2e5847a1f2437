//! Minimum cuts by augmenting paths along two search trees that are kept from path to path: Y. Boykov, V.
//! Kolmogorov, "An experimental comparison of min-cut/max-flow algorithms for energy minimization in vision",
//! PAMI 26(9), 2004.

use std::collections::VecDeque;

use super::flow_graph::{Arc, FREE, FlowGraph, NONE, Node, ORPHAN, TERMINAL};

/// The search for a minimum cut of a graph.
#[derive(Debug, Default)]
pub(super) struct MaxFlow {
    /// The graph that is cut.
    pub graph: FlowGraph,
    /// Nodes at the edge of the trees, from which these grow.
    active: VecDeque<u32>,
    orphans: VecDeque<u32>,
    /// Number of augmentations so far: distances are valid if they carry it, a lower bound otherwise.
    time: u32,
}

impl MaxFlow {
    /// Whether a node is on the sink's side of the minimum cut. Nodes that could be on either are on the
    /// source's.
    pub fn is_on_sink_side(&self, node: u32) -> bool {
        let node = &self.graph.nodes[node as usize];
        node.in_sink_tree && node.parent != FREE
    }

    /// Finds a minimum cut. Returns the flow over it.
    pub fn run(&mut self) -> i64 {
        self.begin();
        let mut flow = 0;
        while let Some(node) = self.active.front().copied() {
            let meeting = if self.graph.node(node).parent == FREE { None } else { self.grow(node) };
            let Some(arc) = meeting else {
                self.active.pop_front();
                self.graph.nodes[node as usize].is_active = false;
                continue;
            };
            self.time += 1;
            flow += i64::from(self.augment(arc));
            while let Some(orphan) = self.orphans.pop_front() {
                self.adopt(orphan);
            }
        }
        flow
    }

    fn begin(&mut self) {
        self.time = 0;
        self.active.clear();
        self.orphans.clear();
        for (i, node) in self.graph.nodes.iter_mut().enumerate() {
            if node.excess != 0 {
                (node.parent, node.in_sink_tree, node.is_active) = (TERMINAL, node.excess < 0, true);
                self.active.push_back(i as u32);
            }
        }
    }

    /// Lets the node's tree take free neighbours. Returns an arc from the source's tree to the sink's, if one
    /// is found.
    fn grow(&mut self, i: u32) -> Option<u32> {
        let Node { in_sink_tree, distance, time, .. } = *self.graph.node(i);
        let mut a = self.graph.node(i).first_arc;
        while a != NONE {
            let Arc { head, next, .. } = *self.graph.arc(a);
            if self.graph.residual_outwards(a, in_sink_tree) > 0 {
                let other = &mut self.graph.nodes[head as usize];
                if other.parent == FREE {
                    (other.parent, other.in_sink_tree) = (a ^ 1, in_sink_tree);
                    (other.distance, other.time) = (distance + 1, time);
                    self.activate(head);
                } else if other.in_sink_tree != in_sink_tree {
                    return Some(a ^ u32::from(in_sink_tree));
                } else if other.time <= time && other.distance > distance + 1 {
                    // A shorter way to the root.
                    (other.parent, other.distance, other.time) = (a ^ 1, distance + 1, time);
                }
            }
            a = next;
        }
        None
    }

    fn activate(&mut self, i: u32) {
        let node = &mut self.graph.nodes[i as usize];
        if !node.is_active {
            node.is_active = true;
            self.active.push_back(i);
        }
    }

    /// Lets as much flow as possible along the path through `arc`. Nodes whose way to the root is full become
    /// orphans.
    fn augment(&mut self, arc: u32) -> i32 {
        let mut flow = self.graph.arc(arc).residual;
        for in_sink_tree in [false, true] {
            flow = flow.min(self.graph.bottleneck(self.graph.end(arc, in_sink_tree), in_sink_tree));
        }
        self.graph.push(arc, flow);
        for in_sink_tree in [false, true] {
            let mut i = self.graph.end(arc, in_sink_tree);
            while self.graph.node(i).parent != TERMINAL {
                let parent = self.graph.node(i).parent;
                let along = parent ^ u32::from(!in_sink_tree);
                self.graph.push(along, flow);
                if self.graph.arc(along).residual == 0 {
                    self.orphan(i);
                }
                i = self.graph.arc(parent).head;
            }
            let root = &mut self.graph.nodes[i as usize];
            root.excess += if in_sink_tree { flow } else { -flow };
            if root.excess == 0 {
                self.orphan(i);
            }
        }
        flow
    }

    fn orphan(&mut self, i: u32) {
        self.graph.nodes[i as usize].parent = ORPHAN;
        self.orphans.push_back(i);
    }

    /// Finds an orphan a new parent in its tree, the one nearest to the terminal, or sets it free with all
    /// that hangs on it.
    fn adopt(&mut self, i: u32) {
        let in_sink_tree = self.graph.node(i).in_sink_tree;
        let (mut nearest, mut least) = (FREE, u32::MAX);
        let mut a = self.graph.node(i).first_arc;
        while a != NONE {
            let Arc { head, next, .. } = *self.graph.arc(a);
            let other = self.graph.node(head);
            if self.graph.residual_outwards(a ^ 1, in_sink_tree) > 0
                && other.in_sink_tree == in_sink_tree
                && other.parent != FREE
                && let Some(distance) = self.distance_to_terminal(head)
            {
                if distance < least {
                    (nearest, least) = (a, distance);
                }
                self.remember_distance(head, distance);
            }
            a = next;
        }
        let time = self.time;
        let node = &mut self.graph.nodes[i as usize];
        node.parent = nearest;
        if nearest == FREE {
            self.set_free(i);
        } else {
            (node.distance, node.time) = (least + 1, time);
        }
    }

    /// Arcs from a node to its terminal, that to the terminal included; `None` if its tree has been cut off.
    fn distance_to_terminal(&self, mut i: u32) -> Option<u32> {
        let mut distance = 0;
        loop {
            let node = self.graph.node(i);
            if node.time == self.time {
                return Some(distance + node.distance);
            }
            distance += 1;
            match node.parent {
                TERMINAL => return Some(distance),
                ORPHAN | FREE => return None,
                parent => i = self.graph.arc(parent).head,
            }
        }
    }

    /// Notes the distance of a node and of all on its way.
    fn remember_distance(&mut self, mut i: u32, mut distance: u32) {
        while self.graph.node(i).time != self.time {
            let time = self.time;
            let node = &mut self.graph.nodes[i as usize];
            (node.time, node.distance) = (time, distance);
            if node.parent == TERMINAL {
                break;
            }
            let parent = node.parent;
            i = self.graph.arc(parent).head;
            distance -= 1;
        }
    }

    fn set_free(&mut self, i: u32) {
        let in_sink_tree = self.graph.node(i).in_sink_tree;
        let mut a = self.graph.node(i).first_arc;
        while a != NONE {
            let Arc { head, next, .. } = *self.graph.arc(a);
            let other = *self.graph.node(head);
            if other.in_sink_tree == in_sink_tree && other.parent != FREE {
                if self.graph.residual_outwards(a ^ 1, in_sink_tree) > 0 {
                    self.activate(head);
                }
                if other.parent < ORPHAN && self.graph.arc(other.parent).head == i {
                    self.orphan(head);
                }
            }
            a = next;
        }
    }
}

#[cfg(test)]
#[path = "max_flow_tests.rs"]
mod tests;
