"""Draws error against time of a frame, from the results of `incise-bench accuracy --json`.

    python accuracy.py [--results FILE] [--scenes bunny drop] [-o accuracy.png]

Points are combinations of substeps and iterations, lines the work-precision Pareto front of each
scheme: no other combination has a smaller error in less time. References are solved to convergence
in 64 bits.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
from matplotlib.axes import Axes

RESULTS = Path(__file__).parents[2] / "bench/results/epyc-2-threads/accuracy.jsonl"
PAPER = "the paper's (PBD, one substep)"
LABELS = {
    PAPER: PAPER,
    "pbd": "PBD",
    "xpbd": "XPBD",
    "xpbd-half": "XPBD, diagonal scale 0.5",
    "xpbd-half-bdf2": "the same, second order",
    "patches": "rigid patches",
}


def read_scenes(path: Path) -> dict[str, dict[str, list[tuple[float, float]]]]:
    """Returns milliseconds a frame and total error [mean edges] of runs, by scene and scheme."""
    scenes: dict[str, dict[str, list[tuple[float, float]]]] = {}
    for line in path.read_text().splitlines():
        row = json.loads(line)
        error = (row.get("total") or {}).get("position")
        # A run that did not stay finite has no error.
        if row.get("kind") == "run" and row["ms_per_frame"] and error:
            is_paper = row["scheme"] == "pbd" and row["substeps"] == 1
            runs = scenes.setdefault(row["name"], {})
            runs.setdefault(PAPER if is_paper else row["scheme"], []).append(
                (row["ms_per_frame"], error)
            )
    return scenes


def pareto_front(runs: list[tuple[float, float]]) -> list[tuple[float, float]]:
    """Returns the runs that no other run beats in both time and error, by ascending time."""
    front: list[tuple[float, float]] = []
    for time, error in sorted(runs):
        if not front or error < front[-1][1]:
            front.append((time, error))
    return front


def draw_scene(axes: Axes, name: str, runs: dict[str, list[tuple[float, float]]]) -> None:
    """Draws the runs and the front of each scheme."""
    for i, (scheme, label) in enumerate(LABELS.items()):
        if scheme in runs:
            axes.loglog(*zip(*runs[scheme]), ".", color=f"C{i}", alpha=0.3, markersize=3)
            axes.loglog(*zip(*pareto_front(runs[scheme])), color=f"C{i}", label=label)
    axes.set(title=name, xlabel="ms per frame", ylabel="error [mean edges]")


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--results", type=Path, default=RESULTS)
    parser.add_argument("--scenes", nargs="*")
    parser.add_argument("-o", "--output", default="accuracy.png")
    arguments = parser.parse_args()
    known = read_scenes(arguments.results)
    scenes = {name: runs for name, runs in known.items() if name in (arguments.scenes or known)}
    if not scenes:
        names = ", ".join(known) or "none"
        parser.error(f"no such scenes in {arguments.results}; there are: {names}")
    columns = min(4, len(scenes))
    rows = -(-len(scenes) // columns)
    size = (4 * columns, 3.4 * rows)
    figure, grid = plt.subplots(rows, columns, figsize=size, squeeze=False, layout="constrained")
    for axes, (name, runs) in zip(grid.flat, scenes.items()):
        draw_scene(axes, name, runs)
    for axes in grid.flat[len(scenes) :]:
        axes.set_axis_off()
    figure.legend(*grid[0][0].get_legend_handles_labels(), loc="outside lower center", ncols=4)
    figure.savefig(arguments.output, dpi=110)
    print(arguments.output)


if __name__ == "__main__":
    main()
