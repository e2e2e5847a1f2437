use super::*;
use crate::World;

const BOX: &str = include_str!("../tests/box.toml");
const ROBOT: &str = "\n[robot]\nheight_m = 1.2\n";
const CASE: &str = "\n[[hazard]]\nname = \"case\"\nkind = \"drop-off\"\nx_m = [1.0, 3.0]\ny_m = [0.0, 0.5]\n\
    yaw_deg = 0.0\n\n[[safe_area]]\nname = \"floor\"\nx_m = [1, 2]\ny_m = [1, 2]\n";

#[test]
fn areas_are_read_in_the_order_of_the_text_hazards_first() {
    let world = World::from_toml(&[BOX, ROBOT, CASE].concat()).unwrap();
    let areas: Vec<_> = world.areas.iter().map(|area| (area.name.as_str(), area.kind)).collect();
    assert_eq!(areas, [("case", HazardKind::DropOff), ("floor", HazardKind::SafeArea)]);
    assert!(World::from_toml(BOX).unwrap().areas.is_empty());
}

#[test]
fn an_area_ends_at_its_border_however_it_is_turned() {
    let area = |yaw_deg| Area::new(Extent([1.0, 3.0]), Extent([0.0, 0.5]), Finite(yaw_deg));
    for (yaw_deg, inside, outside) in [
        (0.0, [[1.0, 0.0], [3.0, 0.5], [2.0, 0.25]], [[0.99, 0.2], [3.01, 0.2], [2.0, 0.51]]),
        // Two metres long along y, half a metre wide along x.
        (90.0, [[2.24, 1.24], [1.76, -0.74], [2.0, 0.25]], [[2.26, 0.2], [1.0, 0.25], [2.0, 1.26]]),
        // Its front left corner is at 1.03 m and 45 + 14.04 degrees of the centre.
        (45.0, [[2.52, 1.12], [1.48, -0.62], [2.0, 0.25]], [[2.55, 1.15], [3.0, 0.25], [2.0, 0.7]]),
    ] {
        for place in inside {
            assert!(area(yaw_deg).contains(place), "{yaw_deg}: {place:?}");
        }
        for place in outside {
            assert!(!area(yaw_deg).contains(place), "{yaw_deg}: {place:?}");
        }
    }
}

/// Texts of the areas, what to put in their place, and parts of the message that follows.
const DAMAGES: &[(&str, &str, &[&str])] = &[
    ("drop-off", "dropoff", &["`kind = \"dropoff\"`", "unknown variant `dropoff`", "mean `drop-off`"]),
    ("drop-off", "safe-area", &["`kind = \"safe-area\"`", "unknown variant `safe-area`"]),
    ("kind = \"drop-off\"\n", "", &["[[hazard]]", "missing field `kind`"]),
    ("[1.0, 3.0]", "[3.0, 1.0]", &["`x_m = [3.0, 1.0]`", "from < to, found [3, 1]"]),
    ("[1.0, 3.0]", "[1.0, 1.0]", &["`x_m = [1.0, 1.0]`", "from < to, found [1, 1]"]),
    ("[0.0, 0.5]", "[0.0]", &["`y_m = [0.0]`"]),
    ("[0.0, 0.5]", "[0.0, nan]", &["`y_m = [0.0, nan]`", "found NaN"]),
    ("[1, 2]", "[1, inf]", &["`x_m = [1, inf]`", "found inf"]),
    ("yaw_deg = 0.0", "yaw_deg = inf", &["`yaw_deg = inf`", "found inf"]),
    ("\"floor\"", "\"case\"", &["`name = \"case\"`", "a name of its own", "found `case` twice"]),
    ("\"floor\"", "\"the floor\"", &["`name = \"the floor\"`", "letters, digits"]),
    ("kind", "sort", &["unknown field `sort`"]),
    ("[[safe_area]]", "[[safe_areas]]", &["unknown field `safe_areas`", "mean `safe_area`"]),
];

#[test]
fn bad_areas_are_refused_with_one_line_that_names_the_key() {
    for (old, new, parts) in DAMAGES {
        let areas = CASE.replacen(old, new, 1);
        assert_ne!(areas, CASE, "{old}");
        let message = World::from_toml(&[BOX, ROBOT, &areas].concat()).unwrap_err().to_string();
        assert!(!message.contains('\n'), "{message}");
        for part in *parts {
            assert!(message.contains(part), "{new}: {message}, expected {part}");
        }
    }
}

#[test]
fn areas_need_a_robot() {
    let message = |areas: &str| World::from_toml(&[BOX, areas].concat()).unwrap_err().to_string();
    let found = message(CASE);
    assert!(found.contains("`[[hazard]]`: hazard: expected a section [robot]"), "{found}");
    let found = message(CASE.split_once("0.0\n\n").unwrap().1);
    assert!(found.contains("`[[safe_area]]`: safe_area: expected a section [robot]"), "{found}");
}

#[test]
fn every_kind_has_the_name_that_worlds_give_it() {
    for kind in HazardKind::ALL {
        let text = [BOX, ROBOT, &CASE.replacen("drop-off", kind.name(), 1)].concat();
        match World::from_toml(&text) {
            Ok(world) => assert_eq!(world.areas[0].kind, kind),
            Err(error) => assert!(kind.is_safe(), "{error}"),
        }
    }
}
