"""Reader of KITTI raw drives (synchronised and rectified), independent of the Rust crates.

Frames: `rect0` is the rectified left grey camera (x right, y down, z forward), `velo` the laser, `imu` the GPS/IMU unit, `world` the
Mercator frame of the development kit (east, north, up). `map` is x forward (horizontal heading of the first used left camera), y left,
z up, metres, with its origin at the first used left camera. A matrix `a_from_b` takes points of b to a.

    from kitti import Drive
    drive = Drive("2011_09_26/2011_09_26_drive_0013_sync", range(0, 40))
    left, right = drive.images(0)
    points = drive.scan(0)                      # float64 [N, 3], laser frame
    pose = drive.map_from_rect0(0)              # 4 x 4
"""

from pathlib import Path

import numpy as np

EARTH_RADIUS_M = 6378137.0

# The grid of Brandao et al.: x 0..160, y -5..5, z -2..2 m in cells of 0.2 m.
CELL_SIZE_M = 0.2
GRID_ORIGIN_M = np.array([0.0, -5.0, -2.0])
GRID_SHAPE = np.array([800, 50, 20])


def frame_range(text):
    """`A..B` -> range(A, B), B not included."""
    first, _, last = text.partition("..")
    return range(int(first), int(last))


def write_npz(path, **arrays):
    """Writes the arrays with the grid's origin and cell size, creating the folder."""
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    with open(path, "wb") as file:
        np.savez_compressed(file, origin=GRID_ORIGIN_M, cell_size=np.float64(CELL_SIZE_M), **arrays)


def read_calibration(path):
    """The `key: numbers` lines of a calibration file; lines that hold text are left out."""
    values = {}
    for line in Path(path).read_text().splitlines():
        key, _, numbers = line.partition(":")
        try:
            values[key] = np.array([float(n) for n in numbers.split()])
        except ValueError:
            pass
    return values


def rigid(rotation, translation):
    matrix = np.eye(4)
    matrix[:3, :3] = np.reshape(rotation, (3, 3))
    matrix[:3, 3] = translation
    return matrix


def transform(matrix, points):
    return points @ matrix[:3, :3].T + matrix[:3, 3]


class Drive:
    def __init__(self, folder, frames):
        self.folder = Path(folder)
        self.frames = frames
        date = self.folder.resolve().parent
        camera = read_calibration(date / "calib_cam_to_cam.txt")
        velo_from_imu = read_calibration(date / "calib_imu_to_velo.txt")
        cam0_from_velo = read_calibration(date / "calib_velo_to_cam.txt")

        left, right = camera["P_rect_00"].reshape(3, 4), camera["P_rect_01"].reshape(3, 4)
        self.focal_px, self.cx_px, self.cy_px = left[0, 0], left[0, 2], left[1, 2]
        self.baseline_m = (left[0, 3] - right[0, 3]) / left[0, 0]

        rect0_from_cam0 = rigid(camera["R_rect_00"], 0)
        self.rect0_from_velo = rect0_from_cam0 @ rigid(cam0_from_velo["R"], cam0_from_velo["T"])
        self.imu_from_rect0 = np.linalg.inv(self.rect0_from_velo @ rigid(velo_from_imu["R"], velo_from_imu["T"]))

        self.mercator_scale = np.cos(np.radians(self._oxts(frames[0])[0]))
        self.map_from_world = self._map_from_world(self.world_from_rect0(frames[0]))

    def _oxts(self, frame):
        return np.array(self._path("oxts", frame, "txt").read_text().split()[:6], dtype=float)

    def _path(self, sensor, frame, extension):
        return self.folder / sensor / "data" / f"{frame:010d}.{extension}"

    @staticmethod
    def _map_from_world(world_from_rect0):
        forward = world_from_rect0[:3, 2].copy()
        forward[2] = 0
        forward /= np.linalg.norm(forward)
        up = np.array([0.0, 0.0, 1.0])
        rotation = np.stack([forward, np.cross(up, forward), up])
        return rigid(rotation, -rotation @ world_from_rect0[:3, 3])

    def world_from_imu(self, frame):
        latitude, longitude, altitude, roll, pitch, yaw = self._oxts(frame)
        x = self.mercator_scale * np.radians(longitude) * EARTH_RADIUS_M
        y = self.mercator_scale * EARTH_RADIUS_M * np.log(np.tan(np.radians(90 + latitude) / 2))
        (cr, sr), (cp, sp), (cy, sy) = ((np.cos(a), np.sin(a)) for a in (roll, pitch, yaw))
        rx = np.array([[1, 0, 0], [0, cr, -sr], [0, sr, cr]])
        ry = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]])
        rz = np.array([[cy, -sy, 0], [sy, cy, 0], [0, 0, 1]])
        return rigid(rz @ ry @ rx, [x, y, altitude])

    def world_from_rect0(self, frame):
        return self.world_from_imu(frame) @ self.imu_from_rect0

    def map_from_rect0(self, frame):
        return self.map_from_world @ self.world_from_rect0(frame)

    def map_from_velo(self, frame):
        return self.map_from_rect0(frame) @ self.rect0_from_velo

    def images(self, frame):
        """The grey images of the left and right camera."""
        import cv2

        paths = [self._path(sensor, frame, "png") for sensor in ("image_00", "image_01")]
        images = [cv2.imread(str(path), cv2.IMREAD_GRAYSCALE) for path in paths]
        for path, image in zip(paths, images):
            if image is None:
                raise SystemExit(f"error: cannot read image {path}")
        return images

    def scan(self, frame):
        """Laser points in the laser frame."""
        return np.fromfile(self._path("velodyne_points", frame, "bin"), np.float32).reshape(-1, 4)[:, :3].astype(np.float64)
