"""Times OpenCV's matchers and prints them beside our own timings.

    time_matchers.py --drive 2011_09_26/2011_09_26_drive_0013_sync [--frame 0] [--criterion target/criterion]

Two pairs: the frame as it is with 128 disparities, and the frame scaled to 640 x 480 with 64. Each time is the median over the runs, with
one and with two threads. Ours come from criterion's estimates of the benches `match/kitti_1242x375_128` and `match/vga_640x480_64`, with the
number of threads as last part of the name (`match/vga_640x480_64/2`); without one they stand in the rows of two threads. Ratio: ours /
StereoBM with as many threads; our semi-global matching stands in `semi_global/kitti_1242x375_128/2`. Run the benches and this script on an idle machine, one after the other.
"""

import argparse
import json
import time
from pathlib import Path

import cv2
import numpy as np

from kitti import Drive
from sgbm_octomap import block_matcher, sgbm

PAIRS = [("kitti_1242x375_128", None, 128), ("vga_640x480_64", (640, 480), 64)]
BLOCK_MATCHER_SIZE, SGBM_SIZE = 9, 5


def median_ms(matcher, left, right, runs):
    matcher.compute(left, right)
    times = []
    for _ in range(runs):
        start = time.perf_counter()
        matcher.compute(left, right)
        times.append(1e3 * (time.perf_counter() - start))
    return float(np.median(times))


def plain_block_matcher(disparities):
    """StereoBM as it comes, without left-right check and speckle filter: matching alone."""
    return cv2.StereoBM_create(numDisparities=disparities, blockSize=BLOCK_MATCHER_SIZE)


def eight_paths(disparities):
    """StereoSGBM with all eight paths."""
    matcher = sgbm(disparities, SGBM_SIZE)
    matcher.setMode(cv2.STEREO_SGBM_MODE_HH)
    return matcher


def find_benches(criterion):
    """The folder of each bench's newest estimates, by the bench's full name."""
    files = criterion.glob("**/new/benchmark.json")
    return {json.loads(file.read_text())["full_id"]: file.parent for file in files}


def ours_ms(benches, pair, threads):
    """Median of our bench, or None where it has not been run."""
    names = [f"match/{pair}/{threads}"] + ([f"match/{pair}"] if threads == 2 else [])
    for name in names:
        if name in benches:
            return json.loads((benches[name] / "estimates.json").read_text())["median"]["point_estimate"] / 1e6
    return None


def cell(value, digits=1):
    return "-" if value is None else f"{value:.{digits}f}"


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--drive", required=True, help="folder of the synchronised drive")
    parser.add_argument("--frame", type=int, default=0)
    parser.add_argument("--runs", type=int, default=20)
    parser.add_argument("--criterion", type=Path, default=Path("target/criterion"), help="criterion's output folder")
    args = parser.parse_args()

    images = Drive(args.drive, [args.frame]).images(args.frame)
    benches = find_benches(args.criterion)
    print(f"OpenCV {cv2.__version__}, median of {args.runs} runs, ms\n")
    print("| pair | threads | StereoBM | StereoBM, filtered | StereoSGBM 3-way | 8 paths | ours | ours / StereoBM |")
    print("| --- | --- | --- | --- | --- | --- | --- | --- |")
    for pair, size, disparities in PAIRS:
        left, right = (cv2.resize(image, size, interpolation=cv2.INTER_AREA) if size else image for image in images)
        matchers = [
            plain_block_matcher(disparities),
            block_matcher(disparities, BLOCK_MATCHER_SIZE),
            sgbm(disparities, SGBM_SIZE),
            eight_paths(disparities),
        ]
        for threads in (1, 2):
            cv2.setNumThreads(threads)
            times = [median_ms(matcher, left, right, args.runs) for matcher in matchers]
            ours = ours_ms(benches, pair, threads)
            ratio = None if ours is None else ours / times[0]
            print("| " + " | ".join([pair, str(threads), *map(cell, times), cell(ours), cell(ratio, 2)]) + " |")


if __name__ == "__main__":
    main()
