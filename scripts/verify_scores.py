"""Recomputes the scores of a run from its npz files, with numpy alone, and compares them with summary.csv.

    verify_scores.py RUN_FOLDER                        every method in summary.csv; exit code 1 if a number differs
    verify_scores.py --map map.npz --truth truth.npz   prints the scores

A map's cell is occupied if its log-odds exceed 0. Distances lie between centres of cells.
"""

import argparse
import csv
import sys
from pathlib import Path

import numpy as np

TOLERANCES_M = (0.2, 0.4)


def ratio(part, whole):
    return part / whole if whole else float("nan")


def harmonic(a, b):
    return 0.0 if a + b == 0 else 2 * a * b / (a + b)


def keys(cells):
    """One sortable number per cell; 2^20 cells per axis, negative indices allowed."""
    shifted = np.asarray(cells, np.int64) + (1 << 19)
    return (shifted[:, 0] << 40) | (shifted[:, 1] << 20) | shifted[:, 2]


def near(cells, others, tolerance_cells):
    """For each cell: does one of the others lie within the tolerance?"""
    reach = int(np.floor(tolerance_cells + 1e-6))
    axis = np.arange(-reach, reach + 1)
    offsets = np.stack(np.meshgrid(axis, axis, axis), axis=-1).reshape(-1, 3)
    offsets = offsets[(offsets**2).sum(axis=1) <= tolerance_cells**2 + 1e-6]
    others = keys(others)
    found = np.zeros(len(cells), bool)
    for offset in offsets:
        found |= np.isin(keys(cells + offset), others)
    return found


def score(map_file, truth_file):
    a_map, truth = np.load(map_file), np.load(truth_file)
    if not (np.allclose(a_map["origin"], truth["origin"]) and np.isclose(a_map["cell_size"], truth["cell_size"])):
        sys.exit(f"error: grids differ: {map_file} {truth_file}")
    ours, true, observed = a_map["indices"][a_map["log_odds"] > 0], truth["occupied"], truth["observed"]
    is_true = np.isin(keys(ours), keys(true))
    hits = int(is_true.sum())
    scores = {
        "hits": hits,
        "mistakes": len(ours) - hits,
        "mistakes_observed": int(np.isin(keys(ours[~is_true]), keys(observed)).sum()),
        "missed": len(true) - hits,
        "precision": ratio(hits, len(ours)),
        "recall": ratio(hits, len(true)),
    }
    scores["f1"] = ratio(2 * hits, len(ours) + len(true))
    for tolerance in TOLERANCES_M:
        cells = tolerance / float(truth["cell_size"])
        accuracy = ratio(near(ours, true, cells).sum(), len(ours))
        completeness = ratio(near(true, ours, cells).sum(), len(true))
        scores[f"accuracy_{tolerance}m"] = float(accuracy)
        scores[f"completeness_{tolerance}m"] = float(completeness)
        scores[f"f_score_{tolerance}m"] = float(harmonic(accuracy, completeness))
    return scores


def text(value):
    return str(value) if isinstance(value, int) else f"{value:.4f}"


def agree(value, written):
    """Equal counts; rates to four digits, where an empty field stands for a rate that is undefined."""
    if written is None:
        return False
    if np.isnan(value):
        return written.lower() in ("", "nan")
    return written != "" and abs(float(written) - value) <= (0 if isinstance(value, int) else 1e-4)


def verify(folder):
    """Prints each number beside the one in summary.csv; returns how many differ or are absent."""
    differences = 0
    with open(folder / "summary.csv", newline="") as file:
        rows = list(csv.DictReader(file))
    if not rows:
        sys.exit(f"error: {folder / 'summary.csv'} has no rows")
    for row in rows:
        print(row["method"])
        for name, value in score(folder / f"map.{row['method']}.npz", folder / "truth.npz").items():
            written = row.get(name)
            same = agree(value, written)
            differences += not same
            print(f"  {name:20} {text(value):>10} {'absent' if written is None else written:>10}{'' if same else '   DIFFERS'}")
    return differences


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("run", nargs="?", type=Path, help="folder of a run")
    parser.add_argument("--map", help="a map's npz file")
    parser.add_argument("--truth", help="the truth's npz file")
    args = parser.parse_args()
    if args.map and args.truth:
        for name, value in score(args.map, args.truth).items():
            print(f"{name:20} {text(value):>10}")
    elif args.run:
        differences = verify(args.run)
        sys.exit(f"{differences} numbers differ from summary.csv" if differences else 0)
    else:
        parser.error("give a run folder, or --map and --truth")


if __name__ == "__main__":
    main()
