//! The tables of the exact truth, as CSV. Names hold letters, digits, - and _
//! alone, so nothing is ever quoted.

use std::fmt::Write;

use evigrid_grid::PlanSpec;

use crate::exact::{BoardView, GroundPlane, Hazard, Track};
use crate::thing::Thing;

/// First line of boards.csv.
pub const BOARDS_HEADING: &str = "frame,object,name,distance_m,width_m,visible_left_m,visible_both_m\n";
/// First line of planes.csv.
pub const PLANES_HEADING: &str = "object,name,normal_x,normal_y,normal_z,offset_m,slope_deg,\
    corner_0_x_m,corner_0_y_m,corner_0_z_m,corner_1_x_m,corner_1_y_m,corner_1_z_m,\
    corner_2_x_m,corner_2_y_m,corner_2_z_m,corner_3_x_m,corner_3_y_m,corner_3_z_m\n";
/// First line of objects.csv.
pub const OBJECTS_HEADING: &str = "frame,object,name,centre_x_m,centre_y_m,centre_z_m,yaw_deg,\
    length_x_m,length_y_m,length_z_m,velocity_x_mps,velocity_y_mps,velocity_z_mps,is_moving,ever_moves\n";
/// First line of hazards.csv.
pub const HAZARDS_HEADING: &str = "name,kind,x_m,y_m\n";

/// surfaces.csv: what the numbers of the surface images stand for.
pub fn surfaces(things: &[Thing]) -> String {
    let row = |(number, thing): (usize, &Thing)| {
        format!("{},{},{}\n", number + 1, name(thing.name.as_deref()), u8::from(thing.is_ground))
    };
    let rows = things.iter().enumerate().map(row).collect::<String>();
    format!("surface,name,is_ground\n0,sky,0\n{rows}")
}

/// The rows of a frame in boards.csv.
pub fn boards(frame: usize, views: &[BoardView]) -> String {
    let row = |view: &BoardView| {
        let lengths = [view.distance_m, view.width_m, view.visible_left_m, view.visible_both_m];
        row(&[frame.to_string(), view.thing.to_string(), name(view.name.as_deref())], &lengths, &[])
    };
    views.iter().map(row).collect()
}

/// The rows of planes.csv.
pub fn planes(planes: &[GroundPlane]) -> String {
    let row = |plane: &GroundPlane| {
        let mut values = plane.normal.iter().copied().collect::<Vec<f64>>();
        values.extend([plane.offset_m, plane.slope_deg]);
        values.extend(plane.corners_m.iter().flat_map(|corner| corner.coords.iter().copied()));
        row(&[plane.thing.to_string(), name(plane.name.as_deref())], &values, &[])
    };
    planes.iter().map(row).collect()
}

/// The rows of a frame in objects.csv.
pub fn objects(frame: usize, tracks: &[Track]) -> String {
    let row = |track: &Track| {
        let mut values = track.centre_m.coords.iter().copied().collect::<Vec<f64>>();
        values.push(track.yaw_rad.to_degrees());
        values.extend(track.lengths_m.iter().chain(track.velocity_mps.iter()));
        let moves = [track.is_moving, track.moves].map(|moves| u8::from(moves).to_string());
        row(&[frame.to_string(), track.thing.to_string(), track.name.clone()], &values, &moves)
    };
    tracks.iter().map(row).collect()
}

/// The rows of hazards.csv: one for each cell.
pub fn hazards(hazards: &[Hazard], spec: &PlanSpec) -> String {
    let rows = |hazard: &Hazard| {
        let before = [hazard.name.clone(), hazard.kind.name().to_owned()];
        hazard.cells.iter().map(|&cell| row(&before, &spec.centre_m(cell), &[])).collect::<String>()
    };
    hazards.iter().map(rows).collect()
}

fn name(name: Option<&str>) -> String {
    name.unwrap_or_default().to_owned()
}

/// One line: numbers with six decimals between words.
fn row(before: &[String], values: &[f64], after: &[String]) -> String {
    let mut line = before.join(",");
    for value in values {
        // Adding 0 drops the sign of a negative zero.
        let _ = write!(line, ",{}", format!("{:.6}", value + 0.0).replace("-0.000000", "0.000000"));
    }
    for word in after {
        let _ = write!(line, ",{word}");
    }
    line.push('\n');
    line
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::HazardKind;
    use nalgebra::{Point3, Vector3};

    #[test]
    fn every_row_has_the_columns_of_its_heading() {
        let columns = |text: &str| text.trim_end().split(',').count();
        let view = BoardView {
            thing: 3,
            name: None,
            distance_m: 4.5,
            width_m: 1.0,
            visible_left_m: 0.25,
            visible_both_m: -1e-9,
        };
        assert_eq!(boards(7, &[view]), "7,3,,4.500000,1.000000,0.250000,0.000000\n");
        let plane = GroundPlane {
            thing: 1,
            name: Some("road".to_owned()),
            normal: Vector3::z(),
            offset_m: -1.5,
            slope_deg: 0.0,
            corners_m: [Point3::new(1.0, 2.0, 3.0); 4],
        };
        let text = planes(&[plane]);
        assert!(text.starts_with("1,road,0.000000,0.000000,1.000000,-1.500000,0.000000,1.000000,2.000000,"));
        assert_eq!(columns(&text), columns(PLANES_HEADING));
        let track = Track {
            thing: 2,
            name: "cyclist-1".to_owned(),
            centre_m: Point3::new(1.0, 2.0, 3.0),
            yaw_rad: std::f64::consts::FRAC_PI_2,
            lengths_m: Vector3::new(1.8, 0.6, 1.7),
            velocity_mps: Vector3::new(0.0, 4.0, 0.0),
            is_moving: true,
            moves: true,
        };
        let text = objects(0, &[track]);
        assert!(text.starts_with("0,2,cyclist-1,1.000000,2.000000,3.000000,90.000000,1.800000,"), "{text}");
        assert!(text.ends_with(",4.000000,0.000000,1,1\n"), "{text}");
        assert_eq!(columns(&text), columns(OBJECTS_HEADING));
        let table = Hazard { name: "desk".to_owned(), kind: HazardKind::Table, cells: vec![1, 2] };
        let text = hazards(&[table], &PlanSpec::of_area([0.0, 2.0], [-1.0, 1.0], 1.0).unwrap());
        assert_eq!(text, "desk,table,0.500000,0.500000\ndesk,table,1.500000,-0.500000\n");
        assert_eq!(columns(text.lines().next().unwrap()), columns(HAZARDS_HEADING));
    }
}
