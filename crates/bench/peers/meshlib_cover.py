"""Covers the sections that `incise-bench refine --rims DIR` wrote with MeshLib. See README.md."""

import argparse
import glob
import importlib.metadata
import json
import math
import os
import signal
import statistics
import sys
import time

# One thread: the library's pool has as many as the process may run on.
os.sched_setaffinity(0, {max(os.sched_getaffinity(0))})

from meshlib import mrmeshnumpy, mrmeshpy as mr  # noqa: E402


def read(path):
    """The comments of a file, its points and its loops; a loop ends with its first point."""
    notes, points, loops = {}, [], []
    for line in open(path, encoding="utf-8"):
        words = line.split()
        if words[0] == "#":
            notes[words[1]] = words[2:]
        elif words[0] == "v":
            points.append((float(words[1]), float(words[2])))
        elif words[0] == "l":
            loops.append([int(word) - 1 for word in words[1:]])
    return notes, points, loops


def contours(points, loops):
    result = mr.Contours2d()
    for corners in loops:
        contour = mr.std_vector_Vector2_double()
        for p in corners:
            contour.append(mr.Vector2d(*points[p]))
        result.append(contour)
    return result


def cover(section, length):
    """What is timed: the planar triangulation of all loops together, and its subdivision."""
    settings = mr.SubdivideSettings()
    settings.maxEdgeLen = length
    settings.maxEdgeSplits = 10_000_000
    # Rims stay as they are.
    settings.subdivideBorder = False
    begin = time.perf_counter()
    mesh = mr.PlanarTriangulation.triangulateContours(section)
    mr.subdivideMesh(mesh, settings)
    return mesh, 1e3 * (time.perf_counter() - begin)


def ends(section, length):
    """Whether a cover comes to an end within 5 s: some never do where a rim has edges longer than asked."""
    child = os.fork()
    if child == 0:
        signal.alarm(5)
        cover(section, length)
        os._exit(0)
    return os.waitpid(child, 0)[1] == 0


def percentile(ordered, percent):
    """The value that so many percent do not exceed."""
    return ordered[max(-(-len(ordered) * percent // 100), 1) - 1]


def quality(angles, edges):
    """Of the smallest angles of triangles [degrees], and of inner edges over the target."""
    angles, edges = sorted(angles), edges or [0.0]
    return {
        "triangles": len(angles),
        "smallest_angle": round(angles[0], 3),
        "angle_5": round(percentile(angles, 5), 3),
        "angle_median": round(percentile(angles, 50), 3),
        "edge_mean": round(statistics.fmean(edges), 4),
        "edge_longest": round(max(edges), 4),
    }


def judge(mesh, target):
    """The smallest angle of every triangle [degrees], inner edges over the target, the count of border edges."""
    points = mrmeshnumpy.getNumpyVerts(mesh).tolist()
    angles, sides = [], {}
    for corners in mrmeshnumpy.getNumpyFaces(mesh.topology).tolist():
        lengths = []
        for a, b in zip(corners, corners[1:] + corners[:1]):
            length = math.dist(points[a], points[b])
            lengths.append(length)
            sides.setdefault((min(a, b), max(a, b)), []).append(length)
        # The smallest angle lies across from the shortest side.
        c, a, b = sorted(lengths)
        cosine = (a * a + b * b - c * c) / (2 * a * b) if a > 0 else 1.0
        angles.append(math.degrees(math.acos(max(-1.0, min(1.0, cosine)))))
    edges = [side[0] / target for side in sides.values() if len(side) == 2]
    return angles, edges, sum(len(side) == 1 for side in sides.values())


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("rims", help="the folder of sections")
    parser.add_argument("result", help="the JSON file to write")
    parser.add_argument("--runs", type=int, default=15)
    parser.add_argument("--factor", type=float, default=1.2, help="maxEdgeLen, in mean targets")
    arguments = parser.parse_args()

    sections, inputs, targets, failed = [], [], [], []
    for path in sorted(glob.glob(os.path.join(arguments.rims, "*.obj"))):
        notes, points, loops = read(path)
        section, target = contours(points, loops), float(notes["target"][0])
        if not ends(section, arguments.factor * target):
            failed.append(os.path.basename(path))
            continue
        sections.append((notes, points, loops))
        inputs.append(section)
        targets.append(target)
    for name in failed:
        print(f"does not end: {name}", file=sys.stderr)
    times = [[] for _ in sections]
    # Runs of a section are apart, so that a slow minute of the machine is not all that one saw.
    for _ in range(arguments.runs):
        for section, target, runs in zip(inputs, targets, times):
            runs.append(cover(section, arguments.factor * target)[1])

    rows, models = [], {}
    for (notes, points, loops), section, target, runs in zip(sections, inputs, targets, times):
        angles, edges, border = judge(cover(section, arguments.factor * target)[0], target)
        model = notes["model"][0]
        pool = models.setdefault(model, ([], []))
        pool[0].extend(angles)
        pool[1].extend(edges)
        rows.append({
            "model": model,
            "planes": notes["planes"][0],
            "section": int(notes["section"][0]),
            "rims": notes["rims"][0],
            "points": len(points),
            "loops": len(loops),
            "ms": round(statistics.median_low(runs), 5),
            "ms_fastest": round(min(runs), 5),
            **quality(angles, edges),
            "rim_points_added": border - len(points),
        })
    counts = {model: sum(row["model"] == model for row in rows) for model in models}
    head = {
        "program": "MeshLib " + ".".join(importlib.metadata.version("meshlib").split(".")[:3]),
        "setting": f"triangulateContours, subdivideMesh with maxEdgeLen {arguments.factor} targets, border kept",
        "runs": arguments.runs,
        "keeps_rims": True,
        "does_not_end": failed,
        "models": [{"model": m, "sections": counts[m], **quality(*pool)} for m, pool in models.items()],
    }
    lines = ",\n".join("  " + json.dumps(row) for row in rows)
    with open(arguments.result, "w", encoding="utf-8") as out:
        out.write(json.dumps(head, indent=1)[:-2] + ',\n "sections": [\n' + lines + "\n ]\n}\n")


main()
