//! Minimum cuts by augmenting paths along two search trees that are kept from path to path: Y. Boykov, V. Kolmogorov, "An
//! experimental comparison of min-cut/max-flow algorithms for energy minimization in vision", PAMI 26(9), 2004.

use std::collections::VecDeque;

/// Instead of an arc: a node that is in no tree, hangs directly on its terminal, or has lost its parent.
const FREE: u32 = u32::MAX;
const TERMINAL: u32 = u32::MAX - 1;
const ORPHAN: u32 = u32::MAX - 2;
/// The end of a list of arcs.
const NONE: u32 = u32::MAX;

/// A directed graph with a source and a sink besides its numbered nodes. Arcs come in pairs: `a ^ 1` is `a` reversed.
#[derive(Debug, Default)]
pub(crate) struct MaxFlow {
    nodes: Vec<Node>,
    arcs: Vec<Arc>,
    /// Nodes at the edge of the trees, from which these grow.
    active: VecDeque<u32>,
    orphans: VecDeque<u32>,
    /// Number of augmentations so far: distances are valid if they carry it, a lower bound otherwise.
    time: u32,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    /// What can still flow in from the source, or (negative) out to the sink.
    excess: i32,
    first_arc: u32,
    /// Arc to the parent in the tree.
    parent: u32,
    in_sink_tree: bool,
    is_active: bool,
    /// Distance to the terminal, and when it was found.
    distance: u32,
    time: u32,
}

#[derive(Debug, Clone, Copy)]
struct Arc {
    head: u32,
    next: u32,
    residual: i32,
}

