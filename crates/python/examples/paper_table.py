"""Repeats the paper's Table 1 and draws it, and the accuracy of caps by level.

    python paper_table.py [--seconds 15] [--models Sphere768 Bunny] [-o table.png]
"""

from __future__ import annotations

import argparse

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

import incise

LEVELS = ["2x-coarser", "1.5x-coarser", "original", "1.5x-finer", "2x-finer"]


def print_table(rows: list[incise.PaperRow]) -> None:
    """Prints the table with the paper's numbers in parentheses."""
    print("model       triangles      PBD FPS (paper)    PBD+CS FPS (paper)      cut ms (paper)")
    for row in rows:
        print(
            f"{row['model']:10} {row['triangles']:10} "
            f"{row['pbd_fps']:12.1f} ({row['paper_pbd_fps']:6.1f}) "
            f"{row['pbd_cs_fps']:12.1f} ({row['paper_pbd_cs_fps']:6.1f}) "
            f"{row['cut_ms_mean']:12.3f} ({row['paper_cut_ms']:6.2f})"
        )


def draw_rates(axes: Axes, rows: list[incise.PaperRow]) -> None:
    """Draws frame rates over the number of triangles."""
    triangles = [row["triangles"] for row in rows]
    axes.loglog(triangles, [row["pbd_fps"] for row in rows], "C0o-", label="incise, PBD")
    axes.loglog(triangles, [row["pbd_cs_fps"] for row in rows], "C1o-", label="incise, PBD+CS")
    axes.loglog(triangles, [row["paper_pbd_fps"] for row in rows], "C0s:", label="paper, PBD")
    axes.loglog(triangles, [row["paper_pbd_cs_fps"] for row in rows], "C1s:", label="paper, PBD+CS")
    axes.set(xlabel="triangles", ylabel="frames per second")
    axes.legend()


def draw_times(axes: Axes, rows: list[incise.PaperRow]) -> None:
    """Draws times of a cut over the number of triangles."""
    triangles = [row["triangles"] for row in rows]
    axes.loglog(triangles, [row["cut_ms_mean"] for row in rows], "C2o-", label="incise")
    axes.loglog(triangles, [row["paper_cut_ms"] for row in rows], "C2s:", label="paper")
    axes.set(xlabel="triangles", ylabel="time of a cut [ms]")
    axes.legend()


def draw_accuracy(axes: Axes, mesh: incise.Mesh) -> None:
    """Draws the relative change of volume by cuts at the five levels."""
    directions = np.random.default_rng(1).normal(size=(20, 3))
    errors = []
    for level in LEVELS:
        lost = []
        for normal in directions:
            pieces = mesh.cut(normal, 0.0, level=level).pieces
            lost.append(abs(sum(piece.volume for piece in pieces) / mesh.volume - 1))
        errors.append(np.mean(lost))
    axes.semilogy(LEVELS, errors, "o-")
    axes.set(ylabel="mean relative change of volume by a cut")
    axes.tick_params(axis="x", rotation=20)


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("--seconds", type=float, default=15.0)
    parser.add_argument("--models", nargs="*", default=list(incise.MODELS))
    parser.add_argument("-o", "--output", default="table.png")
    arguments = parser.parse_args()
    rows = incise.paper_table(arguments.models, seconds=arguments.seconds)
    print_table(rows)
    figure, axes = plt.subplots(1, 3, figsize=(15, 4.5), layout="constrained")
    draw_rates(axes[0], rows)
    draw_times(axes[1], rows)
    draw_accuracy(axes[2], incise.model("Bunny"))
    figure.savefig(arguments.output, dpi=120)
    print(arguments.output)


if __name__ == "__main__":
    main()
