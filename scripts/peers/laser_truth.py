"""Laser truth grid: a slow, independent transcription to hold the project's own truth against.

    laser_truth.py --drive 2011_09_26/2011_09_26_drive_0013_sync --frames 0..40 --out truth.npz

Rays run from the laser's origin to each return. Shorter than 1 m: skipped. Longer than 80 m: free up to 80 m, no occupied end. Per scan
each voxel counts at most once and occupied wins: +0.85 or -0.4, clamped to [-2, 3.5]. A voxel is occupied if its log-odds ever exceeded 0,
and observed if any ray touched it. Writes `occupied` and `observed` (int32 [N, 3]), `origin` [3] and `cell_size`.
"""

import argparse

import numpy as np

from kitti import CELL_SIZE_M, GRID_ORIGIN_M, GRID_SHAPE, Drive, frame_range, transform, write_npz

MIN_RANGE_M, MAX_RANGE_M = 1.0, 80.0
OCCUPIED_STEP, FREE_STEP = 0.85, -0.4
LOG_ODDS_MIN, LOG_ODDS_MAX = -2.0, 3.5


def inside(voxels):
    return np.all((voxels >= 0) & (voxels < GRID_SHAPE), axis=-1)


def walk(starts, ends, visit):
    """Calls `visit(voxels)` with every grid voxel that the segments pass, one step of all segments at a time (Amanatides & Woo 1987).

    Starts and ends are in cells. A segment crosses exactly |end voxel - start voxel| planes per axis, so it cannot overshoot.
    """
    voxel, last = np.floor(starts).astype(np.int64), np.floor(ends).astype(np.int64)
    near, far = np.minimum(voxel, last), np.maximum(voxel, last)
    meets_grid = np.all((far >= 0) & (near < GRID_SHAPE), axis=1)
    starts, ends, voxel, last = (a[meets_grid] for a in (starts, ends, voxel, last))

    direction = ends - starts
    step = np.sign(last - voxel)
    left = np.abs(last - voxel)
    with np.errstate(divide="ignore", invalid="ignore"):
        per_cell = 1 / np.abs(direction)
        next_plane = (voxel + (step > 0) - starts) / direction
    next_plane[left == 0] = np.inf

    while True:
        visit(voxel[inside(voxel)])
        leaving = ((step >= 0) & (voxel >= GRID_SHAPE)) | ((step <= 0) & (voxel < 0))
        alive = (left.sum(axis=1) > 0) & ~leaving.any(axis=1)
        if not alive.any():
            return
        if not alive.all():
            voxel, step, left, per_cell, next_plane = (a[alive] for a in (voxel, step, left, per_cell, next_plane))
        rows = np.arange(len(voxel))
        axis = np.argmin(next_plane, axis=1)
        voxel[rows, axis] += step[rows, axis]
        left[rows, axis] -= 1
        next_plane[rows, axis] = np.where(left[rows, axis] > 0, next_plane[rows, axis] + per_cell[rows, axis], np.inf)


def scan_voxels(origin, points):
    """(occupied, touched) as boolean grids for one scan in the map frame."""
    rays = points - origin
    length = np.linalg.norm(rays, axis=1)
    kept = length >= MIN_RANGE_M
    rays, length = rays[kept], length[kept]
    hit = length <= MAX_RANGE_M
    ends = origin + rays * np.minimum(1, MAX_RANGE_M / length)[:, None]

    occupied, touched = np.zeros(GRID_SHAPE, bool), np.zeros(GRID_SHAPE, bool)
    start_cells = np.broadcast_to((origin - GRID_ORIGIN_M) / CELL_SIZE_M, ends.shape)
    end_cells = (ends - GRID_ORIGIN_M) / CELL_SIZE_M

    def touch(voxels):
        touched[tuple(voxels.T)] = True

    walk(start_cells, end_cells, touch)
    hit_voxels = np.floor(end_cells[hit]).astype(np.int64)
    occupied[tuple(hit_voxels[inside(hit_voxels)].T)] = True
    return occupied, touched


def build_truth(drive):
    log_odds = np.zeros(GRID_SHAPE)
    ever_occupied, observed = np.zeros(GRID_SHAPE, bool), np.zeros(GRID_SHAPE, bool)
    for frame in drive.frames:
        pose = drive.map_from_velo(frame)
        occupied, touched = scan_voxels(pose[:3, 3], transform(pose, drive.scan(frame)))
        step = np.where(occupied, OCCUPIED_STEP, np.where(touched, FREE_STEP, 0.0))
        log_odds = np.clip(log_odds + step, LOG_ODDS_MIN, LOG_ODDS_MAX)
        ever_occupied |= log_odds > 0
        observed |= touched | occupied
    return ever_occupied, observed


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drive", required=True, help="folder of the synchronised drive")
    parser.add_argument("--frames", type=frame_range, default=range(0, 40), help="A..B, B not included (default 0..40)")
    parser.add_argument("--out", required=True, help="npz file to write")
    args = parser.parse_args()

    occupied, observed = build_truth(Drive(args.drive, args.frames))
    write_npz(args.out, occupied=np.argwhere(occupied).astype(np.int32), observed=np.argwhere(observed).astype(np.int32))
    print(f"occupied {occupied.sum()}, observed {observed.sum()}")


if __name__ == "__main__":
    main()
