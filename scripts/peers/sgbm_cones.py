"""Error and density of OpenCV's StereoSGBM on Middlebury pairs with `gt.png` (whole pixels, 0 = unknown), as a Markdown table.

    sgbm_cones.py data/middlebury/cones

Block 5, P1 200, P2 800, uniqueness 5, 64 disparities; the left-right check of StereoSGBM is always on. Columns as those of
`evigrid reproduce souza/matching`.
"""

import argparse
from pathlib import Path

import cv2
import numpy as np

MODES = {"3-way": "SGBM_3WAY", "5 paths": "SGBM", "8 paths": "HH", "4 paths": "HH4"}


def scores(found, truth):
    known = truth > 0
    matched = known & (found >= 0)
    wrong = matched & (np.abs(found - truth) > 1)
    return 100 * wrong.sum() / matched.sum(), 100 * matched.sum() / known.sum(), 100 * wrong.sum() / known.sum()


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("pairs", nargs="+", type=Path)
    print("| pair | matcher | pre-filter cap | off by more than 1 px | matched | off, of all |")
    print("| --- | --- | --- | --- | --- | --- |")
    for pair in parser.parse_args().pairs:
        left, right = (cv2.imread(str(pair / name), cv2.IMREAD_GRAYSCALE) for name in ("left.png", "right.png"))
        truth = cv2.imread(str(pair / "gt.png"), cv2.IMREAD_UNCHANGED).astype(np.float32)
        for name, mode in MODES.items():
            for cap in (0, 31):
                matcher = cv2.StereoSGBM_create(
                    minDisparity=0,
                    numDisparities=64,
                    blockSize=5,
                    P1=200,
                    P2=800,
                    preFilterCap=cap,
                    uniquenessRatio=5,
                    mode=getattr(cv2, f"STEREO_SGBM_MODE_{mode}"),
                )
                error, density, wrong = scores(matcher.compute(left, right) / 16, truth)
                print(f"| {pair.name} | StereoSGBM {name} | {cap} | {error:.2f} % | {density:.1f} % | {wrong:.2f} % |")


if __name__ == "__main__":
    main()
