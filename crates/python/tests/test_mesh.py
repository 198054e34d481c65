"""Meshes: arrays, files, checks, repairs and holes."""

from __future__ import annotations

import gc
from pathlib import Path

import numpy as np
import pytest

import incise


def test_arrays_come_back_bit_for_bit(tetrahedron: incise.Mesh) -> None:
    assert tetrahedron.vertices.dtype == np.float32
    assert tetrahedron.faces.dtype == np.uint32
    again = incise.Mesh(tetrahedron.vertices, tetrahedron.faces)
    np.testing.assert_array_equal(again.vertices, tetrahedron.vertices)
    np.testing.assert_array_equal(again.faces, tetrahedron.faces)
    assert tetrahedron.volume == pytest.approx(1 / 6, rel=1e-12)
    assert tetrahedron.area == pytest.approx(1.5 + np.sqrt(3) / 2, rel=1e-12)
    assert tetrahedron.is_closed


def test_any_memory_layout_and_integer_type_gives_the_same_mesh(sphere: incise.Mesh) -> None:
    vertices, faces = sphere.vertices, sphere.faces
    wide = np.zeros((len(vertices), 6))
    wide[:, ::2] = vertices
    for v in (np.asfortranarray(vertices), vertices.astype(np.float64), wide[:, ::2]):
        for f in (np.asfortranarray(faces), faces.astype(np.int64), faces.astype(np.uint64)):
            mesh = incise.Mesh(v, f)
            np.testing.assert_array_equal(mesh.vertices, vertices)
            np.testing.assert_array_equal(mesh.faces, faces)
    lists = incise.Mesh(vertices.tolist(), faces.tolist())
    np.testing.assert_array_equal(lists.vertices, vertices)


def test_views_share_memory_are_read_only_and_keep_the_mesh_alive() -> None:
    mesh = incise.model("Bunny")
    first, second = mesh.vertices, mesh.vertices
    assert np.shares_memory(first, second)
    expected = first.copy()
    for view in (first, mesh.faces, mesh.materials):
        with pytest.raises(ValueError, match="read-only"):
            view[0] = 0
        with pytest.raises(ValueError, match="WRITEABLE"):
            view.setflags(write=True)
    del mesh, second
    gc.collect()
    np.testing.assert_array_equal(first, expected)


def test_later_writes_to_the_input_do_not_change_a_mesh() -> None:
    vertices = np.eye(3, dtype=np.float32)
    mesh = incise.Mesh(vertices, [[0, 1, 2]])
    vertices[:] = np.nan
    np.testing.assert_array_equal(mesh.vertices, np.eye(3))


def test_uv_of_vertices_and_of_corners_are_the_same(tetrahedron: incise.Mesh) -> None:
    vertices, faces = tetrahedron.vertices, tetrahedron.faces
    uv = vertices[:, :2]
    of_vertices = incise.Mesh(vertices, faces, uv=uv)
    of_corners = incise.Mesh(vertices, faces, uv=uv[faces])
    assert of_vertices.uv is not None and of_corners.uv is not None
    np.testing.assert_array_equal(of_vertices.uv, uv[faces])
    np.testing.assert_array_equal(of_corners.uv, uv[faces])
    assert tetrahedron.uv is None


def test_attributes_keep_their_shapes(tetrahedron: incise.Mesh) -> None:
    vertices, faces = tetrahedron.vertices, tetrahedron.faces
    given = {
        "heat": np.arange(4, dtype=np.float32),
        "color": np.arange(12, dtype=np.float32).reshape(4, 3),
        "tint": np.arange(24, dtype=np.float32).reshape(4, 3, 2),
    }
    mesh = incise.Mesh(vertices, faces, attributes=given)
    assert set(mesh.attributes) == set(given)
    for name, values in given.items():
        np.testing.assert_array_equal(mesh.attributes[name], values)


@pytest.mark.parametrize("extension", ["obj", "ply", "stl", "glb"])
def test_files_come_back(tmp_path: Path, bunny: incise.Mesh, extension: str) -> None:
    path = tmp_path / f"bunny.{extension}"
    bunny.save(path)
    again = incise.Mesh.load(str(path))
    assert again.volume == pytest.approx(bunny.volume, rel=1e-6)
    assert len(again.faces) == len(bunny.faces)
    assert again.warnings == []


