#!/usr/bin/env python3
"""Makes one self-contained HTML page of the rows that benches wrote.

    python3 report.py FILE_OR_FOLDER... -o DIR [--figures] [--gallery DIR]

Rows are JSON lines of `incise-bench ... --json FILE`; folders are searched for *.jsonl. The page is
DIR/report.html: a summary, a section per bench with tables by machine, and figures as SVG. With
--figures every figure is a file of its own too, as SVG and PNG. Needs matplotlib.
"""

from __future__ import annotations

import argparse
import base64
import io
import json
import re
import sys
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

try:
    import matplotlib
except ImportError:
    sys.exit("report.py draws with matplotlib: pip install matplotlib")

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure

plt.rcParams.update({"svg.fonttype": "none", "svg.hashsalt": "incise", "font.size": 9})

Row = dict[str, Any]

TITLES = {
    "table": "The seven models beside the paper's Table 1",
    "accuracy": "Accuracy: error against time of a frame",
    "cut": "Time of a cut",
    "refine": "Section meshes: time and quality",
    "refine_peers": "Section meshes beside other programs",
    "refine_tradeoff": "Section meshes: time against angles",
    "peers": "Section meshes of other programs",
    "step": "Time of a frame of the solver",
    "solver": "Projections of the solver",
    "stability": "Stability",
    "skip": "Cost of unused features",
}
HEADER = ("bench", "name", "backend", "device", "machine", "commit", "version")
# Kinds of rows with figures instead of tables, or too many for a page.
UNLISTED = {"run", "cell", "section", "rank"}
# Rows of a table that is not folded.
SHORT = 16

# Schemes of the accuracy bench as plots name them.
SCHEMES = {
    "xpbd": "XPBD",
    "paper": "the paper's (PBD, one substep)",
    "pbd": "PBD",
    "xpbd-half": "XPBD, diagonal scale 0.5",
    "xpbd-half-bdf2": "the same, second order",
    "patches": "rigid patches",
}
# Scheme, substeps and iterations of the solver's defaults.
DEFAULTS = ("xpbd-half", 12, 1)
TARGETS = (1e-1, 1e-2, 1e-3, 1e-4)
BUDGETS = (1, 4, 8, 16)


@dataclass
class Source:
    """The rows of one bench on one machine in one file."""

    path: Path
    rows: list[Row]

    @property
    def bench(self) -> str:
        return self.rows[0]["bench"]

    @property
    def machine(self) -> str:
        return machine(self.rows[0])

    @property
    def title(self) -> str:
        return ", ".join(filter(None, (settings(self), self.path.name, commits(self.rows))))


def machine(row: Row) -> str:
    return row.get("machine") or row.get("device") or "not recorded"


def commits(rows: list[Row]) -> str:
    names = dict.fromkeys(row["commit"] for row in rows if row.get("commit"))
    return "commit " + ", ".join(names) if names else ""


def read(path: Path) -> list[Source]:
    """Returns the rows of a file by bench and machine.

    Raises ValueError for a line that is not a row.
    """
    sources: dict[tuple[str, str], Source] = {}
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            row = json.loads(line)
            key = (row["bench"], machine(row))
            row["name"]
        except (ValueError, KeyError, TypeError) as error:
            raise ValueError(f"{path}:{number}: not a row of a bench: {error!r}") from error
        sources.setdefault(key, Source(path, [])).rows.append(row)
    return list(sources.values())


# Values and words


def flat(row: Row, prefix: str = "") -> Row:
    """Returns the fields that a table shows: groups by their path, lists by their length."""
    out: Row = {}
    for name, value in row.items():
        if isinstance(value, dict):
            out.update(flat(value, f"{prefix}{name}_"))
        elif not isinstance(value, list):
            out[prefix + name] = value
        elif not any(isinstance(x, (int, float)) for x in value):
            out[prefix + name] = len(value)
    return out


def text(value: Any) -> str:
    if value is None:
        return "-"
    if isinstance(value, bool):
        return "yes" if value else "no"
    if not isinstance(value, float):
        return str(value)
    size = abs(value)
    if value == int(value) and size < 1e15:
        return str(int(value))
    if not 1e-3 <= size < 1e6:
        return f"{value:.3e}"
    return f"{value:.1f}" if size >= 100 else f"{value:.3f}" if size >= 1 else f"{value:.4f}"


def ratio(value: float | None) -> str:
    return "-" if value is None else f"{value:.1f}" if value < 10 else f"{value:.0f}"


