"""Conversion of meshes from and to trimesh, which is imported only here."""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np

from ._incise import Error, Mesh


#: Largest number of columns of an attribute.
_MAX_COLUMNS = 16


def _fits(values: Any, dimensions: tuple[int, ...]) -> bool:
    """Tells whether values are an attribute: finite float32 numbers in up to 16 columns."""
    array = np.asarray(values)
    if array.dtype.kind not in "fiu" or array.ndim not in dimensions:
        return False
    if array.ndim > 1 and not 1 <= array.shape[-1] <= _MAX_COLUMNS:
        return False
    limit = np.finfo(np.float32).max
    return bool((np.abs(array.astype(np.float64)) <= limit).all())


def from_trimesh(mesh: Any) -> Mesh:
    """Makes a mesh of a `trimesh.Trimesh`; float64 vertices are rounded to float32 once.

    Attributes that a mesh cannot have are skipped, with a warning that names them.
    """
    try:
        vertices, faces = mesh.vertices, mesh.faces
    except AttributeError:
        raise Error(
            f"{type(mesh).__name__} has no vertices and faces; pass a trimesh.Trimesh"
        ) from None
    attributes: dict[str, Any] = {}
    uv = getattr(getattr(mesh, "visual", None), "uv", None)
    skipped: list[str] = []
    for name, values in mesh.vertex_attributes.items():
        if _fits(values, (1, 2)):
            attributes[name] = values
        else:
            skipped.append(name)
    for name, values in mesh.face_attributes.items():
        if name == "uv":
            uv = values
        elif _fits(values, (3,)):
            attributes[name] = values
        else:
            skipped.append(name)
    if skipped:
        warnings.warn(
            f"from_trimesh skips the attributes {', '.join(map(repr, skipped))}; an attribute has "
            f"finite numbers in up to {_MAX_COLUMNS} columns, a row per vertex or corner",
            stacklevel=2,
        )
    return Mesh(vertices, faces, uv=uv, attributes=attributes)


def to_trimesh(mesh: Mesh) -> Any:
    """Returns a mesh as a `trimesh.Trimesh` with the same indices of vertices and faces."""
    import trimesh

    per_vertex: dict[str, Any] = {}
    per_face: dict[str, Any] = {}
    for name, values in mesh.attributes.items():
        if values.ndim == 3:
            per_face[name] = values
        else:
            per_vertex[name] = values
    if mesh.uv is not None:
        per_face["uv"] = mesh.uv
    return trimesh.Trimesh(
        vertices=mesh.vertices + np.asarray(mesh.origin),
        faces=mesh.faces.astype(np.int64),
        vertex_attributes=per_vertex,
        face_attributes=per_face,
        process=False,
    )
