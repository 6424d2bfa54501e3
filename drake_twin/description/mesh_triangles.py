"""The triangles of mesh files, for rays."""

import io
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from drake_twin.description.mesh_cache import cached, source_of

_SCALED = " scaled by "


def mesh_triangles(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """Return the vertices (n, 3), in the file's units, and the faces (m, 3) of an OBJ, glTF or GLB file.

    They are kept in the mesh cache: the library that reads the files takes a third of a second to import.

    Raises:
        InputError: If the file cannot be read, or the cache cannot be written.
    """
    with np.load(cached(file, ".triangles.npz", _read)) as arrays:
        return arrays["vertices"], arrays["faces"]


def hull_name(hull: Path, scale: Iterable[float]) -> str:
    """Return the name of a shape in memory that is made of a hull, for `named_hull`."""
    return f"{hull}{_SCALED}{' '.join(map(repr, scale))}"


def named_hull(name: str) -> tuple[Path, np.ndarray] | None:
    """Return the file and the scale of the hull that a shape in memory is made of; None if its name is another."""
    hull, is_named, scale = name.rpartition(_SCALED)
    return (Path(hull), np.array([float(part) for part in scale.split()])) if is_named else None


def hulled_triangles(hull: Path) -> tuple[np.ndarray, np.ndarray] | None:
    """Return the triangles of the mesh of which `meshes.collision_mesh` made a hull, as `mesh_triangles` does.

    Returns:
        Vertices (m) and faces; None if the file is another, or its mesh is gone.

    Raises:
        InputError: As `mesh_triangles`.
    """
    from drake_twin.description.meshes import HULL

    source = source_of(hull) if hull.name.endswith(HULL) else None
    if source is None:
        return None
    with np.load(cached(source, ".hulled.npz", _read_hulled)) as arrays:
        return arrays["vertices"], arrays["faces"]


def _read_hulled(file: Path) -> bytes:
    from drake_twin.description.meshes import read_triangles

    mesh = read_triangles(file)
    return _packed(np.asarray(mesh.vertices), np.asarray(mesh.faces))


def _packed(vertices: np.ndarray, faces: np.ndarray) -> bytes:
    content = io.BytesIO()
    np.savez(content, vertices=vertices, faces=faces)
    return content.getvalue()


def _read(file: Path) -> bytes:
    import trimesh

    mesh = trimesh.load_scene(file).to_mesh()
    vertices = np.asarray(mesh.vertices)
    if file.suffix in (".gltf", ".glb"):  # y is up in the file
        vertices = np.column_stack([vertices[:, 0], -vertices[:, 2], vertices[:, 1]])
    return _packed(vertices, np.asarray(mesh.faces))
