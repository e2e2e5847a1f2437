//! Safety maps as ROS's map_server reads them: a picture (PGM) and a YAML file that says where it lies.

use std::io::Write;

use anyhow::{Context, Result};
use evigrid_grid::{SafetyLabel, SafetyMap};

use crate::{PendingFile, SealedFile};

/// From this share of black on a pixel is occupied.
const OCCUPIED_THRESH: f64 = 0.65;
/// Up to this share of black a pixel is free.
const FREE_THRESH: f64 = 0.196;

/// What the grey levels mean and how the picture lies, line by line.
const LEGEND: [&str; 6] = [
    "Safety map. One pixel per cell.",
    "254 = safe: labels level and inclined",
    "0 = unsafe: label non_ground",
    "205 = unknown: labels unknown and unexamined",
    "Map frame: x forward, y left. Columns along x,",
    "rows along -y: the first row has the largest y.",
];

/// The grey level of a label: free, occupied or unknown by the thresholds of the YAML file.
fn grey(label: SafetyLabel) -> u8 {
    match label.is_safe() {
        Some(true) => 254,
        Some(false) => 0,
        None => 205,
    }
}

/// Writes the labels as a binary PGM (P5) of 8 bits: one pixel per cell, columns along x (forward), the first
/// row the one with the largest y (left). 254 = safe, 0 = unsafe, 205 = unknown.
///
/// # Errors
/// If the file cannot be written.
pub fn write_ros_picture(file: PendingFile, map: &SafetyMap) -> Result<SealedFile> {
    let [nx, ny] = map.spec().shape();
    let mut bytes = format!("P5\n{}{nx} {ny}\n255\n", comments()).into_bytes();
    let rows = (0..ny).rev().flat_map(|j| (0..nx).map(move |i| i * ny + j));
    bytes.extend(rows.map(|flat| grey(map.labels()[flat])));
    write_whole(file, &bytes)
}

/// Writes the YAML file beside a picture: the name of the picture, the edge of a cell (metres), the lower left
/// corner of the picture in the map frame (x and y in metres, yaw in radians), and the thresholds of free and
/// occupied.
///
/// # Errors
/// If the file cannot be written.
pub fn write_ros_yaml(file: PendingFile, picture: &str, map: &SafetyMap) -> Result<SealedFile> {
    let ([x, y], cell_size_m) = (map.spec().origin_m(), map.spec().cell_size_m());
    // A quoted string of JSON is one of YAML too.
    let picture = serde_json::to_string(picture)?;
    let text = format!(
        "{}image: {picture}\nresolution: {cell_size_m}\norigin: [{x}, {y}, 0.0]\nnegate: 0\n\
         occupied_thresh: {OCCUPIED_THRESH}\nfree_thresh: {FREE_THRESH}\nmode: trinary\n",
        comments()
    );
    write_whole(file, text.as_bytes())
}

fn comments() -> String {
    LEGEND.map(|line| format!("# {line}\n")).concat()
}

fn write_whole(mut file: PendingFile, bytes: &[u8]) -> Result<SealedFile> {
    file.write_all(bytes).with_context(|| file.failed())?;
    file.seal()
}

#[cfg(test)]
mod tests {
    use super::*;
    use evigrid_grid::PlanSpec;

    /// Three cells forward from x = 5, two to the left from y = -3.5; rows from rear to front, each from right
    /// to left. No mirror image and no turned one of it is the same.
    fn map() -> SafetyMap {
        use SafetyLabel::{Inclined, Level, NonGround, Unexamined, Unknown};
        let mut map = SafetyMap::unknown(PlanSpec::of_area([5.0, 6.5], [-3.5, -2.5], 0.5).unwrap());
        let labels = [Level, Inclined, NonGround, Unknown, Unexamined, NonGround];
        labels.into_iter().enumerate().for_each(|(flat, label)| map.set(flat, label, None));
        map
    }