impl MaxFlow {
    /// An empty graph, in the memory of the one before.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.arcs.clear();
    }

    /// Adds a node. It costs `excess` to have it on the sink's side if that is positive, or `-excess` to have it on the
    /// source's.
    pub fn add_node(&mut self, excess: i32) -> u32 {
        let distance = 1;
        let node = Node {
            excess,
            first_arc: NONE,
            parent: FREE,
            in_sink_tree: false,
            is_active: false,
            distance,
            time: 0,
        };
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    /// Adds an arc of capacity `forward` and its reverse of capacity `backward`. It costs `forward` to have `from` on the
    /// source's side and `to` on the sink's, `backward` the other way round.
    pub fn add_arcs(&mut self, from: u32, to: u32, forward: i32, backward: i32) {
        for (tail, head, residual) in [(from, to, forward), (to, from, backward)] {
            let node = &mut self.nodes[tail as usize];
            let next = std::mem::replace(&mut node.first_arc, self.arcs.len() as u32);
            self.arcs.push(Arc { head, next, residual });
        }
    }

    /// Whether a node is on the sink's side of the minimum cut. Nodes that could be on either are on the source's.
    pub fn is_on_sink_side(&self, node: u32) -> bool {
        let node = &self.nodes[node as usize];
        node.in_sink_tree && node.parent != FREE
    }

    /// Finds a minimum cut. Returned is the flow over it.
    pub fn run(&mut self) -> i64 {
        self.begin();
        let mut flow = 0;
        while let Some(node) = self.active.front().copied() {
            let meeting = if self.node(node).parent == FREE { None } else { self.grow(node) };
            let Some(arc) = meeting else {
                self.active.pop_front();
                self.nodes[node as usize].is_active = false;
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
        for (i, node) in self.nodes.iter_mut().enumerate() {
            if node.excess != 0 {
                (node.parent, node.in_sink_tree, node.is_active) = (TERMINAL, node.excess < 0, true);
                self.active.push_back(i as u32);
            }
        }
    }

    fn node(&self, i: u32) -> &Node {
        &self.nodes[i as usize]
    }

    fn arc(&self, a: u32) -> &Arc {
        &self.arcs[a as usize]
    }

    /// What can flow along an arc away from the node's tree's root: forwards in the source's tree, backwards in the sink's.
    fn residual_outwards(&self, arc: u32, in_sink_tree: bool) -> i32 {
        self.arc(arc ^ u32::from(in_sink_tree)).residual
    }

    /// Lets the node's tree take free neighbours. Returned is an arc from the source's tree to the sink's, if one is found.
    fn grow(&mut self, i: u32) -> Option<u32> {
        let Node { in_sink_tree, distance, time, .. } = *self.node(i);
        let mut a = self.node(i).first_arc;
        while a != NONE {
            let Arc { head, next, .. } = *self.arc(a);
            if self.residual_outwards(a, in_sink_tree) > 0 {
                let other = &mut self.nodes[head as usize];
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
        let node = &mut self.nodes[i as usize];
        if !node.is_active {
            node.is_active = true;
            self.active.push_back(i);
        }
    }

    /// Lets as much flow as possible along the path through `arc`. Nodes whose way to the root is full become orphans.
    fn augment(&mut self, arc: u32) -> i32 {
        let mut flow = self.arc(arc).residual;
        for in_sink_tree in [false, true] {
            flow = flow.min(self.bottleneck(self.end(arc, in_sink_tree), in_sink_tree));
        }
        self.push(arc, flow);
        for in_sink_tree in [false, true] {
            let mut i = self.end(arc, in_sink_tree);
            while self.node(i).parent != TERMINAL {
                let parent = self.node(i).parent;
                let along = parent ^ u32::from(!in_sink_tree);
                self.push(along, flow);
                if self.arc(along).residual == 0 {
                    self.orphan(i);
                }
                i = self.arc(parent).head;
            }
            let root = &mut self.nodes[i as usize];
            root.excess += if in_sink_tree { flow } else { -flow };
            if root.excess == 0 {
                self.orphan(i);
            }
        }
        flow
    }

    /// The end of an arc between the trees that is in this one.
    fn end(&self, arc: u32, in_sink_tree: bool) -> u32 {
        self.arc(arc ^ u32::from(!in_sink_tree)).head
    }

    /// What can flow between a node and its terminal.
    fn bottleneck(&self, mut i: u32, in_sink_tree: bool) -> i32 {
        let mut least = i32::MAX;
        while self.node(i).parent != TERMINAL {
            let parent = self.node(i).parent;
            least = least.min(self.arc(parent ^ u32::from(!in_sink_tree)).residual);
            i = self.arc(parent).head;
        }
        least.min(self.node(i).excess.abs())
    }

    fn push(&mut self, arc: u32, flow: i32) {
        self.arcs[arc as usize].residual -= flow;
        self.arcs[arc as usize ^ 1].residual += flow;
    }

    fn orphan(&mut self, i: u32) {
        self.nodes[i as usize].parent = ORPHAN;
        self.orphans.push_back(i);
    }

    /// Finds an orphan a new parent in its tree, the one nearest to the terminal, or sets it free with all that hangs on it.
    fn adopt(&mut self, i: u32) {
        let in_sink_tree = self.node(i).in_sink_tree;
        let (mut nearest, mut least) = (FREE, u32::MAX);
        let mut a = self.node(i).first_arc;
        while a != NONE {
            let Arc { head, next, .. } = *self.arc(a);
            let other = self.node(head);
            if self.residual_outwards(a ^ 1, in_sink_tree) > 0
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
        let node = &mut self.nodes[i as usize];
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
            let node = self.node(i);
            if node.time == self.time {
                return Some(distance + node.distance);
            }
            distance += 1;
            match node.parent {
                TERMINAL => return Some(distance),
                ORPHAN | FREE => return None,
                parent => i = self.arc(parent).head,
            }
        }
    }

    /// Notes the distance of a node and of all on its way.
    fn remember_distance(&mut self, mut i: u32, mut distance: u32) {
        while self.node(i).time != self.time {
            let time = self.time;
            let node = &mut self.nodes[i as usize];
            (node.time, node.distance) = (time, distance);
            if node.parent == TERMINAL {
                break;
            }
            let parent = node.parent;
            i = self.arc(parent).head;
            distance -= 1;
        }
    }

    fn set_free(&mut self, i: u32) {
        let in_sink_tree = self.node(i).in_sink_tree;
        let mut a = self.node(i).first_arc;
        while a != NONE {
            let Arc { head, next, .. } = *self.arc(a);
            let other = *self.node(head);
            if other.in_sink_tree == in_sink_tree && other.parent != FREE {
                if self.residual_outwards(a ^ 1, in_sink_tree) > 0 {
                    self.activate(head);
                }
                if other.parent < ORPHAN && self.arc(other.parent).head == i {
                    self.orphan(head);
                }
            }
            a = next;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use petgraph::algo::ford_fulkerson;
    use petgraph::graph::{DiGraph, NodeIndex};
    use proptest::prelude::*;

    const MOST: i32 = 20;

    /// From, to, capacity forwards and backwards.
    type Arcs = Vec<(usize, usize, i32, i32)>;

    fn arcs(nodes: usize) -> impl Strategy<Value = Arcs> {
        proptest::collection::vec((0..nodes, 0..nodes, 0..MOST, 0..MOST), 0..4 * nodes)
    }

    fn graph() -> impl Strategy<Value = (Vec<i32>, Arcs)> {
        (1..12_usize).prop_flat_map(|n| (proptest::collection::vec(-MOST..MOST, n), arcs(n)))
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(2000))]

        #[test]
        fn flow_is_that_of_petgraph_and_the_cut_costs_as_much((excess, arcs) in graph()) {
            let arcs: Vec<_> = arcs.into_iter().filter(|(a, b, ..)| a != b).collect();
            let mut ours = MaxFlow::default();
            let mut theirs = DiGraph::<(), u32>::new();
            let (source, sink) = (theirs.add_node(()), theirs.add_node(()));
            for &e in &excess {
                ours.add_node(e);
                let node = theirs.add_node(());
                let ends = if e > 0 { (source, node) } else { (node, sink) };
                theirs.add_edge(ends.0, ends.1, e.unsigned_abs());
            }
            for &(a, b, forward, backward) in &arcs {
                ours.add_arcs(a as u32, b as u32, forward, backward);
                theirs.add_edge(NodeIndex::new(a + 2), NodeIndex::new(b + 2), forward.unsigned_abs());
                theirs.add_edge(NodeIndex::new(b + 2), NodeIndex::new(a + 2), backward.unsigned_abs());
            }
            let flow = ours.run();
            prop_assert_eq!(flow, i64::from(ford_fulkerson(&theirs, source, sink).0));
            let on_sink = |i: usize| ours.is_on_sink_side(i as u32);
            let ends = excess.iter().enumerate().map(|(i, &e)| match (e > 0, on_sink(i)) {
                (true, true) => e,
                (false, false) => -e,
                _ => 0,
            });
            let between = arcs.iter().map(|&(a, b, forward, backward)| match (on_sink(a), on_sink(b)) {
                (false, true) => forward,
                (true, false) => backward,
                _ => 0,
            });
            prop_assert_eq!(ends.chain(between).map(i64::from).sum::<i64>(), flow);
        }

        #[test]
        fn a_cleared_graph_is_as_good_as_new((excess, arcs) in graph()) {
            let build = |flow: &mut MaxFlow| {
                flow.clear();
                excess.iter().for_each(|&e| { flow.add_node(e); });
                for &(a, b, forward, backward) in arcs.iter().filter(|(a, b, ..)| a != b) {
                    flow.add_arcs(a as u32, b as u32, forward, backward);
                }
                flow.run()
            };
            let mut used = MaxFlow::default();
            prop_assert_eq!(build(&mut used), build(&mut used));
        }
    }
}
