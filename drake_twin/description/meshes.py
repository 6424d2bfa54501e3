"""Mesh files as Drake draws and collides them: visuals with their colours, and a convex shape for contact."""

import base64
import json
import re
import struct
from dataclasses import asdict
from functools import lru_cache
from pathlib import Path
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.description.coarse_mesh import coarser
from drake_twin.description.creased_normals import creased_normals
from drake_twin.description.hull import hull_of
from drake_twin.description.mesh_cache import cached, note_source
from drake_twin.description.mesh_faults import THINNEST, MeshFaults, faults_of
from drake_twin.description.mesh_file import Z_UP_TO_Y_UP, check_mesh_file, read_scene, reading, single_mesh
from drake_twin.description.obj_file import obj_is_sound
from drake_twin.description.robot_description import Vector3
from drake_twin.errors import InputError
from drake_twin.progress import tell
from drake_twin.requirements import missing

_SMALLEST = 1e-11  # mesh units; of smaller ones Drake computes no hull
HULL = ".hull.obj"  # the end of the names of convex hulls
_FAULTS = ".faults.json"

MOST_DRAWN = 500_000  # triangles of a mesh without colours: a page draws no more at once
_FINEST_DRAWN = 1 / 1024  # of its size: details of a mesh of more

# What files that give normals have in them.
_NORMALS = {
    ".obj": rb"^vn ",
    ".ply": rb"^property \w+ nx\b",
    ".dae": rb"""semantic=["']NORMAL["']""",
    ".glb": rb'"NORMAL"',
    ".gltf": rb'"NORMAL"',
}

# A primitive replaces a mesh whose hull's vertices are on it within this part of the mesh's size.
_PRIMITIVE_TOLERANCE = 1e-3


@dataclass(frozen=True)
class Primitive:
    """A box, cylinder or sphere that a mesh is.

    Attributes:
        kind: ``box``, ``cylinder`` or ``sphere``, as URDF names them.
        size: The sides of a box; radius and length of a cylinder; the radius of a sphere (m).
        center: Its centre in the mesh's frame (m).
        axis: The mesh's axis (0, 1 or 2) along which a cylinder's length is.
    """

    kind: str
    size: tuple[float, ...]
    center: Vector3
    axis: int = 2


def mesh_address(file: Path) -> str:
    """Return the address of a mesh for Drake's parser, which takes spaces and accents as they are, not as ``%20``."""
    return f"file://{file.absolute()}"


def visual_mesh(file: Path) -> Path:
    """Convert a mesh to a form that Drake's Meshcat and renderer accept.

    OBJ with normals and glTF stay as they are. Other formats become glTF, with their colours and textures inside, or
    OBJ when they have none, so that the URDF's material colours them.

    Args:
        file: The mesh file.

    Raises:
        InputError: If the format is unknown, or the file holds no triangles.
    """
    check_mesh_file(file)
    suffix = file.suffix.lower()
    if suffix == ".gltf":
        mesh_faults(file)  # raises if it cannot be read: Drake reads it itself, and must not fail at it
        return file
    if suffix == ".obj" and _has_normals(file) and _is_sound_obj(file):
        return file
    plain = _has_no_colors(file)
    return cached(file, ".visual.obj" if plain else ".visual.gltf", _visual_obj if plain else _visual_gltf)


def mesh_for_mjcf(file: Path) -> Path:
    """Convert a mesh to an OBJ file, the only format that Drake's MJCF parser accepts; it is drawn and collides.

    A flat one becomes a little thick.

    Raises:
        InputError: As `visual_mesh`.
    """
    check_mesh_file(file)
    if file.suffix.lower() == ".obj" and _has_normals(file) and _is_sound_obj(file):
        return file
    return (
        cached(file, ".thick.obj", _thick_obj)
        if mesh_faults(file).is_thin
        else cached(file, ".visual.obj", _visual_obj)
    )


def collision_mesh(file: Path) -> Path:
    """Convert a mesh to its convex hull, as an OBJ file.

    Raises:
        InputError: If the format is unknown, or the file holds no triangles.
    """
    check_mesh_file(file)
    hull = cached(file, HULL, _hull_obj)
    note_source(hull, file)
    return hull


def collision_pieces(file: Path) -> tuple[Path, ...]:
    """Decompose a mesh into convex pieces with CoACD, as OBJ files.

    Raises:
        InputError: As `collision_mesh`, or if the package coacd (the extra ``decomposition``) is not installed.
    """
    check_mesh_file(file)
    index = cached(file, ".pieces.json", _pieces_json)
    pieces = json.loads(index.read_text())
    return tuple(
        cached(file, f".piece{number}.obj", lambda _, piece=piece: str(piece).encode())  # type: ignore[misc]
        for number, piece in enumerate(pieces)
    )


def read_triangles(file: Path) -> Any:
    """Read all triangles of a mesh file as one trimesh, in metres where the file gives its unit.

    Raises:
        InputError: If the format is unknown, or the file holds no triangles.
    """
    check_mesh_file(file)
    return _examined(*read_scene(file), file)