def is_bad(row: Row) -> bool:
    lists = (row.get(name) for name in ("failures", "cuts_refused"))
    return row.get("passed") is False or bool(row.get("refusal")) or any(lists)


def of_kind(rows: Iterable[Row], kind: str) -> list[Row]:
    return [row for row in rows if row.get("kind") == kind]


def settings(source: Source) -> str:
    """Returns the settings of a file in words: two of the same are the same measurement."""
    row = source.rows[0]
    backend = {"cpu": "CPU", "gpu": "GPU"}.get(row.get("backend", ""), row.get("backend", ""))
    if source.bench == "table":
        models = "built-in models" if row["source"] == "built-in" else "model files"
        more = [name for name in ("volume", "interior_springs", "contacts") if row.get(name)]
        return ", ".join([f"{row['method']} method on the {backend}", models, *more])
    if source.bench == "cut":
        kind = "progressive cuts" if row["kind"] == "progressive" else "cuts"
        return f"{kind}, {row['method']} method"
    return backend if source.bench in ("stability", "step", "skip") else ""


# Work-precision fronts


def scheme(row: Row) -> str:
    return "paper" if row["scheme"] == "pbd" and row["substeps"] == 1 else row["scheme"]


def points(rows: Iterable[Row], error: str) -> list[tuple[float, float, str]]:
    """Returns time [ms], position error and name of every run that has both."""
    found = []
    for row in rows:
        errors, ms = row.get(error) or {}, row.get("ms_per_frame")
        if ms and errors.get("position"):
            run = f"{row['substeps']}x{row['iterations']}"
            found.append((ms, errors["position"], run))
    return found


def front(runs: Iterable[tuple]) -> list[tuple]:
    """Returns the runs that no other beats in both time and error, by time."""
    best: list[tuple] = []
    for run in sorted(runs):
        if not best or run[1] < best[-1][1]:
            best.append(run)
    return best


def error_at(runs: list[tuple], budget: float) -> float | None:
    return min((run[1] for run in runs if run[0] <= budget), default=None)


def ranks(rows: list[Row]) -> list[Row]:
    """Returns times to errors, and errors within times, of sets of solvers, scene by scene."""
    table = []
    sets: dict[str, Callable[[Row], bool]] = {
        "sweeps": lambda row: row["scheme"].startswith("xpbd"),
        "paper": lambda row: scheme(row) == "paper",
    }
    for name, backend in dict.fromkeys((row["name"], row["backend"]) for row in rows):
        of = [row for row in rows if (row["name"], row["backend"]) == (name, backend)]
        fronts = {key: front(points(filter(has, of), "total")) for key, has in sets.items()}
        for key, runs in fronts.items():
            rank: Row = {"name": f"{name}, {backend}", "solvers": key}
            for target in TARGETS:
                fastest = next((run for run in runs if run[1] <= target), None)
                rank[f"ms to {target:.0e}"] = fastest and f"{fastest[0]:.3g} ({fastest[2]})"
            for budget in BUDGETS:
                rank[f"error at {budget} ms"] = error_at(runs, budget)
            default = [row for row in of if DEFAULTS == tuple(row[k] for k in RUN)]
            default = points(default, "total") if key == "sweeps" else []
            rank["default ms"], rank["default error"] = default[0][:2] if default else (None, None)
            best = error_at(runs, default[0][0]) if default else None
            rank["default over front"] = default[0][1] / best if best else None
            rank["gain over paper"] = gain(runs, fronts["paper"]) if key == "sweeps" else None
            table.append(rank)
    return table


RUN = ("scheme", "substeps", "iterations")


def gain(ours: list[tuple], theirs: list[tuple]) -> float | None:
    """Returns the smallest ratio of their error to ours in the same time."""
    both = [(error_at(ours, ms), error_at(theirs, ms)) for ms in BUDGETS]
    return min((b / a for a, b in both if a and b), default=None)


# Figures


def axes_over_triangles(y: str) -> tuple[Figure, Any]:
    figure, axes = plt.subplots(figsize=(9, 4.8), layout="constrained")
    axes.set(xscale="log", yscale="log", xlabel="triangles", ylabel=y)
    axes.grid(which="major", alpha=0.3)
    return figure, axes


def plot_by_name(axes: Any, lines: dict[str, list[tuple[float, float]]]) -> None:
    for name, of in lines.items():
        of = sorted(point for point in of if all(point))
        axes.plot(*zip(*of), ".-", label=name) if of else None
    axes.legend(fontsize=7)


