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
            ours.graph.add_node(e);
            let node = theirs.add_node(());
            let ends = if e > 0 { (source, node) } else { (node, sink) };
            theirs.add_edge(ends.0, ends.1, e.unsigned_abs());
        }
        for &(a, b, forward, backward) in &arcs {
            ours.graph.add_arcs(a as u32, b as u32, forward, backward);
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
            flow.graph.clear();
            excess.iter().for_each(|&e| { flow.graph.add_node(e); });
            for &(a, b, forward, backward) in arcs.iter().filter(|(a, b, ..)| a != b) {
                flow.graph.add_arcs(a as u32, b as u32, forward, backward);
            }
            flow.run()
        };
        let mut used = MaxFlow::default();
        prop_assert_eq!(build(&mut used), build(&mut used));
    }
}
