"""The commands of a ``meshcat-server``, each as the frames of a ZeroMQ message; it answers each with ``ok``."""

from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
import umsgpack

ASK_FOR_PAGE = (b"url",)  # answered with the address of the page

Command = tuple[bytes, ...]

_FLOAT64 = np.dtype([("mark", "u1"), ("value", ">f8")])  # a number as MessagePack writes it
_ARRAY_OF_16 = b"\xdc\x00\x10"


def set_object(path: str, three_js: dict[str, Any]) -> Command:
    """Return the command that puts an object at a path, in place of the one there."""
    return _command("set_object", path, {"object": three_js})


def delete(path: str) -> Command:
    """Return the command that deletes a path and all below it."""
    return _command("delete", path, {})


def set_property(path: str, name: str, value: object) -> Command:
    """Return the command that sets a property of three.js at a path."""
    return _command("set_property", path, {"property": name, "value": value})


def set_transform(path: str, matrix: np.ndarray) -> Command:
    """Return the command that sets the pose of a path in its parent (4x4)."""
    return next(TransformWriter([path]).commands(matrix[np.newaxis], [0]))


class TransformWriter:
    """Writes the poses of the same paths repeatedly.

    MessagePack in Python takes a hundred times as long for the sixteen numbers, and would delay the simulation's
    thread, which shares the interpreter.

    Args:
        paths: The paths.
    """

    def __init__(self, paths: Sequence[str]):
        self._paths = [path.encode() for path in paths]
        self._heads = [self._head(path) for path in paths]

    def commands(self, poses: np.ndarray, which: Sequence[int]) -> Iterator[Command]:
        """Yield the commands that set poses.

        Args:
            poses: Poses of all paths in their parents, shape (paths, 4, 4).
            which: The rows to write.
        """
        numbers = np.empty((len(which), 16), dtype=_FLOAT64)
        numbers["mark"] = 0xCB
        numbers["value"] = poses[which].transpose(0, 2, 1).reshape(len(which), 16)  # column by column
        for index, row in zip(which, numbers, strict=True):
            yield b"set_transform", self._paths[index], self._heads[index] + row.tobytes()

    @staticmethod
    def _head(path: str) -> bytes:
        words = ("type", "set_transform", "path", path, "matrix")
        return b"\x83" + b"".join(map(umsgpack.packb, words)) + _ARRAY_OF_16


def _command(kind: str, path: str, more: dict[str, Any]) -> Command:
    return kind.encode(), path.encode(), umsgpack.packb({"type": kind, "path": path, **more})
