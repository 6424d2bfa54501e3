"""Registries: the kinds that the twin has several of, by name, its own and those of other packages.

A kind is a class or a function with its registry's decorator, and nothing else lists it. The twin's own are found by
the text of their modules. Another package names its module in its ``pyproject.toml``::

    [project.entry-points."drake_twin.repairs"]
    my_repairs = "my_package.repairs"
"""

import contextlib
import os
import re
import sys
from collections import ChainMap
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from functools import cache, cached_property
from importlib import import_module
from pathlib import Path
from types import ModuleType
from typing import TYPE_CHECKING, Any, Generic, TypeVar

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError

if TYPE_CHECKING:
    from importlib.metadata import EntryPoint

_GROUP = re.compile(r"^\[(.+?)\]\s*$", re.MULTILINE)
_writes_no_bytecode = sys.dont_write_bytecode

_K = TypeVar("_K")

# The modules of other packages that have registered something, or are about to.
MODULES_OF_OTHERS: set[str] = set()


@dataclass(frozen=True)
class _Entry(Generic[_K]):
    kind: _K
    module: str
    code: str  # its qualified name in the module
    about: str  # the first line of its documentation

    @property
    def is_own(self) -> bool:
        return self.module.startswith("drake_twin.")


def is_module_of_others(name: str) -> bool:
    """Tell whether a module is of a package that has registered something."""
    top = name.partition(".")[0]
    return any(other.partition(".")[0] == top for other in MODULES_OF_OTHERS)


def place_of_others(error: BaseException) -> str | None:
    """Return the file and line of another package's code that an exception comes from; None if none is in it."""
    found, at = None, error.__traceback__
    while at is not None:
        if is_module_of_others(str(at.tb_frame.f_globals.get("__name__", ""))):
            found = f"{at.tb_frame.f_code.co_filename}:{at.tb_lineno}"
        at = at.tb_next
    return found


class Registry(Mapping[str, _K]):
    """Kinds by name; looking one up imports the modules that name it, and iterating imports all.

    A module of the twin is one with the decorator in its text. Only those that also have the name, in quotes or
    backticks, are imported to look it up, then the others, and then those of other packages.

    Args:
        noun: What a kind is called in messages, ``sensor type``.
        decorator: The name of the decorator.
        group: The entry-point group in which other packages name their modules.
        packages: The packages with the twin's own modules.
        first: Modules whose kinds come first, in this order; other modules follow by name.
        failed: Called with what is wrong with an entry point; without it, that is an error.
    """

    def __init__(
        self,
        noun: str,
        decorator: str,
        group: str,
        packages: Sequence[str],
        first: Sequence[str] = (),
        failed: Callable[[str], None] | None = None,
    ):
        self.noun, self.group = noun, group
        self._decorator, self._packages, self._first, self._failed = f"@{decorator}", packages, first, failed
        self._kinds: ChainMap[str, _Entry[_K]] = ChainMap()

    def add(self, name: str, kind: _K, code: Callable[..., Any], *, replace: bool = False) -> None:
        """Register a kind.

        Args:
            name: Its name.
            kind: What the registry has under it.
            code: The decorated class or function.
            replace: Whether other code that is registered under the name is replaced.

        Raises:
            InputError: If other code is registered under the name, and not replaced.
        """
        about = (code.__doc__ or "").strip().partition("\n")[0]
        entry = _Entry(kind, code.__module__, code.__qualname__, about)
        if not entry.is_own:
            MODULES_OF_OTHERS.add(entry.module)
            self._import_own(name)  # which takes its name, whether or not it was looked up before
        known = self._kinds.get(name, entry)
        if (known.module, known.code) != (entry.module, entry.code) and not replace:
            raise InputError(f"{self.noun} {name!r} is registered by {known.module} and by {entry.module}")
        (self._kinds.maps[-1] if entry.is_own else self._kinds)[name] = entry

    def is_of_others(self, name: str) -> bool:
        """Tell whether another package has registered a name."""
        return name in self._kinds and not self._kinds[name].is_own

    @property
    def modules(self) -> frozenset[str]:
        """The modules that have registered something so far."""
        return frozenset(entry.module for entry in self._kinds.values())

    def unknown(self, name: str, others: Iterable[str] = ()) -> InputError:
        """Return an error about a name that no kind has, with those there are and others."""
        return InputError(f"unknown {self.noun} {name!r}", value=name, valid=sorted((*self, *others)))

    def described(self) -> Iterator[str]:
        """Yield a line for each kind: its name, what it is, and the module of one of another package."""
        for name in self:
            entry = self._kinds[name]
            yield ": ".join(filter(None, (name, entry.about))) + ("" if entry.is_own else f" ({entry.module})")

    def __getitem__(self, name: str) -> _K:
        if name not in self._kinds:
            self._import_own(name)
        if name not in self._kinds:
            self._import_own()
        if name not in self._kinds:
            self._import_others()
        return self._kinds[name].kind

    def __iter__(self) -> Iterator[str]:
        self._import_own()
        self._import_others()
        ranks = {module: rank for rank, module in enumerate(self._own)}
        return iter(sorted(self._kinds, key=lambda name: ranks.get(self._kinds[name].module, len(ranks))))

    def __len__(self) -> int:
        return sum(1 for _ in self)

    @contextlib.contextmanager
    def passing(self) -> Iterator[None]:
        """Forget at the end what others have registered in between in modules that are not imported any more."""
        self._kinds = self._kinds.new_child()
        try:
            yield
        finally:
            (passing, *_), self._kinds = self._kinds.maps, self._kinds.parents
            self._kinds.update((name, entry) for name, entry in passing.items() if entry.module in sys.modules)

    @cached_property
    def _own(self) -> dict[str, str]:
        """The twin's own modules that register a kind, in order → their text."""
        found = {}
        ranks = {name: rank for rank, name in enumerate(self._first)}
        for package in self._packages:
            files = [file for folder in import_own(package).__path__ for file in Path(folder).glob("*.py")]
            for file in sorted(files, key=lambda file: (ranks.get(file.stem, len(ranks)), file.stem)):
                text = file.read_text(encoding="utf-8")
                if f"\n{self._decorator}" in text and re.search(rf"^{self._decorator}\b", text, re.MULTILINE):
                    found[f"{package}.{file.stem}"] = text
        return found

    def _import_own(self, name: str | None = None) -> None:
        """Import the twin's own modules, or those that name a kind."""
        for module, text in self._own.items():
            if name is None or any(f"{mark}{name}{mark}" in text for mark in '"`'):
                import_own(module)

    def _import_others(self) -> None:
        load_extensions(self.group, self._failed)


