"""Copies and pickles of meshes, and meshes far from the origin."""

from __future__ import annotations

import copy
import pickle
from pathlib import Path
from typing import Any, Callable

import numpy as np
import pytest

import incise

FAR = np.array([1e6, -2e6, 3e6])


class Named(incise.Mesh):
    """A mesh with an attribute of its own."""

    name: str


def everything() -> incise.Mesh:
    """A mesh with all arrays."""
    model = incise.model("Sphere80")
    n, m = len(model.vertices), len(model.faces)
    return incise.Mesh(
        model.vertices,
        model.faces,
        uv=np.linspace(0, 1, 6 * m).reshape(m, 3, 2),
        attributes={
            "heat": np.arange(n),
            "color": np.ones((n, 4)),
            "tint": np.ones((m, 3, 2)),
            "skin": np.tile([0, 1, 0.5, 0.5], (n, 1)),
        },
        normals=np.tile([0, 0, 1], (m, 3, 1)),
        materials=np.arange(m),
        origin=FAR,
        warnings=["a text"],
    )


@pytest.mark.parametrize(
    "copied",
    [copy.copy, copy.deepcopy, *(lambda m, p=p: pickle.loads(pickle.dumps(m, p)) for p in (2, 5))],
)
def test_copies_have_all_arrays(copied: Callable[[incise.Mesh], incise.Mesh]) -> None:
    mesh = everything()
    again = copied(mesh)
    for name in ("vertices", "faces", "uv", "normals", "materials"):
        expected = getattr(mesh, name)
        np.testing.assert_array_equal(getattr(again, name), expected, err_msg=name)
        assert getattr(again, name).dtype == expected.dtype
    assert list(again.attributes) == list(mesh.attributes)
    for name, values in mesh.attributes.items():
        np.testing.assert_array_equal(again.attributes[name], values)
    assert again.origin == mesh.origin == tuple(FAR)
    assert again.warnings == ["a text"]
    first, second = (each.cut([0, 1, 0.1], 0.05) for each in (mesh, again))
    for a, b in zip(first.pieces, second.pieces):
        assert a.vertices.tobytes() == b.vertices.tobytes()
        assert a.attributes["skin"].tobytes() == b.attributes["skin"].tobytes()


def test_a_subclass_keeps_its_type_and_attributes(sphere: incise.Mesh) -> None:
    mesh = Named(sphere.vertices, sphere.faces)
    mesh.name = "ball"
    for again in (copy.deepcopy(mesh), pickle.loads(pickle.dumps(mesh))):
        assert type(again) is Named and again.name == "ball"
        np.testing.assert_array_equal(again.vertices, sphere.vertices)


def test_models_and_repaired_meshes_are_pickled(bunny: incise.Mesh) -> None:
    bowl = incise.Mesh(bunny.vertices, bunny.faces[:700]).repair()
    for mesh in (bunny, bowl):
        again = pickle.loads(pickle.dumps(mesh))
        np.testing.assert_array_equal(again.faces, mesh.faces)
        assert again.warnings == mesh.warnings
        assert (again.normals is None) == (mesh.normals is None)


def test_a_far_mesh_keeps_its_digits(bunny: incise.Mesh, tmp_path: Path) -> None:
    near = bunny.vertices.astype(np.float64)
    far = incise.Mesh(near + FAR, bunny.faces)
    origin = np.asarray(far.origin)
    assert (np.abs(origin - FAR) <= 1).all()
    # A float64 keeps 2e-10 at 3e6, a float32 only 0.25.
    np.testing.assert_allclose(far.vertices + origin - FAR, near, atol=1e-7)
    normal = np.array([0.2, 1.0, 0.1])
    cut = far.cut(normal, 0.02 + normal @ FAR - normal @ origin)
    expected = bunny.cut(normal, 0.02)
    assert [len(piece.faces) for piece in cut.pieces] == [
        len(piece.faces) for piece in expected.pieces
    ]
    for piece, other in zip(cut.pieces, expected.pieces):
        assert piece.origin == far.origin
        assert piece.volume == pytest.approx(other.volume, rel=1e-3)
    cut.pieces[0].save(tmp_path / "far.obj")
    again = incise.Mesh.load(tmp_path / "far.obj")
    np.testing.assert_allclose(
        again.vertices + np.asarray(again.origin),
        cut.pieces[0].vertices + origin,
        atol=1e-6,
    )


def test_bodies_of_a_scene_have_one_origin(sphere: incise.Mesh) -> None:
    near = sphere.vertices.astype(np.float64)
    meshes = [incise.Mesh(near + FAR + [x, 0, 0], sphere.faces) for x in (0.25, 2.25)]
    assert meshes[0].origin != meshes[1].origin
    scene = incise.Scene()
    assert scene.origin == (0, 0, 0)
    bodies = [scene.add_body(mesh) for mesh in meshes]
    assert scene.origin == meshes[0].origin
    apart = scene.positions(bodies[1]) - scene.positions(bodies[0])
    np.testing.assert_allclose(apart.mean(axis=0), [2, 0, 0], atol=1e-6)
    assert {piece.origin for body in bodies for piece in scene.pieces(body)} == {
        meshes[0].origin
    }


def test_near_and_float32_vertices_have_the_origin_zero(sphere: incise.Mesh) -> None:
    near = sphere.vertices.astype(np.float64) + 50
    single = (sphere.vertices + FAR).astype(np.float32)
    for vertices in (near, single):
        mesh = incise.Mesh(vertices, sphere.faces)
        assert mesh.origin == (0, 0, 0)
        np.testing.assert_array_equal(mesh.vertices, vertices.astype(np.float32))


@pytest.mark.parametrize(
    ("keys", "text"),
    [
        ({"origin": [0, float("nan"), 0]}, "origin is"),
        ({"origin": [0, 0]}, "origin is no vector"),
        ({"normals": np.zeros((3, 3))}, "normals has shape"),
        ({"materials": [0, 1]}, "materials has shape"),
        ({"materials": [-1]}, "materials has the number -1"),
        ({"materials": [2**32 - 1]}, "materials has the number 4294967295"),
    ],
)
def test_bad_arguments_are_named(keys: Any, text: str) -> None:
    with pytest.raises(incise.Error, match=text):
        incise.Mesh(np.eye(3), [[0, 1, 2]], **keys)
