"""Mesh files as triangles, within bounds of their number and place."""

import re
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from io import BytesIO
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from lxml import etree

from drake_twin.description.gltf_file import check_gltf
from drake_twin.description.mesh_cache import check_files_beside
from drake_twin.description.source_file import check_regular
from drake_twin.errors import InputError
from drake_twin.progress import tell
from drake_twin.values import LARGEST

_READ_BY_DRAKE = (".obj", ".gltf")
_READ_BY_TRIMESH = (".stl", ".dae", ".ply", ".glb", ".off")
MESH_SUFFIXES = _READ_BY_DRAKE + _READ_BY_TRIMESH

# Files with more are refused: of two million triangles a hull takes a minute and 1.5 GB.
MOST_TRIANGLES = 2_000_000

# How a triangle shows in texts, which take some times their length to be read.
_TRIANGLE = {".stl": b"endfacet", ".obj": b"\nf "}
_MANY_BYTES_OF_TEXT = 100_000_000

_NOT_FINITE = re.compile(rb"(?i)[\s>][+-]?(nan|inf)")  # a number, in XML
_IMAGE = re.compile(rb"""<image\b[^>]*?\bid=["']([^"']*)["']""")
_IMAGE_OF_SURFACE = re.compile(rb"<surface\b[^>]*>\s*<init_from\b[^>]*>([^<]*)</init_from>")
_DECIMATE = "decimate it, in Blender or MeshLab for example"

# Drake turns glTF from its y-up to z-up; robots' meshes are z-up already.
Z_UP_TO_Y_UP = np.array([[1.0, 0, 0, 0], [0, 0, 1.0, 0], [0, -1.0, 0, 0], [0, 0, 0, 1.0]])


def check_mesh_file(file: Path) -> None:
    """Check what shows without reading a mesh file: its name, its kind and its length.

    Raises:
        InputError: If the format is unknown, or the file cannot be read or has too many triangles.
    """
    suffix = file.suffix.lower()
    if suffix not in MESH_SUFFIXES:
        what = f"unknown mesh format {suffix!r}" if suffix else "the mesh's file name has no suffix"
        raise InputError(what, file=file, valid=MESH_SUFFIXES)
    try:
        check_regular(file)
        check_files_beside(file)
        size = file.stat().st_size
        if suffix == ".stl":
            with file.open("rb") as content:
                count = int.from_bytes(content.read(84)[80:], "little")
            if size == 84 + 50 * count:  # binary
                return _check_count(file, count)
        if size > _MANY_BYTES_OF_TEXT and suffix in _TRIANGLE:
            _check_count(file, file.read_bytes().count(_TRIANGLE[suffix]))
    except OSError as error:
        raise InputError(f"the mesh cannot be read ({error.strerror})", file=file) from None


def _check_count(file: Path, count: int) -> None:
    if count > MOST_TRIANGLES:
        what = f"the mesh has {count:,} triangles, and {MOST_TRIANGLES:,} are the most"
        raise InputError(f"{what}: {_DECIMATE}", file=file)


@contextmanager
def reading(file: Path) -> Iterator[None]:
    """Turn any exception of the readers and exporters of meshes into an `InputError`: broken files raise all kinds."""
    try:
        with warnings.catch_warnings():  # what NumPy 2.5 says to pycollada, which no user can change
            warnings.filterwarnings("ignore", "Setting the shape on a NumPy array", DeprecationWarning)
            warnings.filterwarnings("ignore", "invalid value encountered in cast", RuntimeWarning)  # refused afterwards
            yield
    except InputError:
        raise
    except ModuleNotFoundError:  # trimesh needs another package to guess the encoding of bytes that are not text
        raise InputError(f"the mesh is truncated, or not a {file.suffix} file", file=file) from None
    except Exception as error:
        raise InputError(f"the mesh cannot be read ({' '.join(str(error).split())})", file=file) from None


