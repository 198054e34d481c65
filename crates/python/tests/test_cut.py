"""Cuts: invariants of pieces, caps and origins, and the options of cuts."""

from __future__ import annotations

import threading
from typing import Any

import numpy as np
import pytest

import incise


def check_origins(mesh: incise.Mesh, result: incise.CutResult) -> None:
    """Checks masks, origins and weights of a cut by the exact method without remeshing."""
    positions = result.interpolate(mesh.vertices)
    np.testing.assert_allclose(result.weights.sum(axis=1), 1.0, rtol=1e-12)
    n = len(mesh.vertices)
    rows = np.arange(len(result.parents))[:, None]
    assert np.all(result.parents < n + rows), "parents come before their children"
    scale = np.abs(mesh.vertices).max()
    for i, piece in enumerate(result.pieces):
        mask, faces, ids = result.cap_masks[i], result.face_origins[i], result.vertex_ids[i]
        assert len(mask) == len(faces) == len(piece.faces)
        assert len(ids) == len(piece.vertices)
        np.testing.assert_array_equal(mask, faces == -1)
        np.testing.assert_array_equal(piece.materials == 1, mask)
        old = ids < n
        np.testing.assert_array_equal(positions[i][old], mesh.vertices[ids[old]])
        # The area of a face lies within that of the face from which it comes.
        corners = piece.vertices[piece.faces[~mask]].astype(np.float64)
        parents = mesh.vertices[mesh.faces[faces[~mask]]].astype(np.float64)
        normal = np.cross(parents[:, 1] - parents[:, 0], parents[:, 2] - parents[:, 0])
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        off = np.einsum("fck,fk->fc", corners - parents[:, :1], normal)
        assert np.abs(off).max(initial=0.0) < 1e-4 * scale


@pytest.mark.parametrize("level", ["2x-coarser", "original", "2x-finer", 0.7])
def test_halves_are_closed_and_keep_the_volume(bunny: incise.Mesh, level: Any) -> None:
    result = bunny.cut([0.1, 1.0, 0.2], 0.02, level=level, snap=0.0)
    assert len(result.pieces) == 2 and not result.is_miss
    assert all(piece.is_closed for piece in result.pieces)
    volumes = [piece.volume for piece in result.pieces]
    assert min(volumes) > 0
    assert sum(volumes) == pytest.approx(bunny.volume, rel=1e-6)
    check_origins(bunny, result)


def test_caps_lie_in_the_plane_and_face_each_other(bunny: incise.Mesh) -> None:
    normal = np.array([0.1, 1.0, 0.2]) / np.linalg.norm([0.1, 1.0, 0.2])
    result = bunny.cut(normal, 0.02)
    areas = []
    for piece, mask in zip(result.pieces, result.cap_masks):
        corners = piece.vertices[piece.faces[mask]].astype(np.float64)
        np.testing.assert_allclose(corners @ normal, 0.02, atol=1e-6)
        doubled = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
        areas.append(doubled.sum(axis=0) / 2)
    np.testing.assert_allclose(areas[0], -areas[1], atol=1e-7)


def test_finer_levels_have_more_cap_triangles(bunny: incise.Mesh) -> None:
    counts = [
        bunny.cut([0, 1, 0.2], 0.02, level=level, grading=0.0).cap_masks[0].sum()
        for level in ("original", "1.5x-finer", "2x-finer", 0.3)
    ]
    assert counts == sorted(set(counts))


def test_a_miss_returns_the_input(bunny: incise.Mesh) -> None:
    result = bunny.cut([0, 1, 0], 9.0)
    assert result.is_miss and len(result.pieces) == 1
    np.testing.assert_array_equal(result.pieces[0].vertices, bunny.vertices)
    np.testing.assert_array_equal(result.pieces[0].faces, bunny.faces)
    np.testing.assert_array_equal(result.face_origins[0], np.arange(len(bunny.faces)))
    np.testing.assert_array_equal(result.vertex_ids[0], np.arange(len(bunny.vertices)))
    assert result.parents.shape == result.weights.shape == (0, 3)


def test_a_cut_does_not_change_its_mesh_and_repeats_its_bits(bunny: incise.Mesh) -> None:
    vertices, faces = bunny.vertices.copy(), bunny.faces.copy()
    first, second = (bunny.cut([0.3, 1, 0.2], 0.01) for _ in range(2))
    np.testing.assert_array_equal(bunny.vertices, vertices)
    np.testing.assert_array_equal(bunny.faces, faces)
    for a, b in zip(first.pieces, second.pieces):
        assert a.vertices.tobytes() == b.vertices.tobytes()
        assert a.faces.tobytes() == b.faces.tobytes()