def table_figures(sources: list[Source]) -> Iterable[tuple[str, Figure]]:
    for field, other, y in (
        ("pbd_cs_fps", "pbd_cs_fps", "frames per second with cuts (PBD+CS)"),
        ("cut_ms_mean", "cut_ms", "time of a cut [ms]"),
    ):
        figure, axes = axes_over_triangles(y)
        lines = {s.title: [(r["triangles"], r[field]) for r in s.rows] for s in sources}
        rows = sources[0].rows
        lines["the paper"] = [(r["triangles"], r["paper"][other]) for r in rows]
        plot_by_name(axes, lines)
        yield f"{y} beside the paper's", figure
    for source in sources:
        if not any(row.get("pbd_fps_by_second") for row in source.rows):
            continue
        figure, grid = plt.subplots(1, 2, figsize=(9, 4), layout="constrained", sharey=True)
        for axes, half in zip(grid, ("pbd", "pbd_cs")):
            for row in source.rows:
                rates = row.get(f"{half}_fps_by_second") or []
                axes.semilogy(range(1, len(rates) + 1), rates, ".-", label=row["name"])
            axes.set(title=half.replace("pbd_cs", "PBD+CS").replace("pbd", "PBD"))
            axes.set(xlabel="simulated time [s]", ylabel="frames per second")
        grid[0].legend(fontsize=7)
        yield f"Figure 11: {source.title}", figure


def accuracy_figures(sources: list[Source]) -> Iterable[tuple[str, Figure]]:
    for source in sources:
        runs = of_kind(source.rows, "run")
        for key in dict.fromkeys((row["name"], row["backend"]) for row in runs):
            of = [row for row in runs if (row["name"], row["backend"]) == key]
            figure, grid = plt.subplots(1, 2, figsize=(10, 4.6))
            for axes, error in zip(grid, ("total", "solver")):
                for i, (name, label) in enumerate(SCHEMES.items()):
                    some = points((row for row in of if scheme(row) == name), error)
                    if some:
                        best = front(some)
                        x, y = zip(*(run[:2] for run in some))
                        axes.plot(x, y, ".", color=f"C{i}", alpha=0.4, markersize=3)
                        axes.plot(*zip(*(run[:2] for run in best)), color=f"C{i}", label=label)
                        for ms, position, run in best:
                            axes.annotate(run, (ms, position), fontsize=5, color=f"C{i}")
                axes.set(xscale="log", yscale="log", xlabel="ms per frame")
                axes.set(ylabel=f"{error} error of positions [mean edges]")
            floors = {row["substeps"]: row.get("floor_position") for row in of}
            for n in (n for n in (1, 2, 4, 8) if floors.get(n)):
                grid[0].axhline(floors[n], color="gray", linewidth=0.5)
                where = (1, floors[n])
                label = f"converged, {n} step{'s' * (n > 1)}"
                to = grid[0].get_yaxis_transform()
                grid[0].annotate(label, where, xycoords=to, ha="right", fontsize=6)
            grid[0].legend(fontsize=6, loc="lower left")
            figure.subplots_adjust(left=0.07, right=0.99, bottom=0.1, top=0.98)
            yield f"{', '.join(key)}: {source.title}", figure


def cut_figures(sources: list[Source]) -> Iterable[tuple[str, Figure]]:
    stages = {
        "all": ("total",),
        "detection and split": ("detect", "split"),
        "caps": ("cap", "refine"),
        "separation": ("separate",),
        "commit, BVH, constraints": ("commit", "bvh_update", "constraints"),
    }
    for source in sources:
        rows = [row for row in of_kind(source.rows, "cut") if row["planes"] == "middle"]
        if rows:
            figure, axes = axes_over_triangles("median [ms]")
            lines = {
                name: [(r["triangles"], sum(r["ms_median"][s] for s in of)) for r in rows]
                for name, of in stages.items()
            }
            plot_by_name(axes, lines)
            said = f"A cut through the middle, stage by stage: {source.title}"
            yield ". ".join([said, *growth(rows)]), figure


def growth(rows: list[Row]) -> Iterable[str]:
    """Says how detection and split grow with the number of triangles, for every family."""
    for family in dict.fromkeys(row.get("family") for row in rows if row.get("family")):
        of = [row for row in rows if row.get("family") == family]
        x = np.log([row["triangles"] for row in of])
        y = np.log([row["ms_median"]["detect"] + row["ms_median"]["split"] for row in of])
        if len(of) >= 3:
            power = np.polyfit(x, y, 1)[0]
            yield f"{family}: detect and split grow as n to the power of {power:.2f}"


