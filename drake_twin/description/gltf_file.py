"""glTF files, checked before Drake and trimesh read them: VTK ends the process at an index that is out of range.

Only what the format's specification (2.0) says of numbers and indexes is checked, and nothing of how a mesh looks.
"""

import base64
import binascii
import json
import math
import struct
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, TypeGuard
from urllib.parse import unquote

import numpy as np

from drake_twin.description.source_file import MOST_BYTES, check_regular, file_bytes
from drake_twin.errors import InputError
from drake_twin.values import LARGEST

_DEEPEST = 500  # levels of nodes
_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
_ELEMENTS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}
_LISTS = (
    *("buffers", "bufferViews", "accessors", "meshes", "nodes", "scenes", "materials", "textures", "images"),
    *("samplers", "skins", "animations", "cameras"),
)
_GLB_HEAD = 12


class _WrongError(Exception):
    """What is wrong with a document."""


def check_gltf(file: Path) -> None:
    """Check a glTF or GLB file.

    Raises:
        InputError: If it is not glTF, one of its numbers is out of range, or a file that it names cannot be read.
        OSError: If it cannot be read.
    """
    try:
        _Document(file).check()
    except _WrongError as error:
        raise InputError(f"the mesh is not valid glTF: {error}", file=file) from None


class _Document:
    def __init__(self, file: Path):
        self._file = file
        text, self._binary = _parts(file)
        try:
            document = json.loads(text)
        except (ValueError, RecursionError) as error:
            raise _WrongError(f"its JSON cannot be read ({str(error)[:100]})") from None
        if not isinstance(document, dict):
            raise _WrongError("its JSON is not an object")
        self._root: dict[str, Any] = document
        self._lists = {name: self._list(document, name) for name in _LISTS}
        self._buffers: list[bytes] = []

    def check(self) -> None:
        self._read_buffers()
        for number, view in enumerate(self._lists["bufferViews"]):
            self._check_view(view, f"bufferViews[{number}]")
        for number, accessor in enumerate(self._lists["accessors"]):
            self._check_accessor(accessor, f"accessors[{number}]")
        for number, mesh in enumerate(self._lists["meshes"]):
            for index, primitive in enumerate(self._list(mesh, "primitives")):
                self._check_primitive(primitive, f"meshes[{number}].primitives[{index}]")
        self._check_nodes()
        self._check_looks()
        self._check_motion()

    def _list(self, holder: Mapping[str, Any], name: str) -> list[dict[str, Any]]:
        """Return a list of objects; empty without one."""
        found = holder.get(name, [])
        if not isinstance(found, list) or not all(isinstance(item, dict) for item in found):
            raise _WrongError(f"{name} is not a list of objects")
        return found

    def _index(self, holder: Mapping[str, Any], name: str, of: str, where: str, *, needed: bool = False) -> int | None:
        """Return an index into one of the document's lists; None without one."""
        if name not in holder and not needed:
            return None
        return self._in_list(holder.get(name), of, f"{where}.{name}")

    def _in_list(self, index: Any, of: str, where: str) -> int:
        count = len(self._lists[of])
        if not _is_whole(index) or not 0 <= index < count:
            raise _WrongError(f"{where} is {_shown(index)}, and there are {count} {of}")
        return index

    def _number(self, holder: Mapping[str, Any], name: str, low: int, where: str, default: int | None = None) -> int:
        value = holder.get(name, default)
        if not _is_whole(value) or not low <= value <= MOST_BYTES:
            raise _WrongError(f"{where}.{name} is {_shown(value)}, which must be from {low} to {MOST_BYTES}")
        return value

    def _read_buffers(self) -> None:
        for number, buffer in enumerate(self._lists["buffers"]):
            where = f"buffers[{number}]"
            length = self._number(buffer, "byteLength", 1, where)
            uri = buffer.get("uri")
            data = self._binary if uri is None and number == 0 else self._content(uri, where)
            if data is None or len(data) < length:
                raise _WrongError(f"{where} has {len(data or b'')} bytes, not {length}")
            self._buffers.append(data[:length])
        if sum(map(len, self._buffers)) > MOST_BYTES:
            raise _WrongError("its buffers have more than one gigabyte")

    def _content(self, uri: Any, where: str) -> bytes:
        """Return the content of an address."""
        if not isinstance(uri, str):
            raise _WrongError(f"{where}.uri is {_shown(uri)}")
        if uri.startswith("data:"):
            head, _, data = uri.partition(",")
            try:
                return base64.b64decode(data, validate=True) if head.endswith(";base64") else unquote(data).encode()
            except (binascii.Error, ValueError):
                raise _WrongError(f"{where}.uri is not valid base64") from None
        beside = self._beside(uri, where)
        return beside.read_bytes()

    def _beside(self, uri: str, where: str) -> Path:
        """Return the file of a relative address."""
        beside = self._file.parent / unquote(uri)
        try:
            check_regular(beside)
        except (OSError, ValueError) as error:
            reason = getattr(error, "strerror", None) or "not a name"
            raise _WrongError(f"{where}.uri names {uri[:100]!r}, which cannot be read ({reason})") from None
        except InputError as error:
            raise _WrongError(f"{where}.uri names {uri[:100]!r}: {error.message}") from None
        return beside

    def _check_view(self, view: Mapping[str, Any], where: str) -> None:
        buffer = self._index(view, "buffer", "buffers", where, needed=True)
        assert buffer is not None
        begin, length = self._number(view, "byteOffset", 0, where, 0), self._number(view, "byteLength", 1, where)
        if begin + length > len(self._buffers[buffer]):
            raise _WrongError(f"{where} ends at byte {begin + length} of {len(self._buffers[buffer])}")
        if "byteStride" in view and not 4 <= self._number(view, "byteStride", 4, where) <= 252:
            raise _WrongError(f"{where}.byteStride is {view['byteStride']}, which must be from 4 to 252")

    def _check_accessor(self, accessor: Mapping[str, Any], where: str) -> None:
        component, kind = accessor.get("componentType"), accessor.get("type")
        if not _is_whole(component) or component not in _COMPONENTS:
            raise _WrongError(f"{where}.componentType is {_shown(component)}")
        if not isinstance(kind, str) or kind not in _ELEMENTS:
            raise _WrongError(f"{where}.type is {_shown(kind)}")
        count = self._number(accessor, "count", 1, where)
        size = _ELEMENTS[kind] * np.dtype(_COMPONENTS[component]).itemsize
        self._check_span(accessor, size, count, where)
        for name in ("min", "max"):
            if name in accessor:
                _check_numbers(accessor[name], _ELEMENTS[kind], f"{where}.{name}", farthest=math.inf)
        if "sparse" in accessor:  # which neither VTK nor trimesh reads right
            raise _WrongError(f"{where} is sparse, which is not read")

    def _check_span(self, holder: Mapping[str, Any], size: int, count: int, where: str) -> None:
        number = self._index(holder, "bufferView", "bufferViews", where)
        if number is None:
            if count * size > MOST_BYTES:
                raise _WrongError(f"{where}.count is {count}")
            return
        view = self._lists["bufferViews"][number]
        stride = view.get("byteStride", size)
        end = self._number(holder, "byteOffset", 0, where, 0) + stride * (count - 1) + size
        if end > view["byteLength"]:
            raise _WrongError(f"{where} ends at byte {end} of the {view['byteLength']} of its bufferView")

    def _check_primitive(self, primitive: Mapping[str, Any], where: str) -> None:
        attributes = primitive.get("attributes")
        if not isinstance(attributes, dict):
            raise _WrongError(f"{where} has no attributes")
        accessors = {
            name: self._lists["accessors"][self._in_list(index, "accessors", f"{where}.{name}")]
            for name, index in attributes.items()
        }
        if len({accessor["count"] for accessor in accessors.values()}) > 1:
            raise _WrongError(f"{where}: its attributes have different counts")
        self._index(primitive, "material", "materials", where)
        if primitive.get("mode", 4) not in range(7):
            raise _WrongError(f"{where}.mode is {_shown(primitive['mode'])}")
        position = accessors.get("POSITION")
        if position is None:
            return
        if (position["type"], position["componentType"]) != ("VEC3", 5126):
            raise _WrongError(f"{where}.POSITION is not of three floats")
        points = self._values(position)
        if not (np.abs(points) < LARGEST).all():
            raise _WrongError(f"{where} has a corner that is not a finite point")
        if (number := self._index(primitive, "indices", "accessors", where)) is not None:
            indices = self._lists["accessors"][number]
            if indices["type"] != "SCALAR" or indices["componentType"] not in (5121, 5123, 5125):
                raise _WrongError(f"{where}.indices are not whole numbers")
            highest = int(self._values(indices).max())
            if highest >= position["count"]:
                raise _WrongError(f"{where} has the corner {highest} of {position['count']}")

    def _values(self, accessor: Mapping[str, Any]) -> np.ndarray:
        """Return an accessor's numbers, a row for each element."""
        kind, columns = np.dtype(_COMPONENTS[accessor["componentType"]]), _ELEMENTS[accessor["type"]]
        shape = (accessor["count"], columns)
        if "bufferView" not in accessor:
            return np.zeros(shape, kind)
        view = self._lists["bufferViews"][accessor["bufferView"]]
        begin = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        strides = (view.get("byteStride", kind.itemsize * columns), kind.itemsize)
        return np.ndarray(shape, kind, self._buffers[view["buffer"]], begin, strides)

    def _check_nodes(self) -> None:
        nodes = self._lists["nodes"]
        children: list[list[int]] = []
        parents: set[int] = set()
        for number, node in enumerate(nodes):
            where = f"nodes[{number}]"
            for name, of in (("mesh", "meshes"), ("skin", "skins"), ("camera", "cameras")):
                self._index(node, name, of, where)
            for name, count in (("matrix", 16), ("translation", 3), ("rotation", 4), ("scale", 3)):
                if name in node:
                    _check_numbers(node[name], count, f"{where}.{name}")
            own = self._indexes(node, "children", "nodes", where)
            if parents.intersection(own) or len(set(own)) < len(own):
                raise _WrongError(f"{where} has a child that another node has, too")
            parents.update(own)
            children.append(own)
        level, depth, visited = [number for number in range(len(nodes)) if number not in parents], 0, 0
        while level:
            depth, visited = depth + 1, visited + len(level)
            if depth > _DEEPEST:
                raise _WrongError(f"its nodes are more than {_DEEPEST} levels deep")
            level = [child for number in level for child in children[number]]
        if visited < len(nodes):
            raise _WrongError("a node is below itself")
        for number, scene in enumerate(self._lists["scenes"]):
            self._indexes(scene, "nodes", "nodes", f"scenes[{number}]")
        self._index(self._root, "scene", "scenes", "the document")

    def _indexes(self, holder: Mapping[str, Any], name: str, of: str, where: str) -> list[int]:
        found = holder.get(name, [])
        if not isinstance(found, list):
            raise _WrongError(f"{where}.{name} is not a list")
        return [self._in_list(index, of, f"{where}.{name}") for index in found]

    def _check_looks(self) -> None:
        for number, image in enumerate(self._lists["images"]):
            where = f"images[{number}]"
            uri = image.get("uri")
            if self._index(image, "bufferView", "bufferViews", where) is None and uri is None:
                raise _WrongError(f"{where} has no content")
            if uri is not None and not isinstance(uri, str):
                raise _WrongError(f"{where}.uri is {_shown(uri)}")
            if isinstance(uri, str) and not uri.startswith("data:") and (self._file.parent / unquote(uri)).exists():
                self._beside(uri, where)  # one that is missing is not drawn
        for number, texture in enumerate(self._lists["textures"]):
            self._index(texture, "source", "images", f"textures[{number}]")
            self._index(texture, "sampler", "samplers", f"textures[{number}]")
        for number, material in enumerate(self._lists["materials"]):
            for name, info in _textures(material):
                self._index(info, "index", "textures", f"materials[{number}].{name}", needed=True)

    def _check_motion(self) -> None:
        for number, skin in enumerate(self._lists["skins"]):
            self._indexes(skin, "joints", "nodes", f"skins[{number}]")
            self._index(skin, "inverseBindMatrices", "accessors", f"skins[{number}]")
            self._index(skin, "skeleton", "nodes", f"skins[{number}]")
        for number, animation in enumerate(self._lists["animations"]):
            where = f"animations[{number}]"
            samplers = self._list(animation, "samplers")
            for sampler in samplers:
                for name in ("input", "output"):
                    self._index(sampler, name, "accessors", f"{where}.samplers", needed=True)
            for channel in self._list(animation, "channels"):
                index, target = channel.get("sampler"), channel.get("target")
                if not _is_whole(index) or not 0 <= index < len(samplers) or not isinstance(target, dict):
                    raise _WrongError(f"{where} has a channel without a sampler or a target")
                self._index(target, "node", "nodes", f"{where}.channels")


