#![allow(clippy::unwrap_used)]

use super::*;
use crate::fixtures;

#[test]
fn each_layout_is_recognised() {
    let raw = fixtures::kitti_raw(2);
    assert_eq!(open(&raw.dir).unwrap().info().layout, "kitti-raw");
    let odometry = fixtures::kitti_odometry(2);
    assert_eq!(open(&odometry.dir).unwrap().info().layout, "kitti-odometry");
    let pair = tempfile::tempdir().unwrap();
    for name in ["left.png", "right.png"] {
        fixtures::write_png(&pair.path().join(name), fixtures::gradient(4, 3));
    }
    assert_eq!(open(pair.path()).unwrap().info().layout, "middlebury");
}

#[test]
fn an_unknown_folder_is_told_what_each_layout_wants() {
    let dir = tempfile::tempdir().unwrap();
    let error = open(dir.path()).map(|_| ()).unwrap_err().to_string();
    assert!(error.starts_with("data set: expected one of "), "{error}");
    assert!(error.contains("kitti-raw (image_00, "), "{error}");
    assert!(error.contains("kitti-odometry (image_0") && error.contains("middlebury (left.png"), "{error}");
    assert!(error.ends_with(&format!("found none of them: {}", dir.path().display())), "{error}");
    assert!(!error.contains('\n'));
    let error = open(Path::new("/nowhere/at/all")).map(|_| ()).unwrap_err().to_string();
    assert!(error.starts_with("cannot read data set: ") && error.ends_with(": /nowhere/at/all"), "{error}");
}

#[test]
fn each_layout_has_a_name_of_its_own_in_kebab_case() {
    for (index, layout) in Layout::ALL.into_iter().enumerate() {
        let name = layout.name();
        assert!(name.split('-').all(|word| !word.is_empty() && word.bytes().all(|b| b.is_ascii_lowercase())));
        assert_eq!(Layout::ALL.iter().position(|other| *other == layout), Some(index), "{name}");
        assert_eq!((layout.to_string(), format!("{layout:?}")), (name.into(), format!("Layout({name:?})")));
    }
}

#[test]
fn layouts_are_read_by_name() {
    #[derive(Debug, Deserialize)]
    struct Data {
        layout: Layout,
    }
    for layout in Layout::ALL {
        let data: Data = toml::from_str(&format!("layout = \"{layout}\"")).unwrap();
        assert_eq!(data.layout, layout);
    }
    let error = toml::from_str::<Data>("layout = \"KittiRaw\"").unwrap_err();
    let known = Layout::ALL.map(Layout::name).join(", ");
    assert_eq!(error.message(), format!("unknown layout `KittiRaw`, expected one of {known}"));
    assert_eq!(error.span(), Some(9..19));
}
