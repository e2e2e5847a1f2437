//! GPS/IMU packets of KITTI raw drives and the poses that the development kit makes of them.

use evigrid_core::Pose;
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

use crate::text::{Fault, numbers};

/// Numbers in one packet (dataformat.txt of every drive); the first six are the pose.
pub(crate) const FIELDS: usize = 30;
/// Earth radius of the development kit's Mercator projection, metres.
const EARTH_RADIUS_M: f64 = 6_378_137.0;

/// Position and attitude of the GPS/IMU unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Packet {
    pub latitude_deg: f64,
    pub longitude_deg: f64,
    pub altitude_m: f64,
    /// Radians, 0 = level, positive = left side up.
    pub roll: f64,
    /// Radians, 0 = level, positive = front down.
    pub pitch: f64,
    /// Radians, 0 = east, positive = counter-clockwise.
    pub yaw: f64,
}

/// The packet in the text of one oxts file.
pub(crate) fn parse_packet(text: &str) -> Result<Packet, Fault> {
    let fields = numbers::<FIELDS>("oxts packet", text).map_err(|fault| fault.on_line(1))?;
    let [latitude_deg, longitude_deg, altitude_m, roll, pitch, yaw, ..] = fields;
    for (what, limit, value) in
        [("oxts latitude", 90.0, latitude_deg), ("oxts longitude", 360.0, longitude_deg)]
    {
        // Mercator has no poles, so that the limit itself does not belong to the domain.
        if value.abs() >= limit {
            let expected = format!("between -{limit} and {limit} degrees");
            return Err(Fault::new(what, expected, value.to_string()).on_line(1));
        }
    }
    Ok(Packet { latitude_deg, longitude_deg, altitude_m, roll, pitch, yaw })
}

/// The flat world of a drive: x east, y north, z up, metres, origin at the first packet's position. KITTI
/// development kit, convertOxtsToPose.m: a Mercator projection whose scale is that of the first packet's
/// latitude. (The kit puts the origin of its first *pose* there too, turned with the car; here z stays up.)
#[derive(Debug, Clone, Copy)]
pub(crate) struct MercatorWorld {
    scale: f64,
    origin: Vector3<f64>,
}

impl MercatorWorld {
    /// The world whose origin is at a packet.
    pub fn at(first: &Packet) -> Self {
        let scale = first.latitude_deg.to_radians().cos();
        Self { scale, origin: mercator(scale, first) }
    }

    /// Pose of the GPS/IMU unit (x forward, y left, z up): R = Rz(yaw) Ry(pitch) Rx(roll).
    pub fn world_from_imu(&self, packet: &Packet) -> Pose {
        let rotation = UnitQuaternion::from_euler_angles(packet.roll, packet.pitch, packet.yaw);
        Isometry3::from_parts((mercator(self.scale, packet) - self.origin).into(), rotation)
    }
}

/// Projected position, metres: latlonToMercator.m, and the altitude as it is.
fn mercator(scale: f64, packet: &Packet) -> Vector3<f64> {
    let x = scale * EARTH_RADIUS_M * packet.longitude_deg.to_radians();
    let y = scale * EARTH_RADIUS_M * ((90.0 + packet.latitude_deg).to_radians() / 2.0).tan().ln();
    Vector3::new(x, y, packet.altitude_m)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::fixtures::oxts_line;
    use proptest::prelude::*;
    use std::f64::consts::FRAC_PI_2;
    use std::path::Path;

    fn packet(latitude_deg: f64, longitude_deg: f64, [roll, pitch, yaw]: [f64; 3]) -> Packet {
        Packet { latitude_deg, longitude_deg, altitude_m: 100.0, roll, pitch, yaw }
    }

    #[test]
    fn positions_are_metres_east_and_north_of_the_first_packet() {
        // One thousandth of a degree of a great circle: 6378137 * pi / 180000 = 111.3195 m; along the
        // parallel of 60 degrees half of it, along the meridian all of it.
        let world = MercatorWorld::at(&packet(60.0, 8.0, [0.0; 3]));
        let there = Packet { altitude_m: 103.0, ..packet(60.001, 8.001, [0.0; 3]) };
        let position = world.world_from_imu(&there).translation.vector;
        assert!((position - Vector3::new(55.6597, 111.3195, 3.0)).norm() < 5e-3, "{position}");
        assert_eq!(world.world_from_imu(&packet(60.0, 8.0, [0.0; 3])).translation.vector, Vector3::zeros());
    }

    #[test]
    fn angles_turn_about_the_axes_they_are_named_after() {
        let world = MercatorWorld::at(&packet(0.0, 0.0, [0.0; 3]));
        let turned = |angles, v: Vector3<f64>| world.world_from_imu(&packet(0.0, 0.0, angles)).rotation * v;
        for (angles, axis, expected) in [
            // Yaw counter-clockwise: the car that faced east faces north.
            ([0.0, 0.0, FRAC_PI_2], Vector3::x(), Vector3::y()),
            // Pitch front down.
            ([0.0, FRAC_PI_2, 0.0], Vector3::x(), -Vector3::z()),
            // Roll left side up.
            ([FRAC_PI_2, 0.0, 0.0], Vector3::y(), Vector3::z()),
            // Roll first, yaw last: left goes up and stays up.
            ([FRAC_PI_2, 0.0, FRAC_PI_2], Vector3::y(), Vector3::z()),
        ] {
            assert!((turned(angles, axis) - expected).norm() < 1e-12, "{angles:?}");
        }
    }

    #[test]
    fn packets_of_another_shape_are_refused() {
        assert_eq!(parse_packet(&oxts_line(60.0, 8.0, 0.1)).unwrap().yaw, 0.1);
        let message = |text: &str| parse_packet(text).unwrap_err().of(Path::new("0.txt")).to_string();
        assert_eq!(message("1 2 3"), "oxts packet: expected 30 numbers, found 3: 0.txt:1");
        let pole = message(&oxts_line(90.0, 8.0, 0.1));
        assert_eq!(pole, "oxts latitude: expected between -90 and 90 degrees, found 90: 0.txt:1");
        let nan = message(&oxts_line(f64::NAN, 8.0, 0.1));
        assert_eq!(nan, "oxts packet: expected a finite number, found \"NaN\": 0.txt:1");
    }

    proptest! {
        #[test]
        fn any_text_is_read_without_panic(text in "\\PC*|([-0-9e.]{1,9} ){30}") {
            if let Ok(packet) = parse_packet(&text) {
                let pose = MercatorWorld::at(&packet).world_from_imu(&packet);
                prop_assert!(pose.translation.vector.iter().all(|v| v.is_finite()));
            }
        }
    }
}
