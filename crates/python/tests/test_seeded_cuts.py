"""The same bits as Rust: the cuts of `tests/seeded_cuts.txt`, which a Rust test verifies."""

from __future__ import annotations

import zlib
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import incise

LIST = Path(__file__).parents[3] / "tests" / "seeded_cuts.txt"


def crc_32(crc: int, vertices: Any, faces: Any) -> int:
    crc = zlib.crc32(vertices.astype("<f4").tobytes(), crc)
    return zlib.crc32(faces.astype("<u4").tobytes(), crc)


def cut(mesh: incise.Mesh, method: str, level: str, numbers: list[float]) -> str:
    x, y, z, d = numbers
    if method == "path":
        heights = [y, 0.5 * (y + d), d]
        poses = np.array([[[x, h, z - 1], [x, h, z + 1]] for h in heights], np.float32)
        result = mesh.cut_path(poses, level=level)
    else:
        result = mesh.cut([x, y, z], d, level=level)
    crc = 0
    for piece in result.pieces:
        crc = crc_32(crc, piece.vertices, piece.faces)
    return f"{len(result.pieces)} {crc:08x}"


def fall(mesh: incise.Mesh, numbers: list[float]) -> str:
    """Lets a body fall on a floor, and cuts it in frames 10 and 11."""
    x, y, z, d = numbers
    scene = incise.Scene(contacts=True, threads=1)
    scene.set_colliders([{"plane": {"point": [0, d, 0], "normal": [0, 1, 0]}}])
    body = scene.add_body(mesh)
    blade = scene.add_blade([[-x, y, -z], [-x, y, z]])
    for frame in range(90):
        if frame in (10, 11):
            end = 0.0 if frame == 10 else x
            scene.move_blade(blade, [[end, y, -z], [end, y, z]])
        scene.step()
    # Without the gaps that cuts leave between the vertices.
    used, faces = np.unique(scene.faces(body), return_inverse=True)
    crc = crc_32(0, scene.positions(body)[used], faces)
    return f"{len(scene.piece_numbers(body))} {crc:08x}"


def test_seeded_cuts_and_a_scene_have_the_bits_of_rust() -> None:
    lines = LIST.read_text().splitlines()
    assert len(lines) == 91
    for line in lines:
        name, method, level, *words = line.split(" ", 7)
        numbers, expected = [float(word) for word in words[:4]], words[4]
        # A mesh of plain arrays: bits do not depend on corner attributes.
        model = incise.model(name)
        mesh = incise.Mesh(model.vertices, model.faces)
        if expected == "refused":
            with pytest.raises(incise.CutError):
                cut(mesh, method, level, numbers)
        elif method == "scene":
            assert fall(mesh, numbers) == expected, line
        else:
            assert cut(mesh, method, level, numbers) == expected, line
