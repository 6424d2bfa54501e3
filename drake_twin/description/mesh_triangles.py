"""The triangles of mesh files, for rays."""

import io
from pathlib import Path

import numpy as np

from drake_twin.description.mesh_cache import cached


def mesh_triangles(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices (n, 3), in the file's units, and the faces (m, 3) of an OBJ, glTF or GLB file.

    They are kept in the mesh cache: the library that reads the files takes a third of a second to import.

    Raises:
        InputError: If the file cannot be read, or the cache cannot be written.
    """
    with np.load(cached(file, ".triangles.npz", _read)) as arrays:
        return arrays["vertices"], arrays["faces"]


def _read(file: Path) -> bytes:
    import trimesh

    mesh = trimesh.load_scene(file).to_mesh()
    vertices = np.asarray(mesh.vertices)
    if file.suffix in (".gltf", ".glb"):  # y is up in the file
        vertices = np.column_stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]])
    content = io.BytesIO()
    np.savez(content, vertices=vertices, faces=np.asarray(mesh.faces))
    return content.getvalue()
