"""Maps frames of a KITTI raw drive with OpenCV's matcher and OctoMap, and writes the map for `evigrid score`.

    sgbm_octomap.py --drive 2011_09_26/2011_09_26_drive_0013_sync --frames 0..40 --out map.sgbm.npz
    sgbm_octomap.py --drive ... --matcher bm --out map.bm.npz

StereoSGBM: 3-way, block 5, P1 200, P2 800. StereoBM: block 9. Both: 128 disparities, pre-filter cap 31, uniqueness 10 per cent, left-right
difference at most 1, speckles below 100 pixels removed, where a step of 2 pixels ends a speckle (ranges that OpenCV's documentation names;
StereoSGBM takes this step in pixels, StereoBM in sixteenths of a pixel). OctoMap: its defaults (hit 0.7, miss 0.4, clamps 0.12 and 0.97).
Points further ahead than --max-depth-m are left out; with --far free, rays are cut there and count as free space up to it.

The npz holds every known voxel of the grid: `indices` int32 [N, 3], `log_odds` float32 [N], `origin` [3], `cell_size`.
"""

import argparse
import time

import cv2
import numpy as np
import octomap

from kitti import CELL_SIZE_M, GRID_ORIGIN_M, GRID_SHAPE, Drive, frame_range, transform, write_npz


def sgbm(disparities=128, block=5):
    return cv2.StereoSGBM_create(
        minDisparity=0,
        numDisparities=disparities,
        blockSize=block,
        P1=8 * block * block,
        P2=32 * block * block,
        disp12MaxDiff=1,
        preFilterCap=31,
        uniquenessRatio=10,
        speckleWindowSize=100,
        speckleRange=2,
        mode=cv2.StereoSGBM_MODE_SGBM_3WAY,
    )


def block_matcher(disparities=128, block=9):
    matcher = cv2.StereoBM_create(numDisparities=disparities, blockSize=block)
    matcher.setPreFilterCap(31)
    matcher.setTextureThreshold(10)
    matcher.setUniquenessRatio(10)
    matcher.setSpeckleWindowSize(100)
    matcher.setSpeckleRange(2 * 16)
    matcher.setDisp12MaxDiff(1)
    return matcher


MATCHERS = {"sgbm": sgbm, "bm": block_matcher}


def points_in_left_camera(drive, disparity, max_depth_m):
    """The measured pixels as points [N, 3] of the rectified left camera."""
    rows, columns = np.nonzero(disparity > 0)
    z = drive.focal_px * drive.baseline_m / disparity[rows, columns]
    points = np.stack([(columns - drive.cx_px) * z / drive.focal_px, (rows - drive.cy_px) * z / drive.focal_px, z], axis=1)
    return points[z <= max_depth_m]


def grid_cells(tree):
    """(indices, log-odds) of all leaves within the grid; a pruned leaf is split into the voxels that it stands for.

    OctoMap's voxel borders are multiples of the cell size, and so are the grid's.
    """
    offset = np.round(GRID_ORIGIN_M / CELL_SIZE_M).astype(np.int64)
    corners, widths, values = [], [], []
    for leaf in tree.begin_leafs():
        width = leaf.getSize()
        corners.append(np.subtract(leaf.getCoordinate(), width / 2))
        widths.append(width)
        values.append(leaf.getValue())
    corners = np.round(np.array(corners) / CELL_SIZE_M).astype(np.int64) - offset
    widths = np.round(np.array(widths) / CELL_SIZE_M).astype(np.int64)
    values = np.array(values, np.float32)

    indices, log_odds = [], []
    for width in np.unique(widths):
        same = widths == width
        inner = np.stack(np.meshgrid(*[np.arange(width)] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        voxels = (corners[same][:, None] + inner).reshape(-1, 3)
        inside = np.all((voxels >= 0) & (voxels < GRID_SHAPE), axis=1)
        indices.append(voxels[inside])
        log_odds.append(np.repeat(values[same], len(inner))[inside])
    return np.concatenate(indices).astype(np.int32), np.concatenate(log_odds)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drive", required=True, help="folder of the synchronised drive")
    parser.add_argument("--frames", type=frame_range, default=range(0, 40), help="A..B, B not included (default 0..40)")
    parser.add_argument("--matcher", choices=MATCHERS, default="sgbm")
    parser.add_argument("--max-depth-m", type=float, default=40.0)
    parser.add_argument("--far", choices=("drop", "free"), default="drop", help="what becomes of points beyond that")
    parser.add_argument("--out", required=True, help="npz file to write")
    args = parser.parse_args()

    max_depth_m, max_ray_m = (args.max_depth_m, -1.0) if args.far == "drop" else (np.inf, args.max_depth_m)
    drive, matcher, tree = Drive(args.drive, args.frames), MATCHERS[args.matcher](), octomap.OcTree(CELL_SIZE_M)
    match_ms, insert_ms = [], []
    for frame in args.frames:
        left, right = drive.images(frame)
        start = time.perf_counter()
        disparity = matcher.compute(left, right).astype(np.float64) / 16
        matched = time.perf_counter()
        pose = drive.map_from_rect0(frame)
        points = transform(pose, points_in_left_camera(drive, disparity, max_depth_m))
        prepared = time.perf_counter()
        tree.insertPointCloud(points, pose[:3, 3], max_ray_m)
        match_ms.append(1e3 * (matched - start))
        insert_ms.append(1e3 * (time.perf_counter() - prepared))

    indices, log_odds = grid_cells(tree)
    write_npz(args.out, indices=indices, log_odds=log_odds)
    print(f"{len(indices)} known voxels, {(log_odds > 0).sum()} occupied; median per frame: "
          f"matching {np.median(match_ms):.0f} ms, OctoMap {np.median(insert_ms):.0f} ms")


if __name__ == "__main__":
    main()
