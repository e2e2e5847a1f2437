#!/usr/bin/env bash
# A long KITTI raw drive made of links to a short one, played again and again: to see that memory stays flat.
#
#   scripts/repeat_drive.sh DRIVE_DIR TIMES OUT_DIR      prints the folder of the long drive
set -euo pipefail
drive=$(realpath "${1:?usage: repeat_drive.sh DRIVE_DIR TIMES OUT_DIR}")
times=$2
mkdir -p "$3"
out=$(realpath "$3")/$(basename "$(dirname "$drive")")/$(basename "$drive")
mkdir -p "$out"
ln -sf "$(dirname "$drive")"/calib_*.txt "$(dirname "$out")"
for part in image_00 image_01 oxts velodyne_points; do
    mkdir -p "$out/$part/data"
    files=("$drive/$part/data/"*)
    for stamps in "$drive/$part"/timestamps*.txt; do
        for ((i = 0; i < times; i++)); do cat "$stamps"; done >"$out/$part/$(basename "$stamps")"
    done
    for ((i = 0; i < times * ${#files[@]}; i++)); do
        file=${files[i % ${#files[@]}]}
        ln -sf "$file" "$out/$part/data/$(printf %010d "$i").${file##*.}"
    done
done
echo "$out"