def step_figures(sources: list[Source]) -> Iterable[tuple[str, Figure]]:
    figure, axes = axes_over_triangles("ms per frame")
    lines: dict[str, list[tuple[float, float]]] = {}
    for row in (row for source in sources for row in source.rows if row.get("ms_per_frame")):
        name = f"{row['device']}, {row['schedule']}"
        lines.setdefault(name, []).append((row["triangles"], row["ms_per_frame"]))
    plot_by_name(axes, lines)
    yield "A frame of the solver over the number of triangles", figure


def stability_figures(sources: list[Source]) -> Iterable[tuple[str, Figure]]:
    for source in sources:
        cells = [map_cell(row) for row in of_kind(source.rows, "cell")]
        for backend in dict.fromkeys(cell["backend"] for cell in cells):
            of = [cell for cell in cells if cell["backend"] == backend]
            yield f"Stability map, {backend}: {source.title}", stability_map(of)


def map_cell(row: Row) -> Row:
    """Returns a run of the map with its load, time step and compliance as numbers."""
    found = re.match(r"1/([\d.]+) s, 1e(-?\d+) m/N, load ([\d.e+-]+)", row.get("at", ""))
    if not found:
        return row
    steps, compliance, load = found.groups()
    rate = round(2 * float(np.log10(float(steps))))
    return {**row, "rate": rate, "compliance": int(compliance), "ratio": float(load)}


def stability_map(cells: list[Row]) -> Figure:
    """Draws the largest energy over time steps and compliances, a panel per load."""
    loads = sorted({cell["ratio"] for cell in cells})
    figure, grid = plt.subplots(1, len(loads), figsize=(14, 5.6), layout="constrained")
    figure.suptitle("largest energy of a swinging ribbon, relative to the start; red: above bound")
    for axes, load in zip([grid] if len(loads) == 1 else grid, loads):
        for cell in (cell for cell in cells if cell["ratio"] == load):
            energy, x, y = cell["energy"], cell["compliance"], cell["rate"] / 2
            is_within = energy is not None and energy <= cell["bound"]
            color = plt.cm.Blues(0.1 + 0.6 * min(energy, 1)) if is_within else "#c83c1e"
            axes.add_patch(plt.Rectangle((x - 0.48, y - 0.24), 0.96, 0.48, color=color))
            few = energy is not None and energy < 10
            label = f"{energy:.2f}" if few else "inf" if energy is None else f"{energy:.0e}"
            axes.text(x, y, label, ha="center", va="center", fontsize=4)
        axes.set(title=f"load of {load:.0e} vertices", xlabel="log10 of the compliance [m/N]")
        axes.set(ylabel="log10 of the steps a second")
        axes.autoscale_view()
    return figure


def tradeoff_figures(sources: list[Source]) -> Iterable[tuple[str, Figure]]:
    for source in sources:
        figure, axes = plt.subplots(figsize=(9, 4.8), layout="constrained")
        for name, z in dict.fromkeys((row["name"], row["z"]) for row in source.rows):
            of = [row for row in source.rows if (row["name"], row["z"]) == (name, z)]
            x, y = zip(*((row["ms_a_thousand_triangles"], row["angle_5"]) for row in of))
            axes.plot(x, y, ".-", label=f"{name}, z {z:g}")
        axes.set(xlabel="ms per thousand triangles", ylabel="5th percentile of angles [degrees]")
        axes.legend(fontsize=6)
        yield f"Time against angles: {source.title}", figure


FIGURES: dict[str, Callable[[list[Source]], Iterable[tuple[str, Figure]]]] = {
    "table": table_figures,
    "accuracy": accuracy_figures,
    "cut": cut_figures,
    "step": step_figures,
    "stability": stability_figures,
    "refine_tradeoff": tradeoff_figures,
}


# Page


