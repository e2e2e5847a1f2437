use nalgebra::Vector3;
use proptest::prelude::*;

use super::*;

const BOX: &str = include_str!("../tests/box.toml");

fn message(text: &str) -> String {
    World::from_toml(text).map(|_| "accepted".to_owned()).unwrap_or_else(|e| e.to_string())
}

#[test]
fn the_poses_follow_from_the_description() {
    let world = World::from_toml(BOX).unwrap();
    // 10 m/s at 10 Hz along x from (1, 0.5); the camera 0.2 m to the left and 1.5 m up.
    for frame in 0..3 {
        let pose = world.true_world_from_left(frame);
        let expected = Vector3::new(1.0 + frame as f64, 0.7, 1.5);
        assert!((pose.translation.vector - expected).norm() < 1e-6, "{frame}: {}", pose.translation);
        assert!((pose.rotation * Vector3::z() - Vector3::x()).norm() < 1e-9);
        assert!((pose.rotation * Vector3::x() + Vector3::y()).norm() < 1e-9);
        assert_eq!(world.stamp_ns(frame), 100_000_000 * frame as i64);
    }
}

#[test]
fn the_cameras_turn_tilt_and_roll() {
    let turned = BOX.replace("baseline_m", "yaw_deg = 90\ntilt_deg = 30\nroll_deg = 10\nbaseline_m");
    let pose = World::from_toml(&turned).unwrap().true_world_from_left(0);
    let (sin, cos) = 30_f64.to_radians().sin_cos();
    let forward = pose.rotation * Vector3::z();
    assert!((forward - Vector3::new(0.0, cos, -sin)).norm() < 1e-9, "{forward}");
    // The image's x axis points down to the right by the roll.
    let right = pose.rotation * Vector3::x();
    assert!((right.z + 10_f64.to_radians().sin() * cos).abs() < 1e-9, "{right}");
}

#[test]
fn the_mounting_is_that_of_the_camera_on_the_vehicle() {
    let mounting = |text: &str| World::from_toml(text).unwrap().mounting();
    let turned = BOX.replace("baseline_m", "yaw_deg = 90\ntilt_deg = 30\nroll_deg = 10\nbaseline_m");
    for (text, degrees) in [(BOX, 0_f64), (&turned, 30.0)] {
        let Mounting { height_m, pitch_rad, .. } = mounting(text).unwrap();
        assert_eq!(height_m, 1.5);
        assert!((pitch_rad - degrees.to_radians()).abs() < 1e-9, "{degrees}: {pitch_rad}");
    }
    // In the air the height over the ground changes.
    let flight = BOX.replace("at_m = [1.0, 0.5]", "at_m = [1.0, 0.5, 0.0]");
    assert_eq!(mounting(&flight), None);
    for name in World::builtin_names() {
        let world = World::builtin(name).unwrap();
        assert_eq!(world.mounting().is_none(), name.starts_with("andert-"), "{name}");
    }
}

#[test]
fn every_world_file_is_built_in() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../datasets/synth");
    let files = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let names = files.map(|path| path.file_stem().unwrap().to_string_lossy().into_owned());
    let (mut files, mut known): (Vec<_>, Vec<_>) = (names.collect(), World::builtin_names().collect());
    files.sort_unstable();
    known.sort_unstable();
    assert_eq!(files, known);
}

#[test]
fn every_builtin_world_is_sound_and_bears_its_name() {
    for name in World::builtin_names() {
        assert_eq!(World::builtin(name).unwrap().name(), name);
    }
    let error = World::builtin("stret").unwrap_err().to_string();
    assert_eq!(error, "no built-in world `stret` (did you mean `street`?)");
}

