//! The directions of dependency that docs/ARCHITECTURE.md promises, read from `cargo metadata`.
#![allow(clippy::unwrap_used, missing_docs)]

use std::collections::{BTreeMap, BTreeSet};
use std::process::Command;

type Graph = BTreeMap<String, BTreeSet<String>>;

/// Normal dependencies of every package of the workspace.
fn dependencies() -> Graph {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--format-version", "1", "--no-deps", "--offline"])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let metadata: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let name = |v: &serde_json::Value| v["name"].as_str().unwrap().to_owned();
    let packages = metadata["packages"].as_array().unwrap();
    packages
        .iter()
        .map(|package| {
            let all = package["dependencies"].as_array().unwrap();
            (name(package), all.iter().filter(|d| d["kind"].is_null()).map(name).collect())
        })
        .collect()
}

/// Everything of the workspace that a package sees.
fn reachable(graph: &Graph, from: &str) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from.to_owned()];
    while let Some(package) = open.pop() {
        for dependency in graph.get(&package).into_iter().flatten() {
            if seen.insert(dependency.clone()) {
                open.push(dependency.clone());
            }
        }
    }
    seen.into_iter().filter(|package| graph.contains_key(package)).collect()
}

/// The crates of methods: those of the workspace that the list of methods names, and that are no base of
/// theirs.
fn mapping_crates(graph: &Graph) -> Vec<&String> {
    let named = &graph["evigrid-methods"];
    let is_base = |package: &String| ["evigrid-core", "evigrid-grid"].contains(&package.as_str());
    named.iter().filter(|package| graph.contains_key(*package) && !is_base(package)).collect()
}

#[test]
fn no_method_can_read_the_answer() {
    let graph = dependencies();
    let mapping = mapping_crates(&graph);
    assert!(mapping.len() > 1, "{mapping:?}");
    for package in mapping {
        let expected = BTreeSet::from(["evigrid-core", "evigrid-grid"].map(str::to_owned));
        assert_eq!(reachable(&graph, package), expected, "{package}");
    }
}

#[test]
fn the_list_of_methods_needs_neither_recordings_nor_truth() {
    let graph = dependencies();
    let mut allowed: BTreeSet<String> = mapping_crates(&graph).into_iter().cloned().collect();
    allowed.extend(["evigrid-core", "evigrid-grid"].map(str::to_owned));
    assert_eq!(reachable(&graph, "evigrid-methods"), allowed);
}

#[test]
fn only_the_list_of_methods_and_the_figures_name_single_methods() {
    let graph = dependencies();
    for package in mapping_crates(&graph) {
        for (naming, _) in graph.iter().filter(|(_, dependencies)| dependencies.contains(package)) {
            let is_list = ["evigrid-methods", "evigrid-reproduce"].contains(&naming.as_str());
            assert!(is_list, "{naming} names {package}");
        }
    }
}

#[test]
fn only_one_crate_names_rerun() {
    let naming: Vec<_> = dependencies()
        .into_iter()
        .filter(|(_, d)| d.iter().any(|d| d.starts_with("rerun")))
        .map(|(p, _)| p)
        .collect();
    assert_eq!(naming, ["evigrid-record"]);
}

#[test]
fn every_package_is_as_low_as_promised() {
    let graph = dependencies();
    let below = |package: &str| -> Vec<String> { reachable(&graph, package).into_iter().collect() };
    assert!(below("evigrid-core").is_empty());
    for low in ["evigrid-stereo", "evigrid-grid", "evigrid-replay"] {
        assert_eq!(below(low), ["evigrid-core"], "{low}");
    }
    for low in ["evigrid-metrics", "evigrid-truth"] {
        assert_eq!(below(low), ["evigrid-core", "evigrid-grid"], "{low}");
    }
    assert_eq!(below("evigrid-results"), ["evigrid-core", "evigrid-grid", "evigrid-metrics"]);
    for blind in ["evigrid-methods", "evigrid-stereo", "evigrid-truth", "evigrid-eval"] {
        assert!(!below("evigrid-synth").contains(&blind.to_owned()), "evigrid-synth sees {blind}");
    }
    let (record, reproduce) = (below("evigrid-record"), below("evigrid-reproduce"));
    assert!(!record.contains(&"evigrid-reproduce".to_owned()));
    assert!(!reproduce.contains(&"evigrid-record".to_owned()));
}
