//! docs/synthetic.md explains every key.

use crate::description::WorldSpec;

const DOCS: &str = include_str!("../../../docs/synthetic.md");
const YARD: &str = include_str!("../tests/yard.toml");

/// The keys of the table into which an unknown one has been put, as the parser lists them.
fn keys(text: &str) -> Vec<String> {
    let message = toml::from_str::<WorldSpec>(text).unwrap_err().message().to_owned();
    assert!(message.contains("zzz"), "{message}");
    // "unknown field `zzz`, expected one of `a`, `b`" or "unexpected keys in
    // table: zzz, available keys: a, b".
    let list = message.split_once("expected ").map_or("", |(_, list)| list);
    let quoted = list.split('`').skip(1).step_by(2);
    let plain = message.split_once("available keys: ").map_or("", |(_, list)| list).split(", ");
    let keys: Vec<String> = quoted.chain(plain).filter(|key| !key.is_empty()).map(str::to_owned).collect();
    assert!(!keys.is_empty(), "{message}");
    keys
}

/// Whether a key stands in the documentation, as code or as a heading.
fn is_documented(key: &str) -> bool {
    let whole = |mark: &str| DOCS.contains(&format!("{mark}`")) || DOCS.contains(&format!("{mark}]"));
    [format!("`{key}"), format!(".{key}"), format!("[{key}"), format!("[[{key}]")]
        .iter()
        .any(|m| whole(m) || DOCS.contains(&format!("{m}.")))
}

#[test]
fn every_key_is_documented() {
    let model = "[model.m]\npart = [{ zzz = 1 }]\n[light]";
    let in_object = |what: &str| format!("material = \"soil\"\n{what}\n");
    let in_pattern = |what: &str| format!("octaves = 8\npattern = {{ {what} }}");
    let rows: Vec<(&str, String)> = vec![
        ("name = ", "zzz = 1\nname = ".to_owned()),
        ("[trajectory]", "[trajectory]\nzzz = 1".to_owned()),
        ("{ at_m", "{ zzz = 1, at_m".to_owned()),
        ("[reported_pose]", "[reported_pose]\nzzz = 1".to_owned()),
        ("[stereo]", "[stereo]\nzzz = 1".to_owned()),
        ("{ read_grey", "{ zzz = 1, read_grey".to_owned()),
        ("[[laser]]", "[[laser]]\nzzz = 1".to_owned()),
        ("[robot]", "[robot]\nzzz = 1".to_owned()),
        ("[truth_grid]", "[truth_grid]\nzzz = 1".to_owned()),
        ("[light]", "[light]\nzzz = 1".to_owned()),
        ("[light]", model.to_owned()),
        ("[light]", "[[hazard]]\nzzz = 1\n[light]".to_owned()),
        ("[light]", "[[hazard]]\nkind = \"zzz\"\n[light]".to_owned()),
        ("[light]", "[[safe_area]]\nzzz = 1\n[light]".to_owned()),
        ("[material.soil]", "[material.soil]\nzzz = 1".to_owned()),
        ("octaves = 8", in_pattern("zzz = 1")),
        ("octaves = 8", in_pattern("stripes = { zzz = 1 }")),
        ("octaves = 8", in_pattern("checks = { zzz = 1 }")),
        ("octaves = 8", in_pattern("brick = { zzz = 1 }")),
        ("octaves = 8", in_pattern("grass = { zzz = 1 }")),
        ("octaves = 8", in_pattern("road = { zzz = 1 }")),
        ("octaves = 8", in_pattern("road = { crosswalks = [{ zzz = 1 }] }")),
        ("octaves = 8", in_pattern("road = { stop_lines = [{ zzz = 1 }] }")),
        ("[[object]]", "[[object]]\nzzz = 1".to_owned()),
        ("material = \"soil\"\n", in_object("repeat = { zzz = 1 }")),
        ("material = \"soil\"\n", in_object("motion = { zzz = 1 }")),
        ("box = {", "zzz = {".to_owned()),
        ("box = {", "box = { zzz = 1,".to_owned()),
        ("box = {", "cylinder = { zzz = 1,".to_owned()),
        ("box = {", "sphere = { zzz = 1,".to_owned()),
        ("box = {", "ramp = { zzz = 1,".to_owned()),
        ("box = {", "height_field = { zzz = 1,".to_owned()),
        ("box = {", "rough_ground = { zzz = 1,".to_owned()),
        ("box = {", "mesh = { zzz = 1,".to_owned()),
        ("box = {", "mesh_file = { zzz = 1,".to_owned()),
    ];
    for (old, new) in rows {
        let text = YARD.replacen(old, &new, 1);
        assert_ne!(text, YARD, "{old}");
        for key in keys(&text) {
            assert!(is_documented(&key), "{new}: `{key}` is not in docs/synthetic.md");
        }
    }
}