/// Texts of the small world, what to put in their place, and parts of the message that follows.
const DAMAGES: &[(&str, &str, &[&str])] = &[
    ("rate_hz", "rate_Hz", &["line 5", "`rate_Hz = 10.0`", "unknown field `rate_Hz`", "mean `rate_hz`"]),
    ("scale_m = 0.5", "scale = 0.5", &["`scale = 0.5`", "unknown field `scale`", "mean `scale_m`"]),
    ("{ size_m", "{ size", &["`shape = { box = { size ", "size_m"]),
    ("box =", "ball =", &["`shape = { ball =", "unknown variant `ball`", "there are box, cylinder"]),
    ("focal_px = 120.0\n", "", &["[stereo]", "missing field `focal_px`"]),
    ("focal_px = 120.0", "focal_px = 0", &["line 16, `focal_px = 0`", "positive number", "found 0"]),
    ("focal_px = 120.0", "focal_px = nan", &["line 16", "found NaN"]),
    ("focal_px = 120.0", "focal_px = \"wide\"", &["line 16", "focal_px", "string"]),
    ("[1.0, 4.0, 3.0]", "[1.0, -4.0, 3.0]", &["size_m", "positive number", "found -4"]),
    ("[1.0, 4.0, 3.0]", "[1.0, 4.0]", &["size_m"]),
    ("frames = 3", "frames = 0", &["line 4, `frames = 0`", "from 1", "found 0"]),
    ("frames = 3", "frames = -3", &["line 4, `frames = -3`"]),
    (
        "material = \"wood\"",
        "material = \"wod\"",
        &["`material = \"wod\"`", "unknown material", "mean `wood`"],
    ),
    ("material = \"wood\"", "model = \"car\"", &["unknown model, there are none"]),
    ("material = \"wood\"\n", "", &["[[object]]", "either `shape` and `material`, or `model`"]),
    (
        "material = \"wood\"",
        "material = \"wood\"\nmotion = { path = [] }",
        &["[[object]]", "1 to 10000 way-points"],
    ),
    ("name = \"box\"", "name = \"../box\"", &["line 2", "letters, digits"]),
    ("beams = 16", "beams = 0", &["beams = 0", "from 1"]),
    (
        "top_deg = 5.0",
        "top_deg = -30.0",
        &["line 24, `bottom_deg = -25.0`: laser 0.bottom_deg and top_deg", "-25 and -30"],
    ),
    ("top_deg = 5.0", "top_deg = 5.0\nopening_deg = 400", &["laser 0.opening_deg", "at most 360, found 400"]),
    ("step_deg = 1.0", "step_deg = 1e-5", &["laser 0.step_deg", "10 million"]),
    ("step_deg = 1.0", "step_deg = 400", &["laser 0.step_deg", "found 0 per beam"]),
    ("width = 160", "width = 1000000", &["`width = 1000000`: stereo.width", "32 million", "1000000 x 96"]),
    (
        "frames = 3",
        "frames = 8",
        &["line 8, `waypoints = [`: trajectory.waypoints", "at least 0.700 s for 8 frames", "0.500 s"],
    ),
    ("    { at_m = [6.0, 0.5] },\n", "", &["trajectory.waypoints", "at least 0.200 s", "found 0.000 s"]),
    ("at_m = [6.0, 0.5]", "at_m = [6.0]", &["`{ at_m = [6.0] },`", "two or three coordinates, found 1"]),
    (", speed_mps = 10.0", "", &["trajectory.waypoints", "a speed_mps at the first way-point"]),
    ("centre_m = [9.0", "centre_m = [2.0", &["stereo.mount_m", "left camera of frame", "inside object 1"]),
    ("yaw_deg = 25.0", "repeat = { count = 300000, step_m = [1, 0, 0] }", &["object", "found 300001"]),
    (
        "box = { size_m = [100.0, 100.0, 1.0] }",
        "rough_ground = { size_m = [9, 9], squares = [9000, 9000], deviation_m = 0.1, scale_m = 1, \
         octaves = 1, roughness = 1, thickness_m = 1 }",
        &["object: expected at most 8000000 triangles", "found 162072002"],
    ),
    ("seed = 5", "seed = = 5", &["line 3, `seed = = 5`"]),
];

#[test]
fn bad_worlds_are_refused_with_one_line_that_names_the_key() {
    for (old, new, parts) in DAMAGES {
        let text = BOX.replacen(old, new, 1);
        assert_ne!(text, BOX, "{old}");
        let message = message(&text);
        assert!(!message.contains('\n'), "{message}");
        for part in *parts {
            assert!(message.contains(part), "{new}: {message}, expected {part}");
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn no_text_makes_the_parser_panic(text in "\\PC{0,200}") {
        message(&text);
    }

    #[test]
    fn no_damage_to_a_world_makes_the_parser_panic(
        from in 0..BOX.len(),
        length in 0_usize..30,
        patch in "[-0-9a-z.\\[\\]{}=\" \n]{0,12}",
    ) {
        let to = (from + length).min(BOX.len());
        prop_assume!(BOX.is_char_boundary(from) && BOX.is_char_boundary(to));
        let text = format!("{}{patch}{}", &BOX[..from], &BOX[to..]);
        prop_assert!(!message(&text).contains('\n'));
    }

    #[test]
    fn no_number_makes_the_parser_or_the_renderer_panic(
        at in 0_usize..60,
        number in prop::sample::select(vec!["1e308", "-1e6", "1e-6", "0", "inf", "1000000", "3"]),
    ) {
        // Replaces the n-th value after an equals sign.
        let mut parts: Vec<String> = BOX.split(" = ").map(str::to_owned).collect();
        let index = 1 + at % (parts.len() - 1);
        let end = parts[index].find('\n').unwrap_or(parts[index].len());
        parts[index].replace_range(..end, number);
        if let Ok(world) = World::from_toml(&parts.join(" = ")) {
            // The largest images and sweeps take seconds; the arithmetic is the same in small ones.
            if world.rig.width * world.rig.height < 100_000 && world.frame_count() < 1000 {
                let sequence = crate::SyntheticSequence::new(world);
                evigrid_replay::Sequence::frame(&sequence, 0, &Pose::identity()).unwrap();
            }
        }
    }
}
