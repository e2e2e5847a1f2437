#!/usr/bin/env bash
# The winner-take-all baseline over its filters, as a Markdown table on standard output.
#
#   scripts/baseline_table.sh DRIVE_DIR [FRAMES]      needs evigrid on the PATH, or EVIGRID=/path/to/evigrid
#
# Every row is one `evigrid run`; nothing else than the settings in the row changes.
set -euo pipefail
drive=${1:?usage: baseline_table.sh DRIVE_DIR [FRAMES]}
frames=${2:-0..40}
evigrid=${EVIGRID:-evigrid}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

echo "| settings | hits | mistakes | of them observed | precision | recall | F1 | F within 0.2 m | F within 0.4 m | curve area |"
echo "| --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |"
row() {
    local sets=()
    for setting in "$@"; do sets+=(--set "winner-take-all.$setting"); done
    "$evigrid" run --dataset "$drive" --frames "$frames" --out "$work/run" \
        --set output.recording=false "${sets[@]}" >"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
    python3 - "$work/run/summary.csv" "$*" <<'PY'
import csv, sys
row = next(csv.DictReader(open(sys.argv[1])))
whole = [row[k] for k in ("hits", "mistakes", "mistakes_observed")]
rates = [f"{float(row[k]):.3f}" for k in ("precision", "recall", "f1", "f_score_0.2m", "f_score_0.4m", "curve_area")]
print("| " + " | ".join([f"`{sys.argv[2]}`" if sys.argv[2] else "defaults"] + whole + rates) + " |")
PY
}

row
for ratio in 1 1.1 1.2 1.5 2 2.5 3 5 8 12; do row "peak_ratio=$ratio"; done
for ratio in 1.2 1.5 2 3; do row "peak_ratio=$ratio" left_right_check=false max_depth_m=40; done
# Elfes' model without a lower bound on the evidence of one frame.
row min_probability=0.001
row disparity_error_px=0.5
row deviation=constant