def test_attributes_and_materials_follow_a_cut(sphere: incise.Mesh) -> None:
    mesh = incise.Mesh(
        sphere.vertices,
        sphere.faces,
        uv=sphere.vertices[:, :2],
        attributes={"height": sphere.vertices[:, 1]},
    )
    result = mesh.cut([1, 0.2, 0.1], 0.05, snap=0.0)
    for piece, mask in zip(result.pieces, result.cap_masks):
        np.testing.assert_allclose(piece.attributes["height"], piece.vertices[:, 1], atol=1e-6)
        assert piece.uv is not None
        corners = piece.vertices[piece.faces][:, :, :2]
        np.testing.assert_allclose(piece.uv[~mask], corners[~mask], atol=1e-6)
    # Caps of a first cut keep their material in a second one.
    half = result.pieces[0]
    quarters = half.cut([0, 1, 0.1], 0.02)
    old_caps = sum(int((p.materials[~m] == 1).sum()) for p, m in zip(*parts(quarters)))
    assert old_caps >= int(result.cap_masks[0].sum())


def parts(result: incise.CutResult) -> tuple[list[incise.Mesh], list[Any]]:
    return result.pieces, result.cap_masks


def test_remeshing_has_origins(bunny: incise.Mesh) -> None:
    result = bunny.cut([0.1, 1, 0.2], 0.02, remesh=0.1)
    assert len(result.pieces) == 2
    for piece, mask, faces in zip(result.pieces, result.cap_masks, result.face_origins):
        assert 0 < mask.sum() < len(mask)
        kept = faces >= 0
        assert np.all(faces[mask] == -1) and kept.any()
        old = bunny.vertices[bunny.faces[faces[kept]]]
        same = (piece.vertices[piece.faces[kept]] == old).all(axis=(1, 2))
        assert same.mean() > 0.9, "kept faces are those of the input"


def test_sheets_are_cut_without_caps(bowl: incise.Mesh) -> None:
    result = bowl.cut([1, 0, 0.1], 0.01, snap=0.0)
    assert len(result.pieces) == 2
    assert not any(mask.any() for mask in result.cap_masks)
    assert sum(piece.area for piece in result.pieces) == pytest.approx(bowl.area, rel=1e-5)


def test_a_body_without_caps_becomes_a_sheet(sphere: incise.Mesh) -> None:
    result = sphere.cut([1, 0, 0.1], 0.01, caps="none")
    assert [piece.is_closed for piece in result.pieces] == [False, False]


def blade(*places: float) -> Any:
    return np.array([[[x, 0.013, -1], [x, 0.017, 1]] for x in places], dtype=np.float32)


def test_a_path_that_ends_inside_leaves_two_walls(sphere: incise.Mesh) -> None:
    result = sphere.cut_path(blade(-1, -0.4, 0.01))
    [piece] = result.pieces
    assert piece.is_closed and result.report["tips"] > 0
    assert result.report["steps"] == 2
    assert piece.volume == pytest.approx(sphere.volume, rel=1e-5)
    walls = piece.vertices[piece.faces[result.cap_masks[0]]].astype(np.float64)
    doubled = np.cross(walls[:, 1] - walls[:, 0], walls[:, 2] - walls[:, 0])
    assert np.linalg.norm(doubled, axis=1).sum() / 2 > 0.5, "two walls of half a disc"
    np.testing.assert_allclose(doubled.sum(axis=0), 0.0, atol=1e-4)
    check_origins(sphere, result)


def test_a_path_through_a_body_leaves_two_pieces(sphere: incise.Mesh) -> None:
    result = sphere.cut_path(blade(-1, -0.3, 0.3, 1))
    assert len(result.pieces) == 2 and result.report["tips"] == 0
    volumes = sum(piece.volume for piece in result.pieces)
    assert volumes == pytest.approx(sphere.volume, rel=1e-3)
    assert result.report["cutting_steps"] == 3


def test_paths_that_cannot_be_cut_are_refused(sphere: incise.Mesh) -> None:
    inside = np.array([[[x, 0.0, -0.05], [x, 0.0, 0.05]] for x in (-0.1, 0.1)])
    with pytest.raises(incise.CutError, match="starts inside"):
        sphere.cut_path(inside)
    with pytest.raises(incise.CutError, match="no motion"):
        sphere.cut_path(blade(-1, -1, -1))
    with pytest.raises(incise.Error, match=r"path has shape \(1, 2, 3\)"):
        sphere.cut_path(blade(0.0))
    assert sphere.cut_path(blade(-3, -2)).is_miss


def test_threads_cut_one_mesh_at_the_same_time(bunny: incise.Mesh) -> None:
    mesh = incise.Mesh(bunny.vertices, bunny.faces)
    expected = mesh.cut([0.3, 1, 0.2], 0.01).pieces[0].vertices.tobytes()
    found: list[bytes] = []

    def run() -> None:
        for _ in range(5):
            found.append(mesh.cut([0.3, 1, 0.2], 0.01).pieces[0].vertices.tobytes())

    threads = [threading.Thread(target=run) for _ in range(4)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [expected] * 20