def mesh_faults(file: Path) -> MeshFaults:
    """Return what is wrong with the triangles of a mesh file; known where it was read before.

    Raises:
        InputError: If the format is unknown, or the file holds no triangles.
    """
    check_mesh_file(file)

    def examined(source: Path) -> bytes:
        scene, unplaced = read_scene(source)
        return _faults_json(single_mesh(scene, source), unplaced)

    return MeshFaults(**json.loads(cached(file, _FAULTS, examined).read_text()))


def mesh_primitive(file: Path, scale: Vector3) -> Primitive | None:
    """Recognize the box, cylinder or sphere that a mesh is when it is scaled.

    Returns:
        The primitive; None if it is another shape.

    Raises:
        InputError: As `collision_mesh`.
    """
    return _primitive_of_hull(collision_mesh(file), scale)


@lru_cache(maxsize=1024)
def _primitive_of_hull(hull: Path, scale: Vector3) -> Primitive | None:
    lines = hull.read_text().splitlines()  # it is named after its content
    corners = [[float(number) for number in line.split()[1:]] for line in lines if line.startswith("v ")]
    points = np.array(corners) * np.array(scale)
    lower, upper = points.min(axis=0), points.max(axis=0)
    center, sides = (lower + upper) / 2, upper - lower
    tolerance = _PRIMITIVE_TOLERANCE * float(sides.max())
    if sides.min() <= tolerance:
        return None
    around = points - center
    place: Vector3 = (float(center[0]), float(center[1]), float(center[2]))
    if len(points) == 8 and np.all(np.abs(np.abs(around) - sides / 2) < tolerance):
        return Primitive("box", tuple(sides.tolist()), place)
    distances = np.linalg.norm(around, axis=1)
    if len(points) >= 48 and np.ptp(sides) < 2 * tolerance and np.ptp(distances) < tolerance:
        return Primitive("sphere", (float(distances.max()),), place)
    for axis in range(3):
        across = np.delete(around, axis, axis=1)
        radii = np.linalg.norm(across, axis=1)
        ends = np.abs(np.abs(around[:, axis]) - sides[axis] / 2) < tolerance
        if len(points) >= 32 and ends.all() and np.ptp(radii) < tolerance:
            return Primitive("cylinder", (float(radii.max()), float(sides[axis])), place, axis)
    return None


def _has_normals(file: Path) -> bool:
    """Tell whether a file gives its own normals; an STL's are its triangles'."""
    mark = _NORMALS.get(file.suffix.lower())
    return mark is not None and re.search(mark, _bytes(file), re.MULTILINE) is not None


def _is_sound_obj(file: Path) -> bool:
    """Tell whether Drake's reader of OBJ accepts a file; known where it was examined before."""
    return cached(file, ".sound.txt", lambda source: str(obj_is_sound(_bytes(source))).encode()).read_bytes() == b"True"


def _has_no_colors(file: Path) -> bool:
    """Tell whether a format, or this file, has no colours; without loading it where its bytes show that."""
    suffix = file.suffix.lower()
    if suffix in (".stl", ".off", ".obj"):
        return suffix != ".obj" or b"mtllib" not in _bytes(file)
    if suffix == ".dae":
        return b"<material" not in _bytes(file)
    if suffix == ".ply":
        return re.search(rb"property \w+ red\b", _bytes(file)[:4096]) is None
    return False


def _bytes(file: Path) -> bytes:
    try:
        return file.read_bytes()
    except OSError as error:
        raise InputError(f"the mesh cannot be read ({error.strerror})", file=file) from None


def _examined(scene: Any, unplaced: int, file: Path) -> Any:
    """Return all triangles of a scene, and keep what is wrong with them for `mesh_faults`."""
    mesh = single_mesh(scene, file)
    cached(file, _FAULTS, lambda _: _faults_json(mesh, unplaced))
    return mesh


def _faults_json(mesh: Any, unplaced: int) -> bytes:
    faults = faults_of(np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces), unplaced)
    return json.dumps(asdict(faults)).encode()


def _visual_obj(file: Path) -> bytes:
    return _obj_of(_with_fewer_triangles(read_triangles(file)))


def _thick_obj(file: Path) -> bytes:
    import trimesh

    mesh = read_triangles(file)
    vertices, count = with_thickness(_spread(np.asarray(mesh.vertices, dtype=float), file)), len(mesh.vertices)
    faces = [np.asarray(mesh.faces) + first for first in range(0, len(vertices), count)]
    return _obj_of(trimesh.Trimesh(vertices, np.concatenate(faces), process=False))


