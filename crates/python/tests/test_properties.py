"""Properties of random cuts, and input that no one should pass."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

import incise

COORDINATE = st.floats(-1, 1, allow_nan=False, width=32)
NUMBER = st.floats(width=32, allow_nan=True, allow_infinity=True)
MODEL = incise.model("Sphere768")
SPHERE = incise.Mesh(MODEL.vertices, MODEL.faces)
STROKE = np.array([[[-2, 0, -2], [-2, 0, 2]], [[0.1, 0, -2], [0.1, 0, 2]]])


@settings(deadline=None, max_examples=60, derandomize=True)
@given(st.tuples(COORDINATE, COORDINATE, COORDINATE), st.floats(-0.6, 0.6), st.booleans())
def test_a_plane_leaves_closed_pieces_of_the_same_volume(
    normal: tuple[float, float, float], d: float, snaps: bool
) -> None:
    try:
        result = SPHERE.cut(normal, d, snap=0.1 if snaps else 0.0)
    except incise.CutError:
        assert np.linalg.norm(normal) < 1e-30
        return
    assert all(piece.is_closed for piece in result.pieces)
    volume = sum(piece.volume for piece in result.pieces)
    moved = result.report["moved_volume"]
    assert abs(volume - SPHERE.volume) <= moved + 1e-6
    length = np.linalg.norm(normal)
    if abs(d) > 0.5001 * length:
        assert result.is_miss
    if abs(d) < 0.4 * length:
        assert len(result.pieces) == 2


@settings(deadline=None, max_examples=40, derandomize=True)
@given(st.lists(st.lists(COORDINATE, min_size=3, max_size=3), min_size=4, max_size=12), st.data())
def test_any_faces_give_a_mesh_or_an_error(
    vertices: list[list[float]], data: st.DataObject
) -> None:
    index = st.integers(-1, len(vertices))
    faces = data.draw(st.lists(st.lists(index, min_size=3, max_size=3), min_size=1, max_size=10))
    try:
        mesh = incise.Mesh(vertices, faces)
    except incise.Error as error:
        assert "faces[" in str(error)
        return
    for call in (
        lambda: mesh.cut([0.3, 1, 0.2], 0.01),
        lambda: mesh.cut_path(STROKE),
        lambda: mesh.repair(),
        lambda: mesh.fill(),
        lambda: mesh.check(),
        lambda: incise.Scene().add_body(mesh),
        lambda: mesh.volume,
    ):
        try:
            call()
        except incise.Error as error:
            assert str(error)


@settings(deadline=None, max_examples=60, derandomize=True)
@given(st.tuples(NUMBER, NUMBER, NUMBER), NUMBER, NUMBER)
def test_any_numbers_of_a_cut_give_pieces_or_an_error(
    normal: tuple[float, float, float], d: float, snap: float
) -> None:
    try:
        result = SPHERE.cut(normal, d, snap=snap)
    except incise.Error as error:
        assert str(error)
    else:
        assert len(result.pieces) in (1, 2)


TRIANGLE = np.eye(3, dtype=np.float32)


@pytest.mark.parametrize(
    ("vertices", "faces", "text"),
    [
        ([[0, 0]], [[0, 1, 2]], r"vertices has shape \(1, 2\)"),
        ([0, 0, 0], [[0, 1, 2]], r"vertices has shape \(3,\)"),
        (TRIANGLE, [[0, 1]], r"faces has shape \(1, 2\)"),
        (TRIANGLE, [[0, 1, 3]], r"faces\[0\] has the index 3"),
        (TRIANGLE, [[0, 1, -1]], r"faces\[0\] has the index -1"),
        (TRIANGLE, np.array([[0, 1, 2**64 - 1]], dtype=np.uint64), r"faces\[0\]"),
        (TRIANGLE, [[0.0, 1.0, 2.0]], "faces has dtype float64"),
        (TRIANGLE, [["a", "b", "c"]], "faces has dtype"),
        (TRIANGLE, None, "faces has dtype object"),
        (TRIANGLE * np.nan, [[0, 1, 2]], r"vertices\[0\] is NaN"),
        (np.float64(1e39) * np.eye(3), [[0, 1, 2]], r"vertices\[0\] is NaN, infinite"),
        (TRIANGLE.astype(complex), [[0, 1, 2]], "vertices has dtype complex128"),
        (TRIANGLE.astype(object), [[0, 1, 2]], "vertices has dtype object"),
        ([[0, 0, 0], [1]], [[0, 1, 2]], "vertices is no array"),
    ],
)
def test_bad_arrays_are_named(vertices: Any, faces: Any, text: str) -> None:
    with pytest.raises(incise.Error, match=text):
        incise.Mesh(vertices, faces)


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"uv": np.zeros((2, 2))}, r"uv has shape \(2, 2\)"),
        ({"uv": np.full((3, 2), np.inf)}, r"uv\[0\] is NaN"),
        ({"attributes": {"heat": [1, 2]}}, r"attributes\['heat'\] has shape \(2,\)"),
        ({"attributes": {"heat": np.zeros((3, 17))}}, "rows of 17 values"),
        ({"attributes": {"skin": np.zeros((3, 3))}}, "skin weights"),
        ({"attributes": {3: [1, 2, 3]}}, "no text"),
    ],
)
def test_bad_attributes_are_named(keys: Any, text: str) -> None:
    with pytest.raises(incise.Error, match=text):
        incise.Mesh(TRIANGLE, [[0, 1, 2]], **keys)


@pytest.mark.parametrize(
    ("options", "kind", "text"),
    [
        ({"level": "finest"}, incise.Error, "level is 'finest'; it must be one of 2x-coarser"),
        ({"level": -1.0}, incise.Error, "level.z is -1; it must be a finite number above 0"),
        ({"level": True}, TypeError, "level"),
        ({"snap": 0.7}, incise.CutError, "snap is 0.7"),
        ({"snap": "much"}, TypeError, "snap is 'much'; it must be a number"),
        ({"grading": -1.0}, incise.Error, "grading is -1"),
        ({"caps": "some"}, incise.Error, "all-loops"),
        ({"max_triangles": 3}, incise.CutError, "more than 3 triangles"),
        ({"max_triangles": -3}, incise.Error, "max_triangles is -3"),
        ({"max_triangles": 1.5}, TypeError, "it must be a whole number"),
        ({"sharp": True}, TypeError, "no parameter 'sharp'; the names are snap"),
    ],
)
def test_bad_options_are_named(options: Any, kind: type[Exception], text: str) -> None:
    with pytest.raises(kind, match=text):
        SPHERE.cut([0, 1, 0.1], 0.01, **options)


def test_empty_meshes_are_meshes_of_nothing() -> None:
    empty = incise.Mesh(np.zeros((0, 3)), np.zeros((0, 3), dtype=int))
    assert (empty.volume, empty.area, empty.pieces) == (0.0, 0.0, [])
    assert empty.vertices.shape == empty.faces.shape == (0, 3)
    with pytest.raises(incise.Error, match="no faces"):
        empty.check()