def _parts(file: Path) -> tuple[bytes, bytes | None]:
    """Return the JSON of a glTF or GLB file, and the latter's binary part."""
    data = file_bytes(file)
    if not data.startswith(b"glTF"):
        return data, None
    found: dict[bytes, bytes] = {}
    position = _GLB_HEAD
    while position + 8 <= len(data):
        length, kind = struct.unpack_from("<I4s", data, position)
        position += 8
        if position + length > len(data):
            raise _WrongError("it is cut off")
        found.setdefault(kind, data[position : position + length])
        position += length
    if b"JSON" not in found:
        raise _WrongError("it has no JSON")
    return found[b"JSON"], found.get(b"BIN\0")


def _textures(material: Mapping[str, Any], name: str = "", depth: int = 0) -> Iterator[tuple[str, dict[str, Any]]]:
    """Yield the textures that a material names, with their names, also those of its extensions."""
    for key, value in material.items():
        if isinstance(value, dict) and depth < 5 and key != "extras":
            if key.endswith("Texture"):
                yield name + key, value
            yield from _textures(value, f"{name}{key}.", depth + 1)


def _check_numbers(values: Any, count: int, where: str, farthest: float = LARGEST) -> None:
    are_numbers = isinstance(values, list) and all(
        isinstance(item, int | float) and not isinstance(item, bool) for item in values
    )
    if not are_numbers or len(values) != count or not all(abs(item) < farthest for item in values):
        raise _WrongError(f"{where} is {_shown(values)}, which must be {count} finite numbers")


def _is_whole(value: Any) -> TypeGuard[int]:
    return isinstance(value, int) and not isinstance(value, bool)


def _shown(value: Any) -> str:
    text = repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."