def read_scene(file: Path) -> tuple[Any, int]:
    """Read a mesh file as a trimesh scene in metres.

    Returns:
        The scene, and the number of triangles that are left out because a corner is not a finite point.

    Raises:
        InputError: If the file cannot be read.
    """
    import trimesh  # takes a third of a second, and only the first start of a robot needs it

    tell(f"reading {file.name} ({file.stat().st_size / 1e6:.1f} MB)")
    with reading(file):
        if file.suffix.lower() in (".gltf", ".glb"):
            check_gltf(file)
        mended = None
        if file.suffix.lower() == ".dae":
            _check_corners_of_dae(file)
            mended = _with_all_images(file)
        source = file if mended is None else BytesIO(mended)
        kind = None if mended is None else "dae"
        scene = trimesh.load_scene(source, file_type=kind, resolver=_resolver(file), process=False)
        unplaced = 0
        for geometry in scene.geometry.values():
            if len(getattr(geometry, "faces", ())):
                unplaced += int((~np.isfinite(geometry.vertices).all(axis=1))[geometry.faces].any(axis=1).sum())
                geometry.process()
        if scene.units is not None:  # COLLADA's <unit meter="0.001">, which RViz and Gazebo apply too
            scene = scene.convert_units("meters")
        if file.suffix.lower() == ".gltf":  # Drake draws the file itself, turned to z-up: turn its hull, too
            scene.apply_transform(Z_UP_TO_Y_UP.T)  # type: ignore[no-untyped-call]
        return scene, unplaced


def _resolver(file: Path) -> Any:
    """Return what finds a mesh's pictures also outside its folder: Gazebo's models have them in ../materials."""
    from trimesh.resolvers import FilePathResolver

    class Resolver(FilePathResolver):
        def get(self, name: str) -> bytes:
            beside = file.parent / unquote(name.strip()).removeprefix("file://")
            return beside.read_bytes() if beside.is_file() else super().get(name)

    return Resolver(str(file))


def _check_corners_of_dae(file: Path) -> None:
    """Refuse corners that are not finite numbers: the reader of COLLADA takes zeros instead."""
    content = file.read_bytes()
    if _NOT_FINITE.search(content) is None:
        return
    root = etree.fromstring(content, etree.XMLParser(huge_tree=True))
    inputs = root.iterfind(".//{*}vertices/{*}input[@semantic='POSITION']")
    sources = {each.get("source", "").removeprefix("#") for each in inputs}
    for numbers in root.iterfind(".//{*}source/{*}float_array"):
        source = numbers.getparent()
        if source is not None and source.get("id") in sources and _NOT_FINITE.search(etree.tostring(numbers)):
            raise InputError("the mesh has a corner that is not a finite point", file=file)


def _with_all_images(file: Path) -> bytes | None:
    """Return a DAE file with an image for each that a texture names by its file alone; None where none does.

    The reader of COLLADA leaves out such a material, and with it the triangles that have it.
    """
    content = file.read_bytes()
    images = set(_IMAGE.findall(content))
    unknown = sorted({name.strip() for name in _IMAGE_OF_SURFACE.findall(content)} - images)
    if not unknown:
        return None
    root = etree.fromstring(content, etree.XMLParser(huge_tree=True))
    kind = etree.QName(root).namespace
    library = root.find("{*}library_images")
    if library is None:
        library = etree.SubElement(root, etree.QName(kind, "library_images"))
    for name in unknown:
        image = etree.SubElement(library, etree.QName(kind, "image"), id=name.decode(errors="replace"))
        etree.SubElement(image, etree.QName(kind, "init_from")).text = name.decode(errors="replace")
    return etree.tostring(root)


def single_mesh(scene: Any, file: Path) -> Any:
    """Return all triangles of a mesh file's scene in one trimesh.

    Raises:
        InputError: If it has no triangles or too many, or if they are not in space.
    """
    with reading(file):
        mesh = scene.to_mesh()
    if len(getattr(mesh, "faces", ())) == 0:
        raise InputError("the mesh holds no triangles", file=file)
    _check_count(file, len(mesh.faces))
    if mesh.vertices.shape[1:] != (3,) or not np.all(np.abs(mesh.vertices) < LARGEST):
        raise InputError("the mesh has vertices that are not finite points in space", file=file)
    return mesh
