"""Conversion of meshes from and to trimesh, which is imported only here."""

from __future__ import annotations

from typing import Any

import numpy as np

from ._incise import Error, Mesh


def from_trimesh(mesh: Any) -> Mesh:
    """Makes a mesh of a `trimesh.Trimesh`; float64 vertices are rounded to float32 once."""
    try:
        vertices, faces = mesh.vertices, mesh.faces
    except AttributeError:
        raise Error(
            f"{type(mesh).__name__} has no vertices and faces; pass a trimesh.Trimesh"
        ) from None
    attributes: dict[str, Any] = {}
    uv = getattr(getattr(mesh, "visual", None), "uv", None)
    for name, values in mesh.vertex_attributes.items():
        if np.ndim(values) in (1, 2) and np.asarray(values).dtype.kind in "fiu":
            attributes[name] = values
    for name, values in mesh.face_attributes.items():
        if name == "uv":
            uv = values
        elif np.ndim(values) == 3:
            attributes[name] = values
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
