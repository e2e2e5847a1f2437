//! The graph of a minimum cut, with the flow through it and the two search trees on it.

/// Stands for the arc to the parent of a node that is in no tree.
pub(super) const FREE: u32 = u32::MAX;
/// Stands for the arc to the parent of a node that hangs directly on its terminal.
pub(super) const TERMINAL: u32 = u32::MAX - 1;
/// Stands for the arc to the parent of a node that has lost it.
pub(super) const ORPHAN: u32 = u32::MAX - 2;
/// Stands for the next arc at the end of a list of arcs.
pub(super) const NONE: u32 = u32::MAX;

/// A directed graph with a source and a sink besides its numbered nodes. Arcs come in pairs: `a ^ 1` is `a`
/// reversed.
#[derive(Debug, Default)]
pub(super) struct FlowGraph {
    pub nodes: Vec<Node>,
    pub arcs: Vec<Arc>,
}

/// A node, and its place in the search trees.
#[derive(Debug, Clone, Copy)]
pub(super) struct Node {
    /// Flow that can still come in from the source, or (negative) go out to the sink.
    pub excess: i32,
    /// The first of the list of arcs that leave the node.
    pub first_arc: u32,
    /// Arc to the parent in the tree.
    pub parent: u32,
    pub in_sink_tree: bool,
    pub is_active: bool,
    /// Distance to the terminal, and when it was found.
    pub distance: u32,
    pub time: u32,
}

/// A directed arc.
#[derive(Debug, Clone, Copy)]
pub(super) struct Arc {
    /// The node that it leads to.
    pub head: u32,
    /// The next arc that leaves the node where it begins.
    pub next: u32,
    /// Flow that it can still take.
    pub residual: i32,
}

impl FlowGraph {
    /// Takes all nodes and arcs away, and keeps their memory.
    pub fn clear(&mut self) {
        self.nodes.clear();
        self.arcs.clear();
    }

    /// Adds a node. It costs `excess` to have it on the sink's side if that is positive, or `-excess` to have
    /// it on the source's.
    pub fn add_node(&mut self, excess: i32) -> u32 {
        let node = Node {
            excess,
            first_arc: NONE,
            parent: FREE,
            in_sink_tree: false,
            is_active: false,
            distance: 1,
            time: 0,
        };
        self.nodes.push(node);
        self.nodes.len() as u32 - 1
    }

    /// Adds an arc of capacity `forward` and its reverse of capacity `backward`. It costs `forward` to have
    /// `from` on the source's side and `to` on the sink's, `backward` the other way round.
    pub fn add_arcs(&mut self, from: u32, to: u32, forward: i32, backward: i32) {
        for (tail, head, residual) in [(from, to, forward), (to, from, backward)] {
            let node = &mut self.nodes[tail as usize];
            let next = std::mem::replace(&mut node.first_arc, self.arcs.len() as u32);
            self.arcs.push(Arc { head, next, residual });
        }
    }

    #[inline]
    pub fn node(&self, i: u32) -> &Node {
        &self.nodes[i as usize]
    }

    #[inline]
    pub fn arc(&self, a: u32) -> &Arc {
        &self.arcs[a as usize]
    }

    /// Flow that an arc can still take away from the root of a tree: forwards in the source's tree, backwards
    /// in the sink's.
    #[inline]
    pub fn residual_outwards(&self, arc: u32, in_sink_tree: bool) -> i32 {
        self.arc(arc ^ u32::from(in_sink_tree)).residual
    }

    /// The end, in one of the trees, of an arc between the two.
    #[inline]
    pub fn end(&self, arc: u32, in_sink_tree: bool) -> u32 {
        self.arc(arc ^ u32::from(!in_sink_tree)).head
    }

    /// Flow that can still pass between a node and its terminal.
    #[inline]
    pub fn bottleneck(&self, mut i: u32, in_sink_tree: bool) -> i32 {
        let mut least = i32::MAX;
        while self.node(i).parent != TERMINAL {
            let parent = self.node(i).parent;
            least = least.min(self.arc(parent ^ u32::from(!in_sink_tree)).residual);
            i = self.arc(parent).head;
        }
        least.min(self.node(i).excess.abs())
    }

    /// Lets flow along an arc.
    #[inline]
    pub fn push(&mut self, arc: u32, flow: i32) {
        self.arcs[arc as usize].residual -= flow;
        self.arcs[arc as usize ^ 1].residual += flow;
    }
}
