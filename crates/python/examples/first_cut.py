"""Cuts a mesh from nothing: a torus of formula, halved and written to files.

    python first_cut.py [FOLDER]
"""

from __future__ import annotations

import sys
from pathlib import Path

import numpy as np
import numpy.typing as npt

import incise

Indices = npt.NDArray[np.int64]


def torus(rings: int = 48, sides: int = 24) -> incise.Mesh:
    """Makes a torus around the z axis with the radii 1 m and 0.4 m."""
    u, v = np.meshgrid(np.arange(rings), np.arange(sides), indexing="ij")
    a, b = 2 * np.pi * u / rings, 2 * np.pi * v / sides
    out = 1 + 0.4 * np.cos(b)
    vertices = np.stack([out * np.cos(a), out * np.sin(a), 0.4 * np.sin(b)], axis=-1)

    def index(i: Indices, j: Indices) -> Indices:
        return (i % rings) * sides + j % sides

    corners = [index(u, v), index(u + 1, v), index(u + 1, v + 1), index(u, v + 1)]
    triangles = [np.stack([corners[k] for k in t], axis=-1) for t in ([0, 1, 2], [0, 2, 3])]
    faces = np.stack(triangles).reshape(-1, 3)
    return incise.Mesh(vertices.reshape(-1, 3), faces)


def main() -> None:
    folder = Path(sys.argv[1] if len(sys.argv) > 1 else ".")
    mesh = torus()
    result = mesh.cut(normal=[1.0, 0.3, 0.2], d=0.0, level="1.5x-finer")
    print(f"{len(mesh.faces)} faces, volume {mesh.volume:.4f} m^3")
    for i, (piece, mask) in enumerate(zip(result.pieces, result.cap_masks)):
        path = folder / f"half_{i}.ply"
        piece.save(path)
        faces = f"{len(piece.faces)} faces, {mask.sum()} of them in caps"
        print(f"{path}: {faces}, {piece.volume:.4f} m^3")


if __name__ == "__main__":
    main()
