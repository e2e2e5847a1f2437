//! The directions of dependency that docs/ARCHITECTURE.md promises.
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
    seen
}

const MAPPING: [&str; 2] = ["evigrid-cost-curve", "evigrid-inverse-model"];

#[test]
fn no_method_can_read_the_answer() {
    let graph = dependencies();
    for mapping in MAPPING {
        let seen = reachable(&graph, mapping);
        assert!(seen.contains("evigrid-grid"), "{mapping} is in the graph");
        for answer in ["evigrid-truth", "evigrid-metrics", "evigrid-replay", "evigrid-synth", "evigrid-eval"]
        {
            assert!(!seen.contains(answer), "{mapping} reaches {answer}");
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
    let ours = |package: &str| -> Vec<String> {
        graph[package].iter().filter(|d| d.starts_with("evigrid")).cloned().collect()
    };
    assert!(ours("evigrid-core").is_empty());
    for low in ["evigrid-stereo", "evigrid-grid", "evigrid-replay"] {
        assert_eq!(ours(low), ["evigrid-core"], "{low}");
    }
    assert_eq!(ours("evigrid-metrics"), ["evigrid-core", "evigrid-grid"]);
    assert_eq!(ours("evigrid-truth"), ["evigrid-core", "evigrid-grid"]);
}