    fn written(write: impl Fn(PendingFile) -> Result<SealedFile>) -> Vec<u8> {
        let dir = tempfile::tempdir().unwrap();
        let path = dir.path().join("file");
        write(PendingFile::create(path.clone()).unwrap()).unwrap().publish().unwrap();
        std::fs::read(path).unwrap()
    }

    /// A reader of binary PGM by its definition: words separated by white space, comments up to the end of the
    /// line, then one white space and the pixels. Width, height, largest value, pixels.
    fn read_pgm(bytes: &[u8]) -> ([usize; 3], Vec<u8>) {
        let (mut at, mut words) = (0, Vec::new());
        while words.len() < 4 {
            match bytes[at] {
                b'#' => at += bytes[at..].iter().position(|b| *b == b'\n').unwrap(),
                b if b.is_ascii_whitespace() => at += 1,
                _ => {
                    let end = at + bytes[at..].iter().position(u8::is_ascii_whitespace).unwrap();
                    words.push(std::str::from_utf8(&bytes[at..end]).unwrap());
                    at = end;
                }
            }
        }
        assert_eq!(words[0], "P5");
        ([1, 2, 3].map(|i| words[i].parse().unwrap()), bytes[at + 1..].to_vec())
    }

    #[test]
    fn a_picture_has_forward_to_the_right_and_left_upwards() {
        let bytes = written(|file| write_ros_picture(file, &map()));
        let (head, pixels) = read_pgm(&bytes);
        assert_eq!(head, [3, 2, 255]);
        // Left in the upper row, right in the lower one; each from rear to front.
        assert_eq!(pixels, [254, 205, 0, 254, 0, 205]);
    }

    /// Every cell is found where the YAML file and map_server's convention say.
    #[test]
    fn a_cell_is_found_by_its_place_in_the_map() {
        let map = map();
        let ([width, height, _], pixels) = read_pgm(&written(|file| write_ros_picture(file, &map)));
        let yaml = String::from_utf8(written(|file| write_ros_yaml(file, "a.pgm", &map))).unwrap();
        let value = |key: &str| yaml.lines().find_map(|l| l.strip_prefix(key)).unwrap().to_owned();
        let resolution: f64 = value("resolution: ").parse().unwrap();
        let origin = value("origin: ");
        let origin: Vec<f64> =
            origin.trim_matches(['[', ']']).split(", ").map(|v| v.parse().unwrap()).collect();
        assert_eq!(origin[2], 0.0);
        for row in 0..height {
            for column in 0..width {
                let x = origin[0] + (column as f64 + 0.5) * resolution;
                let y = origin[1] + ((height - 1 - row) as f64 + 0.5) * resolution;
                let label = map.labels()[map.spec().cell_of([x, y]).unwrap()];
                let black = f64::from(255 - pixels[row * width + column]) / 255.0;
                let expected = match label {
                    SafetyLabel::Level | SafetyLabel::Inclined => black < FREE_THRESH,
                    SafetyLabel::NonGround => black > OCCUPIED_THRESH,
                    SafetyLabel::Unknown | SafetyLabel::Unexamined => {
                        (FREE_THRESH..=OCCUPIED_THRESH).contains(&black)
                    }
                };
                assert!(expected, "{label:?} {black}");
            }
        }
    }

    #[test]
    fn the_yaml_file_has_all_keys_and_the_legend() {
        let yaml = String::from_utf8(written(|file| write_ros_yaml(file, "map.toy.pgm", &map()))).unwrap();
        let (comments, keys): (Vec<&str>, Vec<&str>) = yaml.lines().partition(|line| line.starts_with('#'));
        let expected = [
            "image: \"map.toy.pgm\"",
            "resolution: 0.5",
            "origin: [5, -3.5, 0.0]",
            "negate: 0",
            "occupied_thresh: 0.65",
            "free_thresh: 0.196",
            "mode: trinary",
        ];
        assert_eq!((keys, comments.len()), (expected.to_vec(), LEGEND.len()));
        for label in SafetyLabel::ALL {
            assert!(comments.iter().any(|line| line.contains(label.name())), "{label:?}");
        }
    }
}