def import_own(module: str) -> ModuleType:
    """Import a module of the twin, also while launch files run.

    No bytecode is written then, to leave no trace in other people's packages. That of the twin's modules is.
    """
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, _writes_no_bytecode
    try:
        return import_module(module)
    finally:
        sys.dont_write_bytecode = before


@cache
def load_extensions(group: str, failed: Callable[[str], None] | None = None) -> None:
    """Import the modules that installed packages name in an entry-point group, once in a process.

    Args:
        group: The group.
        failed: Called with what is wrong with an entry point; without it, that is an error.

    Raises:
        InputError: If a module cannot be imported.
    """
    for point in entry_points_of(group):
        try:
            point.load()
        except Exception as error:  # another package's code
            what = f"the entry point {point.name} = {point.value} of {group} cannot be loaded"
            what += f" ({type(error).__name__}: {error})"
            if failed is None:
                raise InputError(what) from error
            failed(what)


def entry_points_of(group: str) -> "Sequence[EntryPoint]":
    """Return the entry points of a group that installed packages name.

    Importing importlib.metadata takes 40 ms of each start, the search before it 1 ms, and most often finds nothing.
    """
    if group not in _named_groups():
        return ()
    from importlib.metadata import entry_points

    return tuple(entry_points(group=group))


def has_entry_points() -> bool:
    """Tell whether an installed package names modules for the twin."""
    return any(group.startswith("drake_twin.") for group in _named_groups())


@cache
def _named_groups() -> frozenset[str]:
    """Collect the groups that installed packages name."""
    found: set[str] = set()
    for folder in sys.path:
        with contextlib.suppress(OSError):  # no folder, or an unreadable one
            for entry in os.scandir(folder or "."):
                if entry.name.endswith((".dist-info", ".egg-info")):
                    with contextlib.suppress(OSError), open(f"{entry.path}/entry_points.txt", errors="replace") as file:
                        found.update(_GROUP.findall(file.read()))
    return frozenset(found)