def table(rows: list[Row], caption: str, columns: list[str] | None = None) -> str:
    """Returns a table of rows; fields of the same value in all rows are in its caption."""
    cells = [flat(row) for row in rows]
    names = list(dict.fromkeys(name for row in cells for name in row))
    first = cells[0]
    same = [n for n in names if all(row.get(n) == first.get(n) for row in cells)]
    if columns is None:
        columns = ["name", *(n for n in names if n not in same and n not in HEADER)]
        words = [f"{n} {text(first.get(n))}" for n in same if n not in HEADER]
        caption = ". ".join(filter(None, (caption, ", ".join(words))))
    is_text = {n for n in columns if any(isinstance(row.get(n), str) for row in cells)}
    kind = {n: ' class="text"' if n in is_text else "" for n in columns}
    out = [f"<table><caption>{escape(caption)}</caption><thead><tr>"]
    heading = {n: escape(n).replace("_", "_<wbr>") for n in columns}
    out += [f"<th{kind[n]}>{heading[n]}</th>" for n in columns]
    out.append("</tr></thead><tbody>")
    for row, of in zip(rows, cells):
        out.append('<tr class="bad">' if is_bad(row) else "<tr>")
        out += [f"<td{kind[n]}>{escape(text(of.get(n)))}</td>" for n in columns]
        out.append("</tr>")
    return "".join(out) + "</tbody></table>\n"


def tables(source: Source) -> str:
    """Returns the tables of a file, one per kind of rows; long ones show marked rows and fold."""
    out = []
    for kind in dict.fromkeys(row.get("kind") for row in source.rows):
        rows = [row for row in source.rows if row.get("kind") == kind]
        title = ", ".join(filter(None, (kind, source.title)))
        if kind == "run":
            names = ranks(rows)
            out.append(table(names, f"Times to errors, {source.title}", list(names[0])))
        if kind in UNLISTED:
            out.append(f"<p>{len(rows)} rows of kind {kind} in {escape(source.path.name)}</p>")
        elif len(rows) <= SHORT:
            out.append(table(rows, title))
        else:
            bad = [row for row in rows if is_bad(row)]
            out.append(table(bad, f"Marked rows: {title}") if bad else "")
            out.append(f"<details><summary>All {len(rows)} rows: {escape(title)}</summary>")
            out.append(table(rows, title) + "</details>\n")
    return "".join(out)


def summary(source: Source) -> str | None:
    """Returns the main result of a file."""
    rows, bench = source.rows, source.bench

    def span(values: Iterable[float | None]) -> str:
        known = [value for value in values if value is not None]
        return f"{ratio(min(known, default=None))} to {ratio(max(known, default=None))}"

    if bench == "table":
        rates, cuts = ([row["gain"][key] for row in rows] for key in ("pbd_cs_fps", "cut_ms"))
        rates, cuts = span(rates), span(cuts)
        said = f"{rates} times the paper's frame rate with cuts, cuts {cuts} times as fast"
        return f"{settings(source)}: {said}"
    if bench == "accuracy" and of_kind(rows, "run"):
        gains = [r for r in ranks(of_kind(rows, "run")) if r["gain over paper"]]
        gains = [f"{r['name']} {ratio(r['gain over paper'])}" for r in gains]
        at = "gain in error over the paper's scheme at equal time, 1 to 16 ms"
        return f"{at}: {'; '.join(gains)}"
    if bench == "cut" and of_kind(rows, "cut"):
        row = max(of_kind(rows, "cut"), key=lambda row: row["triangles"])
        return f"{row['ms_median']['total']:.1f} ms for a cut of {row['triangles']} triangles"
    if bench == "step":
        timed = [row for row in rows if row.get("ms_per_frame")]
        row = max(timed, key=lambda row: row["triangles"], default=None)
        return row and f"{row['ms_per_frame']:.1f} ms for a frame of {row['name']}"
    if bench == "refine":
        failed = sum(len(row["failures"]) for row in rows)
        return f"{failed} of {sum(row['meshes'] for row in rows) + failed} sections fail"
    judged = [row["passed"] for row in rows if "passed" in row]
    return f"{judged.count(False)} of {len(judged)} fail" if judged else None


def svg(figure: Figure) -> str:
    file = io.StringIO()
    figure.savefig(file, format="svg", metadata={"Date": None})
    return file.getvalue()[file.getvalue().index("<svg") :]


def gallery(folder: Path) -> str:
    """Returns the figures of a folder that `incise gallery` made."""
    index = json.loads((folder / "index.json").read_text(encoding="utf-8"))
    out = [f"<p>Drawn by {escape(index['device'])}.</p>"]
    for figure in index["figures"]:
        if Path(figure["file"]).name != figure["file"]:
            raise ValueError(f"{folder}: names '{figure['file']}', which is not a file's name")
        data = base64.b64encode((folder / figure["file"]).read_bytes()).decode()
        caption = escape(f"{figure['name']}: {figure['caption']}")
        out.append(f'<figure><img alt="{escape(figure["name"])}" src="data:image/png;base64,')
        out.append(f'{data}"><figcaption>{caption}</figcaption></figure>\n')
    return "".join(out)


