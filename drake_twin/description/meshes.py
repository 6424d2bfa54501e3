"""Mesh files in the formats that Drake draws and collides, converted once and kept in the user's cache folder."""

import hashlib
import os
import tempfile
from pathlib import Path

from drake_twin.errors import InputError

# Drake takes these as they are, for the picture and for contact (of which it uses the convex hull).
_DRAKE_FORMATS = {".obj", ".gltf", ".vtk"}
_CONVERTED_FORMATS = {".stl", ".dae", ".ply", ".glb", ".off", ".3mf"}

# Part of every cached file's name: change it when the conversion below gives other files.
_CONVERSION = "2"


def mesh_for_drake(file: Path) -> Path:
    """The mesh itself where Drake reads its format, else its conversion to Wavefront OBJ.

    The cache is addressed by the mesh's content, so a changed mesh is converted anew and a moved one is not. Two
    processes may fill it at once: a file appears whole or not at all.

    Args:
        file: the mesh file.

    Raises:
        InputError: the format is not known, the file holds no triangles, or the cache cannot be written.
    """
    suffix = file.suffix.lower()
    if suffix in _DRAKE_FORMATS:
        return file
    if suffix not in _CONVERTED_FORMATS:
        raise InputError(
            f"the mesh format {suffix or 'without a suffix'!r} is not understood",
            file=file,
            valid=sorted(_DRAKE_FORMATS | _CONVERTED_FORMATS),
        )
    try:
        content = file.read_bytes()
    except OSError as error:
        raise InputError(f"the mesh cannot be read ({error.strerror})", file=file) from None
    digest = hashlib.sha256(content + suffix.encode() + _CONVERSION.encode()).hexdigest()
    cached = mesh_cache_folder() / f"{digest}.obj"
    if not cached.exists():
        _write_whole(cached, _as_obj(file))
    return cached


def mesh_cache_folder() -> Path:
    """``$XDG_CACHE_HOME/drake_twin/meshes``, or ``~/.cache/drake_twin/meshes``."""
    base = os.environ.get("XDG_CACHE_HOME") or Path.home() / ".cache"
    return Path(base).absolute() / "drake_twin" / "meshes"


def mesh_address(file: Path) -> str:
    """The address of a mesh for Drake's parser, which takes spaces and accents as they are, not as ``%20``."""
    return f"file://{file.absolute()}"


def _as_obj(file: Path) -> str:
    import trimesh  # a third of a second, and only the first start of a robot needs it

    try:
        mesh = trimesh.load_mesh(file)
        if mesh.units is not None:  # COLLADA's <unit meter="0.001">, which RViz and Gazebo apply too
            mesh.convert_units("meters")
    except ModuleNotFoundError:  # trimesh asks for one to guess the encoding of bytes that are no text
        raise InputError(f"the mesh is cut short, or no {file.suffix} file", file=file) from None
    except Exception as error:  # trimesh's readers raise whatever a broken file makes them stumble over
        raise InputError(f"the mesh cannot be read ({error})", file=file) from None
    if len(getattr(mesh, "faces", ())) == 0:
        raise InputError("the mesh holds no triangles", file=file)
    return str(mesh.export(file_type="obj", include_normals=True, include_color=False, include_texture=False))


def _write_whole(file: Path, text: str) -> None:
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.NamedTemporaryFile("w", dir=file.parent, suffix=".part", delete=False) as part:
            part.write(text)
        os.replace(part.name, file)
    except OSError as error:
        raise InputError(f"the mesh cache cannot be written ({error.strerror})", file=file.parent) from None
