"""A mesh file as triangles with colors and textures, for viewers that cannot read the file."""

import io
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass

# glTF is y-up; Drake turns it to z-up.
_Y_UP_TO_Z_UP = np.array([[1.0, 0, 0, 0], [0, 0, -1.0, 0], [0, 1.0, 0, 0], [0, 0, 0, 1.0]])


@dataclass(frozen=True)
class MeshPart:
    """The triangles of a mesh that share one material.

    Attributes:
        vertices: Vertices in the mesh's frame (m), shape (N, 3).
        normals: Unit normals, shape (N, 3).
        faces: Indices of vertices, shape (M, 3).
        color: Red, green, blue and opacity from 0 to 1; None if the file does not define them.
        vertex_colors: Colors from 0 to 1, shape (N, 3), if the file has them.
        uv: Texture coordinates of the vertices from the lower left corner, shape (N, 2).
        texture: The bytes of a PNG file.
    """

    vertices: np.ndarray
    normals: np.ndarray
    faces: np.ndarray
    color: tuple[float, float, float, float] | None = None
    vertex_colors: np.ndarray | None = None
    uv: np.ndarray | None = None
    texture: bytes | None = None


def read_mesh(file: Path, scale: Sequence[float]) -> list[MeshPart]:
    """Read an OBJ (with its MTL) or glTF file.

    Args:
        file: The file.
        scale: The scale along x, y and z of the mesh's frame.

    Raises:
        ValueError: If the file cannot be read, or has no triangles.
    """
    import trimesh  # importing it takes a third of a second

    try:
        scene = trimesh.load_scene(file)
        turn = _Y_UP_TO_Z_UP if file.suffix.lower() == ".gltf" else np.eye(4)
        parts = []
        for node in scene.graph.nodes_geometry:
            X_MG, name = scene.graph[node]
            mesh = scene.geometry[name]
            if len(getattr(mesh, "faces", ())):
                parts.append(_part(mesh, np.diag([*scale, 1.0]) @ turn @ X_MG))
    except Exception as error:  # trimesh raises many kinds of errors for a broken file
        raise ValueError(" ".join(str(error).split()) or type(error).__name__) from error
    if not parts:
        raise ValueError("it has no triangles")
    return parts


def _part(mesh: Any, transform: np.ndarray) -> MeshPart:
    linear = transform[:3, :3]
    normals = np.asarray(mesh.vertex_normals) @ np.linalg.inv(linear)
    lengths = np.linalg.norm(normals, axis=1, keepdims=True)
    faces = np.asarray(mesh.faces)
    if np.linalg.det(linear) < 0:  # a mirrored mesh: keep its triangles facing outward
        faces = faces[:, ::-1]
    color, texture, uv, vertex_colors = _look(mesh)
    return MeshPart(
        vertices=np.asarray(mesh.vertices) @ linear.T + transform[:3, 3],
        normals=normals / np.where(lengths > 0, lengths, 1.0),
        faces=faces,
        color=color,
        vertex_colors=vertex_colors,
        uv=uv,
        texture=texture,
    )


def _look(mesh: Any) -> tuple[Any, Any, Any, Any]:
    """Return color, texture, texture coordinates and vertex colors."""
    visual = mesh.visual
    if visual.kind == "vertex":
        return (1.0, 1.0, 1.0, 1.0), None, None, np.asarray(visual.vertex_colors)[:, :3] / 255.0
    material = getattr(visual, "material", None)
    if visual.kind != "texture" or material is None:
        return None, None, None, None
    if hasattr(material, "baseColorFactor"):  # glTF
        rgba = np.full(4, 255) if material.baseColorFactor is None else np.asarray(material.baseColorFactor)
        image, opacity = material.baseColorTexture, rgba[3] / 255.0
        if (material.alphaMode or "OPAQUE") == "OPAQUE":
            opacity = 1.0
    else:
        rgba, image = np.asarray(material.diffuse), material.image
        opacity = float(np.ravel(material.kwargs.get("d", 1.0))[0])
    red, green, blue = (float(channel) / 255.0 for channel in rgba[:3])
    uv = getattr(visual, "uv", None)
    if image is None or uv is None or len(uv) != len(mesh.vertices):
        return (red, green, blue, opacity), None, None, None
    png = io.BytesIO()
    image.save(png, format="PNG")
    return (red, green, blue, opacity), png.getvalue(), np.asarray(uv), None
