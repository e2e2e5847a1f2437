//! Expansion moves: of all active assignments, any may be given up, and any of one disparity may become
//! active. The best of these moves is a minimum cut (Kolmogorov and Zabih 2001, section 4).

use super::energy::{Energy, OCCLUDED};
use super::max_flow::MaxFlow;

/// More than all that could flow through a node.
const FORBIDDEN: i32 = 1 << 28;
const NO_NODE: u32 = u32::MAX;

/// Which assignments are active: the label of every left pixel, and of the right one that it is assigned to.
#[derive(Debug, Clone)]
pub(super) struct Labels {
    pub left: Vec<u16>,
    right: Vec<u16>,
}

impl Labels {
    /// Nothing is active.
    pub fn occluded(pixels: usize) -> Self {
        Self { left: vec![OCCLUDED; pixels], right: vec![OCCLUDED; pixels] }
    }

    fn set(&mut self, i: usize, shift: usize, label: u16) {
        (self.left[i], self.right[i - shift]) = (label, label);
    }

    fn copy_from(&mut self, other: &Self) {
        self.left.copy_from_slice(&other.left);
        self.right.copy_from_slice(&other.right);
    }
}

/// The assignments that a move may change, and the graph of the move. An active assignment of another
/// disparity stays active on the source's side; one of the move's disparity becomes active on the sink's.
///
/// Labellings that a best move has led to gain nothing by giving assignments up alone. So of the active ones,
/// only those need be looked at that a candidate touches, directly or through neighbours.
#[derive(Debug)]
pub(super) struct Expansion {
    flow: MaxFlow,
    /// Of the assignments at the move's disparity: cost of an active one, given that dropped neighbours are
    /// not active, and the sum of the penalties towards those that are not dropped.
    costs: Vec<i32>,
    slack: Vec<i32>,
    /// Nodes of assignments of the move's disparity, and of active ones of others, by left pixel.
    new_nodes: Vec<u32>,
    old_nodes: Vec<u32>,
    /// Left pixels that have such nodes.
    candidates: Vec<u32>,
    touched: Vec<u32>,
    dropped: Vec<u32>,
    moved: Labels,
}

impl Expansion {
    pub fn new(pixels: usize) -> Self {
        Self {
            flow: MaxFlow::default(),
            costs: vec![0; pixels],
            slack: vec![0; pixels],
            new_nodes: vec![NO_NODE; pixels],
            old_nodes: vec![NO_NODE; pixels],
            candidates: Vec::new(),
            touched: Vec::new(),
            dropped: Vec::new(),
            moved: Labels::occluded(pixels),
        }
    }

    /// Makes the best expansion of `label`, if it lowers the energy. Returns the energy.
    pub fn run(&mut self, energy: &Energy, labels: &mut Labels, before: i64, label: u16) -> i64 {
        let shift = energy.shift(label);
        self.flow.graph.clear();
        self.find_candidates(energy, shift);
        if self.candidates.is_empty() {
            return before;
        }
        self.add_touched(energy, labels, label);
        self.add_smoothness(energy, labels, shift);
        self.add_uniqueness(energy, labels, label);
        self.flow.run();
        if !self.cut_changes(labels, label) {
            return before;
        }
        self.follow_cut(energy, labels, label);
        let after = energy.of(&self.moved.left);
        if after >= before {
            return before;
        }
        labels.copy_from(&self.moved);
        after
    }

    /// Drops the assignments that cannot gain anything, whatever their neighbours do: those whose cost is at
    /// least the penalties that being active could spare. The others get nodes.
    fn find_candidates(&mut self, energy: &Energy, shift: usize) {
        self.dropped.clear();
        self.candidates.clear();
        for i in 0..self.costs.len() {
            self.new_nodes[i] = NO_NODE;
            self.slack[i] = i32::MIN;
            if !energy.exists(i, shift) {
                continue;
            }
            let mut slack = 0;
            energy.for_neighbours(i, shift, |_, penalty| slack += penalty);
            self.costs[i] = energy.active_cost(i, shift);
            if self.costs[i] >= slack {
                self.dropped.push(i as u32);
            } else {
                self.slack[i] = slack;
            }
        }
        while let Some(i) = self.dropped.pop() {
            energy.for_neighbours(i as usize, shift, |j, penalty| {
                if self.slack[j] != i32::MIN {
                    self.costs[j] += penalty;
                    self.slack[j] -= penalty;
                    if self.costs[j] >= self.slack[j] {
                        self.slack[j] = i32::MIN;
                        self.dropped.push(j as u32);
                    }
                }
            });
        }
        for i in 0..self.costs.len() {
            if self.slack[i] != i32::MIN {
                self.new_nodes[i] = self.flow.graph.add_node(self.costs[i]);
                self.candidates.push(i as u32);
            }
        }
    }

