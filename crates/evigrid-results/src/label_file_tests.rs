use std::fs;
use std::path::PathBuf;

use proptest::prelude::*;

use super::*;
use crate::npz::NpzWriter;
use crate::{PendingFile, write_safety};

fn map() -> SafetyMap {
    let mut map = SafetyMap::unknown(PlanSpec::of_area([0.3, 0.5], [-0.1, 0.2], 0.1).unwrap());
    let plane = map.add_plane(SafetyPlane { normal: Vector3::z(), offset_m: -1.0 });
    for (flat, label) in SafetyLabel::ALL.into_iter().enumerate() {
        map.set(flat, label, label.is_safe().filter(|safe| *safe).map(|_| plane));
    }
    map
}

#[test]
fn written_labels_read_back_the_same() {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("safety.x.npz");
    write_safety(PendingFile::create(path.clone()).unwrap(), &map()).unwrap().publish().unwrap();
    let back = read_labels(&path).unwrap();
    assert_eq!(
        (back.labels(), back.planes(), back.plane_numbers()),
        (map().labels(), map().planes(), map().plane_numbers())
    );
    assert!(is_label_file(&path) && !is_label_file(dir.path()));
    check_same_cells((&back, &path), (&map(), &path)).unwrap();
}

#[test]
fn maps_of_other_cells_are_refused_and_both_named() {
    let (found, truth) = (PathBuf::from("found.npz"), PathBuf::from("truth.png"));
    let other = [
        ([0.3, 0.7], [-0.1, 0.5], 0.2, "2 x 3 cells of 0.2 m"),
        ([0.35, 0.55], [-0.1, 0.2], 0.1, "from [0.35, -0.1]"),
        ([0.3, 0.6], [-0.1, 0.2], 0.1, "3 x 3 cells"),
    ];
    for (x, y, cell, part) in other {
        let map_found = SafetyMap::unknown(PlanSpec::of_area(x, y, cell).unwrap());
        let error = check_same_cells((&map_found, &found), (&map(), &truth)).unwrap_err().to_string();
        for expected in [part, "found.npz", "2 x 3 cells of 0.1 m from [0.3, -0.1] (truth.png)"] {
            assert!(error.contains(expected), "{error}");
        }
    }
}

const TABLE: &str = "origin_m = [0.3, -0.1]\ncell_size_m = 0.1\ncells = [2, 3]\n[labels]\nlevel = 255\n\
                     inclined = 200\nnon_ground = 0\nunknown = 128\nunexamined = 128\n";

fn picture(pixels: [u8; 6], table: &str) -> Result<SafetyMap> {
    let dir = tempfile::tempdir().unwrap();
    let path = dir.path().join("safety_map.png");
    image::GrayImage::from_vec(3, 2, pixels.to_vec()).unwrap().save(&path).unwrap();
    fs::write(path.with_extension("toml"), table).unwrap();
    read_labels(&path)
}

#[test]
fn a_picture_is_seen_from_above_forward_up() {
    use SafetyLabel::{Inclined, Level, NonGround, Unknown};
    let map = picture([255, 128, 0, 0, 0, 200], TABLE).unwrap();
    // Its last pixel is the cell (0, 0): the lowest x, and the lowest y, which is to the right.
    assert_eq!(map.labels(), [Inclined, NonGround, NonGround, NonGround, Unknown, Level]);
    assert!((map.spec().centre_m(0)[0] - 0.35).abs() < 1e-9);
}

#[test]
fn what_is_no_label_is_refused() {
    let message = |result: Result<SafetyMap>| format!("{:#}", result.unwrap_err());
    let error = message(picture([255, 128, 0, 0, 77, 200], TABLE));
    assert!(error.contains("found 77 in row 1, column 1"), "{error}");
    let error = message(picture([0; 6], &TABLE.replace("[2, 3]", "[3, 2]")));
    assert!(error.contains("expected 2 x 3 pixels"), "{error}");
    let error = message(picture([0; 6], &TABLE.replace("cell_size_m = 0.1", "cell_size_m = -1.0")));
    assert!(error.contains("positive cell size"), "{error}");
    let error = message(picture([0; 6], "cells = 4"));
    assert!(error.contains("safety_map.toml"), "{error}");
    assert!(message(read_labels(&PathBuf::from("none.npz"))).contains("none.npz"));
    for (labels, expected) in [([0_u8, 9], "found 9 at position 1"), ([0, 1], "")] {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("x.npz");
        let mut npz = NpzWriter::default();
        npz.array("labels", &[1, 2], &labels).unwrap();
        npz.array("origin", &[2], &[0.0, 0.0]).unwrap();
        npz.array("cell_size", &[], &[0.1]).unwrap();
        fs::write(&path, npz.finish().unwrap()).unwrap();
        match read_labels(&path) {
            Ok(map) => assert_eq!((map.labels().len(), expected), (2, "")),
            Err(error) => assert!(format!("{error:#}").contains(expected), "{error:#}"),
        }
    }
}

proptest! {
    #[test]
    fn damaged_files_never_panic(at in 0..4000_usize, value: u8) {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("safety.x.npz");
        write_safety(PendingFile::create(path.clone()).unwrap(), &map()).unwrap().publish().unwrap();
        let mut bytes = fs::read(&path).unwrap();
        let at = at % bytes.len();
        bytes[at] = value;
        fs::write(&path, &bytes).unwrap();
        let _ = read_labels(&path);
        fs::write(&path, &bytes[..at]).unwrap();
        let _ = read_labels(&path);
    }
}