STYLE = """
body { margin: 0 auto; max-width: 1120px; padding: 24px 32px; color: #1b2026; background: #fff;
  font: 15px/1.45 system-ui, "DejaVu Sans", Arial, sans-serif; }
h2 { margin: 40px 0 8px; padding-top: 12px; border-top: 2px solid #d5dbe3; }
.wide { overflow-x: auto; }
table { border-collapse: collapse; margin: 10px 0 18px; font-size: 12px;
  font-variant-numeric: tabular-nums; }
caption, figcaption { text-align: left; color: #4a5461; font-size: 13px; }
th, td { padding: 3px 6px; text-align: right; border-bottom: 1px solid #dde2e8;
  vertical-align: top; }
th { background: #e4ebf5; }
.text { text-align: left; }
tr.bad td { background: #fdecea; }
summary, a { color: #14509e; }
figure { margin: 0 0 12px; }
figure svg, figure img { display: block; width: 100%; height: auto; }
"""


def page(sources: list[Source], folder: Path, has_files: bool, images: Path | None) -> str:
    """Returns the page, and writes figures as files if asked to."""
    benches = [name for name in TITLES if any(s.bench == name for s in sources)]
    benches += sorted({s.bench for s in sources} - set(benches))
    body, links = [], []
    if images:
        body.append(f'<h2 id="gallery">The paper\'s figures</h2>{gallery(images)}')
    for bench in benches:
        title = escape(TITLES.get(bench, bench))
        body.append(f'<h2 id="{escape(bench)}">{title}</h2>\n')
        of_bench = [source for source in sources if source.bench == bench]
        for name in dict.fromkeys(source.machine for source in of_bench):
            some = [source for source in of_bench if source.machine == name]
            results = "; ".join(dict.fromkeys(filter(None, map(summary, some))))
            said = escape(f": {results} ({name})" if results else f" ({name})")
            links.append(f'<li><a href="#{escape(bench)}">{title}</a>{said}</li>\n')
            body.append(f"<h3>{escape(name)}</h3>\n")
            for i, (caption, figure) in enumerate(FIGURES.get(bench, lambda _: ())(some)):
                if has_files:
                    said = f"{bench} {caption.split(':')[0]} {name} {i}".lower()
                    stem = re.sub("[^a-z0-9]+", "-", said)
                    for extension in ("svg", "png"):
                        figure.savefig(folder / f"{stem}.{extension}", dpi=110)
                drawn, said = svg(figure), escape(caption)
                body.append(f"<figure>{drawn}<figcaption>{said}</figcaption></figure>\n")
                plt.close(figure)
            body += [f'<div class="wide">{tables(source)}</div>' for source in some]
    files = "".join(f"<li>{escape(str(s.path))}: {len(s.rows)} rows</li>" for s in sources)
    head = f'<meta charset="utf-8"><title>incise: results</title><style>{STYLE}</style>'
    body = [f"<h1>incise: results</h1>\n<ul>{''.join(links)}</ul>\n", *body]
    body.append(f"<h2>Sources</h2><ul>{files}</ul>")
    html = f'<html lang="en"><head>{head}</head><body>{"".join(body)}</body></html>'
    return f"<!DOCTYPE html>\n{html}\n"


def main() -> int:
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("results", nargs="+", type=Path, help="files of rows, or folders of them")
    parser.add_argument("-o", "--output", type=Path, required=True, metavar="DIR")
    parser.add_argument("--figures", action="store_true", help="write figures as files too")
    parser.add_argument("--gallery", type=Path, metavar="DIR", help="made by `incise gallery`")
    arguments = parser.parse_args()
    paths = [
        path
        for given in arguments.results
        for path in (sorted(given.rglob("*.jsonl")) if given.is_dir() else [given])
    ]
    try:
        sources = [source for path in paths for source in read(path)]
        if not sources:
            raise ValueError("no rows: name files that --json wrote, or folders of *.jsonl")
        arguments.output.mkdir(parents=True, exist_ok=True)
        html = page(sources, arguments.output, arguments.figures, arguments.gallery)
        (arguments.output / "report.html").write_text(html, encoding="utf-8")
    except (OSError, ValueError) as error:
        print(f"report.py: {error}", file=sys.stderr)
        return 1
    print(arguments.output / "report.html")
    return 0


if __name__ == "__main__":
    sys.exit(main())