    /// The left pixels whose active assignment shares a pixel with assignment (i, label): its own and that of
    /// its right one.
    fn rivals(energy: &Energy, labels: &Labels, i: usize, label: u16) -> [Option<usize>; 2] {
        let right = i - energy.shift(label);
        let other = |active: u16| active != OCCLUDED && active != label;
        [
            other(labels.left[i]).then_some(i),
            other(labels.right[right]).then(|| right + energy.shift(labels.right[right])),
        ]
    }

    /// Gives nodes to the active assignments of other disparities that candidates share a pixel with, and to
    /// those of the same disparity beside them.
    fn add_touched(&mut self, energy: &Energy, labels: &Labels, label: u16) {
        self.old_nodes.fill(NO_NODE);
        self.touched.clear();
        let mut touch = |i: usize, touched: &mut Vec<u32>| {
            if self.old_nodes[i] == NO_NODE {
                self.old_nodes[i] = 0;
                touched.push(i as u32);
            }
        };
        for &i in &self.candidates {
            let rivals = Self::rivals(energy, labels, i as usize, label);
            rivals.into_iter().flatten().for_each(|rival| touch(rival, &mut self.touched));
        }
        let mut next = 0;
        while let Some(&i) = self.touched.get(next) {
            let (i, own) = (i as usize, labels.left[i as usize]);
            let shift = energy.shift(own);
            let mut cost = energy.active_cost(i, shift);
            energy.for_neighbours(i, shift, |j, penalty| {
                if labels.left[j] == own {
                    touch(j, &mut self.touched);
                } else {
                    cost += penalty;
                }
            });
            self.slack[i] = cost;
            next += 1;
        }
        for &i in &self.touched {
            self.old_nodes[i as usize] = self.flow.graph.add_node(-self.slack[i as usize]);
        }
    }

    fn add_smoothness(&mut self, energy: &Energy, labels: &Labels, shift: usize) {
        for &i in &self.candidates {
            let node = self.new_nodes[i as usize];
            energy.for_neighbours(i as usize, shift, |j, penalty| {
                let other = self.new_nodes[j];
                if j > i as usize && other != NO_NODE {
                    self.flow.graph.add_arcs(node, other, penalty, penalty);
                }
            });
        }
        for &i in &self.touched {
            let (node, own) = (self.old_nodes[i as usize], labels.left[i as usize]);
            energy.for_neighbours(i as usize, energy.shift(own), |j, penalty| {
                if j > i as usize && labels.left[j] == own {
                    self.flow.graph.add_arcs(node, self.old_nodes[j], penalty, penalty);
                }
            });
        }
    }

    /// An assignment of another disparity that stays active forbids those that share a pixel with it.
    fn add_uniqueness(&mut self, energy: &Energy, labels: &Labels, label: u16) {
        for &i in &self.candidates {
            for rival in Self::rivals(energy, labels, i as usize, label).into_iter().flatten() {
                let (old, new) = (self.old_nodes[rival], self.new_nodes[i as usize]);
                self.flow.graph.add_arcs(old, new, FORBIDDEN, 0);
            }
        }
    }

    fn becomes_active(&self, i: usize) -> bool {
        self.new_nodes[i] != NO_NODE && self.flow.is_on_sink_side(self.new_nodes[i])
    }

    fn cut_changes(&self, labels: &Labels, label: u16) -> bool {
        let given_up = |&i: &u32| self.flow.is_on_sink_side(self.old_nodes[i as usize]);
        let changes = |(i, &own): (usize, &u16)| (own == label) != self.becomes_active(i);
        self.touched.iter().any(given_up) || labels.left.iter().enumerate().any(changes)
    }

    /// The labelling that the cut stands for.
    fn follow_cut(&mut self, energy: &Energy, labels: &Labels, label: u16) {
        self.moved.copy_from(labels);
        let shift = energy.shift(label);
        for i in 0..labels.left.len() {
            if labels.left[i] == label && !self.becomes_active(i) {
                self.moved.set(i, shift, OCCLUDED);
            }
        }
        for &i in &self.touched {
            if self.flow.is_on_sink_side(self.old_nodes[i as usize]) {
                let own = labels.left[i as usize];
                self.moved.set(i as usize, energy.shift(own), OCCLUDED);
            }
        }
        for &i in &self.candidates {
            if self.becomes_active(i as usize) {
                self.moved.set(i as usize, shift, label);
            }
        }
    }
}
