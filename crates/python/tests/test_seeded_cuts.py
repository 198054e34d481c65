"""The same bits as Rust: the cuts of `tests/seeded_cuts.txt`, which a Rust test verifies."""

from __future__ import annotations

import zlib
from pathlib import Path

import pytest

import incise

LIST = Path(__file__).parents[3] / "tests" / "seeded_cuts.txt"


def pieces_and_hash(result: incise.CutResult) -> str:
    crc = 0
    for piece in result.pieces:
        crc = zlib.crc32(piece.vertices.astype("<f4").tobytes(), crc)
        crc = zlib.crc32(piece.faces.astype("<u4").tobytes(), crc)
    return f"{len(result.pieces)} {crc:08x}"


def test_100_seeded_cuts_have_the_bits_of_rust() -> None:
    lines = LIST.read_text().splitlines()
    assert len(lines) == 100
    for line in lines:
        name, method, level, x, y, z, d, expected = line.split(" ", 7)
        # A mesh of plain arrays: bits do not depend on corner attributes.
        model = incise.model(name)
        mesh = incise.Mesh(model.vertices, model.faces)
        normal = [float(x), float(y), float(z)]
        if expected == "refused":
            with pytest.raises(incise.CutError):
                mesh.cut(normal, float(d), level=level, method=method)
            continue
        result = mesh.cut(normal, float(d), level=level, method=method)
        assert pieces_and_hash(result) == expected, line
