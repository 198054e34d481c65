"""Compares the time of a cut from numpy arrays to numpy arrays with other libraries.

    python compare.py [MESH] [--repeat 50]

Without a mesh it cuts a sphere of about 1,500 triangles. Each library gets float32 vertices and
integer faces, cuts by planes through the middle, caps both halves and returns their vertices and
faces as arrays. Building its own mesh is part of the time. Only incise refines the caps to the
resolution of the surface. Missing libraries are left out: `pip install trimesh scipy shapely
mapbox_earcut manifold3d meshlib`. The Rust time of the same cuts:
`cargo run --release -p incise-bench --example time_cuts -- MESH`.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import numpy.typing as npt

import incise

Vertices = npt.NDArray[np.float32]
Faces = npt.NDArray[np.uint32]
Halves = list[tuple[npt.NDArray[Any], npt.NDArray[Any]]]
Cut = Callable[[Vertices, Faces, npt.NDArray[np.float64], float], Halves]


def sphere(rings: int = 28, sides: int = 28) -> tuple[Vertices, Faces]:
    """Makes a sphere of radius 0.5 m with poles."""
    theta = np.pi * np.arange(1, rings) / rings
    phi = 2 * np.pi * np.arange(sides) / sides
    t, p = np.meshgrid(theta, phi, indexing="ij")
    ring = np.stack([np.sin(t) * np.cos(p), np.sin(t) * np.sin(p), np.cos(t)], axis=-1)
    poles = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])
    vertices = 0.5 * np.concatenate([ring.reshape(-1, 3), poles])
    faces = []
    north, south = (rings - 1) * sides, (rings - 1) * sides + 1
    for j in range(sides):
        k = (j + 1) % sides
        faces.append((north, j, k))
        faces.append((south, (rings - 2) * sides + k, (rings - 2) * sides + j))
        for i in range(rings - 2):
            a, b, c, d = i * sides + j, (i + 1) * sides + j, (i + 1) * sides + k, i * sides + k
            faces += [(a, b, c), (a, c, d)]
    return vertices.astype(np.float32), np.array(faces, dtype=np.uint32)


def by_incise(
    vertices: Vertices, faces: Faces, normal: npt.NDArray[np.float64], d: float
) -> Halves:
    pieces = incise.Mesh(vertices, faces).cut(normal, d).pieces
    return [(piece.vertices, piece.faces) for piece in pieces]


def by_trimesh() -> Cut:
    import trimesh

    def cut(vertices: Vertices, faces: Faces, normal: npt.NDArray[np.float64], d: float) -> Halves:
        mesh = trimesh.Trimesh(vertices, faces, process=False)
        halves = [mesh.slice_plane(d * normal, s * normal, cap=True) for s in (1.0, -1.0)]
        return [(half.vertices, half.faces) for half in halves]

    return cut


def by_manifold() -> Cut:
    import manifold3d

    def cut(vertices: Vertices, faces: Faces, normal: npt.NDArray[np.float64], d: float) -> Halves:
        body = manifold3d.Manifold(manifold3d.Mesh(vert_properties=vertices, tri_verts=faces))
        halves = [half.to_mesh() for half in body.split_by_plane(normal.tolist(), d)]
        return [(half.vert_properties, half.tri_verts) for half in halves]

    return cut


def by_meshlib() -> Cut:
    import meshlib.mrmeshnumpy as mrn
    import meshlib.mrmeshpy as mr

    def half(mesh: Any, normal: npt.NDArray[np.float64], d: float) -> Any:
        plane = mr.Plane3f(mr.Vector3f(*map(float, normal)), float(d))
        parameters = mr.TrimWithPlaneParams()
        parameters.plane = plane
        mr.trimWithPlane(mesh, parameters)
        for edge in mesh.topology.findHoleRepresentiveEdges():
            fill = mr.FillHoleParams()
            fill.metric = mr.getPlaneNormalizedFillMetric(mesh, edge)
            mr.fillHole(mesh, edge, fill)
        return mrn.getNumpyVerts(mesh), mrn.getNumpyFaces(mesh.topology)

    def cut(vertices: Vertices, faces: Faces, normal: npt.NDArray[np.float64], d: float) -> Halves:
        mesh = mrn.meshFromFacesVerts(faces.astype(np.int32), vertices)
        return [half(mr.Mesh(mesh), s * normal, s * d) for s in (1.0, -1.0)]

    return cut


def normals(count: int) -> npt.NDArray[np.float64]:
    """Returns directions all around (a Fibonacci sphere), those of the Rust example time_cuts."""
    k = np.arange(count)
    z = 1 - (2 * k + 1) / count
    angle = k * np.pi * (3 - np.sqrt(5))
    radius = np.sqrt(1 - z * z)
    return np.stack([radius * np.cos(angle), radius * np.sin(angle), z], axis=1)


def volume(half: tuple[npt.NDArray[Any], npt.NDArray[Any]]) -> float:
    """Returns the volume of a closed half."""
    corners = half[0][half[1]].astype(np.float64)
    return float(np.linalg.det(corners).sum() / 6)


def measure(cut: Cut, vertices: Vertices, faces: Faces, planes: Any) -> tuple[float, float, float]:
    """Returns the median and the smallest time [s], and the largest relative change of volume."""
    whole = volume((vertices, faces))
    times, worst = [], 0.0
    for normal, d in planes:
        begin = time.perf_counter()
        halves = cut(vertices, faces, normal, d)
        times.append(time.perf_counter() - begin)
        worst = max(worst, abs(sum(map(volume, halves)) / whole - 1))
    return float(np.median(times)), min(times), worst


def main() -> None:
    parser = argparse.ArgumentParser()
    parser.add_argument("mesh", nargs="?")
    parser.add_argument("--repeat", type=int, default=50)
    arguments = parser.parse_args()
    if arguments.mesh:
        mesh = incise.Mesh.load(arguments.mesh)
        vertices, faces = mesh.vertices.copy(), mesh.faces.copy()
    else:
        vertices, faces = sphere()
    print(f"{len(vertices)} vertices, {len(faces)} faces, {arguments.repeat} planes")
    center = (vertices.min(axis=0) + vertices.max(axis=0)).astype(np.float64) / 2
    planes = [(normal, float(normal @ center)) for normal in normals(arguments.repeat)]
    makers: dict[str, Callable[[], Cut]] = {
        "incise": lambda: by_incise,
        "trimesh": by_trimesh,
        "manifold3d": by_manifold,
        "meshlib": by_meshlib,
    }
    print("library      median ms   fastest ms   largest change of volume")
    for name, maker in makers.items():
        try:
            cut = maker()
            # The first cut also imports what it needs.
            measure(cut, vertices, faces, planes[:3])
        except ImportError as error:
            print(f"{name:12} not installed: {error}")
            continue
        median, fastest, worst = measure(cut, vertices, faces, planes)
        print(f"{name:12} {median * 1e3:9.3f} {fastest * 1e3:12.3f} {worst:18.1e}")


if __name__ == "__main__":
    main()