def _obj_of(mesh: Any) -> bytes:
    """Return an OBJ file whose edges are drawn as sharp as they are."""
    text = str(mesh.export(file_type="obj", include_normals=False, include_color=False, include_texture=False))
    normals, indices = creased_normals(np.asarray(mesh.vertices), np.asarray(mesh.faces))
    lines = [line for line in text.splitlines() if line.startswith("v ")]
    lines += [f"vn {x:.6g} {y:.6g} {z:.6g}" for x, y, z in normals.tolist()]
    corners = np.stack([np.asarray(mesh.faces), indices], axis=2).reshape(-1, 6) + 1
    lines += [f"f {a}//{i} {b}//{j} {c}//{k}" for a, i, b, j, c, k in corners.tolist()]
    return ("\n".join(lines) + "\n").encode()


def _with_fewer_triangles(mesh: Any) -> Any:
    """Merge the corners in each of so many cubes that the mesh has no more triangles than are drawn."""
    import trimesh

    vertices, faces = np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces)
    detail = _FINEST_DRAWN * float(np.ptp(vertices, axis=0).max())
    while len(faces) > MOST_DRAWN:
        vertices, faces = coarser(vertices, faces, detail)
        detail *= 2
    return mesh if len(faces) == len(mesh.faces) else trimesh.Trimesh(vertices, faces, process=False)


def _visual_gltf(file: Path) -> bytes:
    """Convert a mesh to glTF with everything inside: trimesh's GLB with its binary part as a data address."""
    scene, unplaced = read_scene(file)
    _examined(scene, unplaced, file)  # raises if it has no triangles
    with reading(file):
        if not _has_normals(file):
            for mesh in scene.geometry.values():
                if len(getattr(mesh, "faces", ())):
                    _crease(mesh)
        scene.apply_transform(Z_UP_TO_Y_UP)
        glb = scene.export(file_type="glb", include_normals=True)
    (length,) = struct.unpack_from("<I", glb, 12)
    document = json.loads(glb[20 : 20 + length])
    binary = glb[20 + length + 8 :]
    document["buffers"][0]["uri"] = "data:application/octet-stream;base64," + base64.b64encode(binary).decode()
    return json.dumps(document).encode()


def _crease(mesh: Any) -> None:
    """Give a mesh normals that are sharp at its edges, where it has a vertex for each of them."""
    vertices, corners = np.asarray(mesh.vertices), np.asarray(mesh.faces)
    normals, faces = creased_normals(vertices, corners)
    vertex_of = np.empty(len(normals), int)
    vertex_of[faces] = corners
    mesh.update_vertices(vertex_of)
    mesh.faces, mesh.vertex_normals = faces, normals


def _hull_obj(file: Path) -> bytes:
    """Compute the convex hull with Qhull, through SciPy: Drake's own takes over ten seconds for 50,000 triangles."""
    vertices = with_thickness(_spread(_different(np.asarray(read_triangles(file).vertices, dtype=float)), file))
    tell(f"computing the convex hull of {file.name} ({len(vertices):,} corners)")
    try:
        corners, triangles = hull_of(vertices)
    except (RuntimeError, ValueError) as error:  # SciPy's QhullError is a RuntimeError, too, as is Drake's
        reason = str(error).strip().splitlines()[0] if str(error).strip() else "Qhull failed"
        raise InputError(f"the mesh has no convex hull ({reason})", file=file) from None
    return _obj_text(corners, triangles.tolist()).encode()


def _different(points: np.ndarray) -> np.ndarray:
    """Return the different rows, in order."""
    points = points[np.lexsort(points.T[::-1])]
    return np.asarray(points[np.append(True, (np.diff(points, axis=0) != 0).any(axis=1))])


def _spread(vertices: np.ndarray, file: Path) -> np.ndarray:
    """Return the corners of a mesh, unless all are in one point."""
    if np.ptp(vertices, axis=0).max() <= _SMALLEST:
        raise InputError("all corners of the mesh are in one point", file=file)
    return vertices


def with_thickness(vertices: np.ndarray) -> np.ndarray:
    """Make a flat mesh a little thick, along the directions in which it is flat."""
    centered = vertices - vertices.mean(axis=0)
    size = float(np.abs(centered).max())
    _, directions = np.linalg.eigh(centered.T @ centered)
    for direction in directions.T:
        if np.ptp(centered @ direction) < THINNEST * size:
            shift = 0.5 * THINNEST * size * direction
            vertices = np.vstack([vertices + shift, vertices - shift])
    return vertices


def _obj_text(vertices: np.ndarray, faces: list[list[int]]) -> str:
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in vertices.tolist()]
    lines += ["f " + " ".join(str(corner + 1) for corner in face) for face in faces]
    return "\n".join(lines) + "\n"


def _pieces_json(file: Path) -> bytes:
    try:
        import coacd
    except ImportError:
        raise missing("collision: decomposition needs", "coacd") from None
    mesh = read_triangles(file)
    coacd.set_log_level("error")
    pieces = coacd.run_coacd(coacd.Mesh(np.asarray(mesh.vertices), np.asarray(mesh.faces)))
    texts = [_obj_text(np.asarray(vertices), np.asarray(faces).tolist()) for vertices, faces in pieces]
    return json.dumps(texts).encode()
