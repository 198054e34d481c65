"""Bodies that tests share, made by formula."""

from __future__ import annotations

import numpy as np
import pytest

import incise


@pytest.fixture(scope="session")
def bunny() -> incise.Mesh:
    """The built-in model of 1,500 triangles."""
    return incise.model("Bunny")


@pytest.fixture(scope="session")
def sphere() -> incise.Mesh:
    """A sphere of radius 0.5 with 768 triangles, without corner attributes."""
    model = incise.model("Sphere768")
    return incise.Mesh(model.vertices, model.faces)


@pytest.fixture(scope="session")
def bowl(sphere: incise.Mesh) -> incise.Mesh:
    """The lower half of the sphere, roughly: a sheet with one hole."""
    centers = sphere.vertices[sphere.faces].mean(axis=1)
    return incise.Mesh(sphere.vertices, sphere.faces[centers[:, 1] < 0.1])


@pytest.fixture(scope="session")
def tetrahedron() -> incise.Mesh:
    """The corner of a unit cube: volume 1/6."""
    vertices = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], dtype=np.float32)
    faces = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]], dtype=np.uint32)
    return incise.Mesh(vertices, faces)
