"""The ``.msg``, ``.srv`` and ``.action`` files of a workspace's packages, read when a type is first asked for."""

import logging
import os
from collections.abc import Callable, Iterator
from itertools import chain
from pathlib import Path
from typing import Any

from drake_twin.description.source_file import file_text
from drake_twin.errors import InputError
from drake_twin.messages import interface_types, store
from drake_twin.messages.store import EMPTY

KINDS = ("msg", "srv", "action")
_PARTS = {"msg": 1, "srv": 2, "action": 3}

_added: dict[str, tuple[Path, str]] = {}  # type → the file that it was read from, and its text
_log = logging.getLogger(__name__)


class InterfaceFiles:
    """The types that the packages of a workspace define.

    They count before those that drake_twin knows, but for types that the twin itself uses: a file that defines one of
    these differently is warned about.

    Args:
        folder_of: Returns the share folder of a package, as it looks once installed; None without one.
    """

    def __init__(self, folder_of: Callable[[str], Path | None]):
        self._folder_of = folder_of
        self._compared: set[str] = set()
        self._loading: list[str] = []

    def names(self, package: str, kind: str) -> list[str]:
        """Return the types of a kind (``msg``, ``srv``, ``action``) that a package's files define."""
        folder = self._folder_of(package)
        if folder is None:
            return []
        return sorted(file.stem for file in (folder / kind).glob(f"*.{kind}"))

    def load(self, name: str) -> None:
        """Let drake_twin know a type and those in it.

        Args:
            name: The type, for example ``my_msgs/srv/Start``.

        Raises:
            InputError: If a file cannot be read, has a wrong line or a type that does not exist, or if a workspace
                of this process has defined the type differently.
        """
        file = self._file(name)
        own = name not in _added and store.is_settled(name)
        if file is None or (own and name in self._compared):
            return
        self._compared.add(name)
        text = _text(file)
        if own:
            if [[field for _, field in part] for part in _parts(name, text, file)] != _known_fields(name):
                _log.warning("%s: drake_twin has %s with other fields, which count", file, name)
            return
        if name in _added:
            before, known = _added[name]
            if known != text:
                raise InputError(f"{name} is defined differently in {before}, which was read before", file=file)
            return
        for line, kind in _messages_in(_parts(name, text, file)):
            if kind in (*self._loading, name):
                raise InputError(f"{name} has a field of {kind}, which is made of {name}", file=file, line=line)
            self._loading.append(name)
            try:
                self.load(kind)
            finally:
                self._loading.pop()
            if not interface_types.knows(kind):
                what = f"type {kind} does not exist"
                raise InputError(what, file=file, line=line)
        store.add_definition(name, text)
        _added[name] = file, text

    def _file(self, name: str) -> Path | None:
        package, kind, own = name.split("/")
        folder = self._folder_of(package)
        file = None if folder is None else folder / kind / f"{own}.{kind}"
        return file if file is not None and os.path.isfile(file) else None


def _text(file: Path) -> str:
    try:
        lines = file_text(file, "utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise InputError(f"the file cannot be read ({error})", file=file) from error
    return "".join(f"{line.rstrip()}\n" for line in lines)


def _parts(name: str, text: str, file: Path) -> list[list[tuple[int, Any]]]:
    """Return the fields of each part of a definition, each with its line."""
    parts: list[list[tuple[int, Any]]] = [[]]
    for number, line in enumerate(text.splitlines(), 1):
        if line == "---":
            parts.append([])
        else:
            for field in _fields_of_line(name, line, number, file):
                if any(field[0] == other for _, (other, _) in parts[-1]):
                    raise InputError(f"there are several fields {field[0]!r}", file=file, line=number)
                parts[-1].append((number, field))
    kind = name.split("/")[1]
    count = _PARTS[kind]
    if len(parts) != count:
        what = f"a {kind} file needs {count - 1} lines of ---, but it has {len(parts) - 1}"
        raise InputError(what, file=file)
    return parts


def _known_fields(name: str) -> list[Any]:
    ends = {"msg": [""], "srv": ["_Request", "_Response"], "action": ["_Goal", "_Result", "_Feedback"]}
    known = [interface_types.fields_of(f"{name}{end}")[1] for end in ends[name.split("/")[1]]]
    return [[field for field in fields if field[0] != EMPTY] for fields in known]


def _messages_in(parts: list[list[tuple[int, Any]]]) -> Iterator[tuple[int, str]]:
    """Yield the messages in a definition's fields, each with its line."""
    from rosbags.interfaces import Nodetype

    for number, (_, (node, details)) in chain.from_iterable(parts):
        element = details[0] if node in (Nodetype.ARRAY, Nodetype.SEQUENCE) else (node, details)
        if element[0] == Nodetype.NAME:
            yield number, element[1]


def _fields_of_line(name: str, line: str, number: int, file: Path) -> Any:
    from rosbags.typesys import TypesysError

    try:
        fields = store.fields_in(name, f"{line}\n")[1]
        store.default_in(line, fields)
    except TypesysError as error:
        what = f"{line.strip()!r} is neither a field (TYPE NAME) nor a constant (TYPE NAME=VALUE) of ROS 2"
        raise InputError(what, file=file, line=number) from error
    except ValueError as error:
        raise InputError(f"wrong default value: {error}", file=file, line=number) from error
    return fields