def test_dropped_attributes_are_named(tmp_path: Path, tetrahedron: incise.Mesh) -> None:
    heat = np.arange(4, dtype=np.float32)
    mesh = incise.Mesh(tetrahedron.vertices, tetrahedron.faces, attributes={"heat": heat})
    [warning] = mesh.save(tmp_path / "body.stl")
    assert "heat" in warning


def test_files_that_are_no_meshes_are_refused(tmp_path: Path, bunny: incise.Mesh) -> None:
    with pytest.raises(FileNotFoundError, match="missing.obj"):
        incise.Mesh.load(tmp_path / "missing.obj")
    broken = tmp_path / "broken.obj"
    broken.write_text("v 0 0 0\nf 1 2 3\n")
    with pytest.raises(incise.FileError, match="out of range"):
        incise.Mesh.load(broken)
    with pytest.raises(incise.FileError, match="unknown extension"):
        incise.Mesh.load(tmp_path / "mesh.xyz")
    with pytest.raises(incise.Error, match="unknown extension"):
        bunny.save(tmp_path / "mesh.xyz")
    with pytest.raises(FileNotFoundError):
        bunny.save(tmp_path / "missing" / "mesh.obj")


def test_a_soup_is_welded_by_repair(sphere: incise.Mesh) -> None:
    corners = sphere.vertices[sphere.faces].reshape(-1, 3)
    faces = np.arange(len(corners)).reshape(-1, 3)
    soup = incise.Mesh(corners, faces, attributes={"height": corners[:, 1]})
    assert not soup.is_closed
    assert soup.check()["closed"], "a report is that of the welded mesh"
    welded = soup.repair()
    assert welded.is_closed
    assert len(welded.vertices) == len(sphere.vertices)
    assert welded.volume == pytest.approx(sphere.volume, rel=1e-9)
    height = welded.attributes["height"]
    np.testing.assert_array_equal(height[:, :, 0], welded.vertices[welded.faces][:, :, 1])


def test_check_lists_defects_and_repair_refuses_them(bowl: incise.Mesh) -> None:
    report = bowl.check()
    assert [defect["kind"] for defect in report["defects"]] == ["open_edge"]
    assert bowl.check(allow_boundaries=True)["defects"] == []
    with pytest.raises(incise.RepairError, match="open edges"):
        bowl.repair(allow_boundaries=False)
    assert bowl.repair().area == pytest.approx(bowl.area, rel=1e-9)


def test_faces_that_are_no_manifold_are_repaired_or_refused(tetrahedron: incise.Mesh) -> None:
    faces = tetrahedron.faces.copy()
    faces[0] = faces[0, ::-1]
    turned = incise.Mesh(tetrahedron.vertices, faces)
    with pytest.raises(incise.TopologyError, match="opposite orientations"):
        turned.cut([1, 1, 1], 0.5)
    repaired = turned.repair()
    assert repaired.volume == pytest.approx(1 / 6)
    assert any("flipped" in warning for warning in repaired.warnings)


def test_fill_closes_holes(bowl: incise.Mesh) -> None:
    filled, report = bowl.fill(level="original")
    assert filled.is_closed and len(report["holes"]) == 1
    n, m = len(bowl.vertices), len(bowl.faces)
    used = np.unique(bowl.faces)
    np.testing.assert_array_equal(filled.vertices[: len(used)], bowl.vertices[used])
    assert filled.materials[:m].max() == 0 and filled.materials[m:].min() == 1
    assert len(filled.faces) == m + report["holes"][0]["triangles"]
    assert n > len(used), "compaction drops the vertices that no face uses"
    kept, report = bowl.fill(max_rim_edges=3)
    assert not kept.is_closed and report["left_open"] == 1
    with pytest.raises(incise.FillError, match="more than 1 triangles"):
        bowl.fill(max_triangles=1)


def test_models_are_those_of_the_table() -> None:
    assert incise.MODELS[3] == "Bunny"
    assert len(incise.model("bunny").faces) == 1500
    with pytest.raises(incise.Error, match="Sphere20"):
        incise.model("cow")
