"""Exchange with trimesh, and volumes and areas beside its."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import incise

trimesh = pytest.importorskip("trimesh")


def test_a_mesh_comes_back(bunny: incise.Mesh) -> None:
    heat = np.arange(len(bunny.vertices), dtype=np.float32)
    mesh = incise.Mesh(
        bunny.vertices, bunny.faces, uv=bunny.vertices[:, :2], attributes={"heat": heat}
    )
    other = mesh.to_trimesh()
    assert other.is_watertight and other.is_winding_consistent
    again = incise.Mesh.from_trimesh(other)
    np.testing.assert_array_equal(again.vertices, mesh.vertices)
    np.testing.assert_array_equal(again.faces, mesh.faces)
    np.testing.assert_array_equal(again.attributes["heat"], heat)
    assert again.uv is not None and mesh.uv is not None
    np.testing.assert_array_equal(again.uv, mesh.uv)


@pytest.mark.parametrize("extension", ["obj", "ply", "stl", "glb"])
def test_trimesh_reads_written_files(
    tmp_path: Path, bunny: incise.Mesh, extension: str
) -> None:
    for i, piece in enumerate(bunny.cut([0.2, 1, 0.1], 0.03).pieces):
        path = tmp_path / f"piece_{i}.{extension}"
        piece.save(path)
        other = trimesh.load(path, force="mesh")
        # Buffers for renderers have a vertex for each side of a crease.
        other.merge_vertices(merge_tex=True, merge_norm=True)
        assert len(other.faces) == len(piece.faces)
        assert other.is_watertight and other.is_winding_consistent
        assert other.volume == pytest.approx(piece.volume, rel=1e-5)


def test_measures_are_those_of_trimesh(bunny: incise.Mesh) -> None:
    for piece in [bunny, *bunny.cut([0.2, 1, 0.1], 0.03).pieces]:
        other = piece.to_trimesh()
        assert other.is_watertight and other.is_winding_consistent
        assert other.volume == pytest.approx(piece.volume, rel=1e-9)
        assert other.area == pytest.approx(piece.area, rel=1e-9)
        assert other.euler_number == 2


def test_primitives_of_trimesh_are_cut_in_halves() -> None:
    for body in (trimesh.creation.box(), trimesh.creation.icosphere(subdivisions=3)):
        mesh = incise.Mesh.from_trimesh(body)
        result = mesh.cut([1, 0.1, 0.05], 0.0, snap=0.0)
        volumes = [piece.volume for piece in result.pieces]
        assert volumes == pytest.approx([body.volume / 2] * 2, rel=1e-4)


def test_texture_coordinates_of_a_visual_are_taken() -> None:
    body = trimesh.creation.box()
    uv = body.vertices[:, :2]
    body.visual = trimesh.visual.TextureVisuals(uv=uv)
    mesh = incise.Mesh.from_trimesh(body)
    assert mesh.uv is not None
    np.testing.assert_allclose(mesh.uv, uv[body.faces].astype(np.float32))


def test_other_objects_are_refused() -> None:
    with pytest.raises(incise.Error, match="int has no vertices"):
        incise.Mesh.from_trimesh(3)


def test_attributes_that_a_mesh_cannot_have_are_skipped_with_a_warning() -> None:
    body = trimesh.creation.icosphere(subdivisions=1)
    n, m = len(body.vertices), len(body.faces)
    body.vertex_attributes.update(
        heat=np.arange(n),
        many=np.zeros((n, 16)),
        wide=np.zeros((n, 17)),
        holes=np.full(n, np.nan),
        huge=np.full(n, 1e300),
        is_marked=np.ones(n, dtype=bool),
    )
    body.face_attributes.update(group=np.arange(m), tint=np.ones((m, 3, 2)))
    with pytest.warns(UserWarning, match="skips the attributes") as caught:
        mesh = incise.Mesh.from_trimesh(body)
    assert sorted(mesh.attributes) == ["heat", "many", "tint"]
    [warning] = caught
    for name in ("wide", "holes", "huge", "is_marked", "group"):
        assert repr(name) in str(warning.message)
    assert warning.filename == __file__
