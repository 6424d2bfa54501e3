"""ROS's message packages as Python modules, for node programs.

``Interfaces(folder_of).source`` returns the modules that node programs import: ``geometry_msgs.msg``, ``std_srvs.srv``,
``control_msgs.action``, … of all types that drake_twin knows, and of those that ``.msg``, ``.srv`` and ``.action``
files of the workspace's packages define, which are read when a type is first asked for. It changes nothing itself:
who puts the modules into ``sys.modules`` takes them out again. The classes are the same in all of them;
`drake_twin.nodes.message_classes` makes their messages and the twin's own of each other.
"""

from collections.abc import Callable
from functools import cache
from importlib.machinery import PathFinder
from pathlib import Path
from types import ModuleType
from typing import Any

from drake_twin.description.python_modules import python_modules
from drake_twin.errors import InputError
from drake_twin.messages import interface_types, store
from drake_twin.nodes.interface_files import KINDS, InterfaceFiles
from drake_twin.nodes.message_classes import action_class, message_class, module_name, service_class

_MAKERS = {"msg": message_class, "srv": service_class, "action": action_class}


class Interfaces:
    """The modules of message packages.

    Args:
        folder_of: Returns the share folder of a package of the workspace, as it looks once installed; None without one.
    """

    def __init__(self, folder_of: Callable[[str], Path | None] = lambda name: None):
        self._folder_of = folder_of
        self._files = InterfaceFiles(folder_of)
        self._own = _own_packages()
        self._modules: dict[str, ModuleType | None] = {}

    def source(self, name: str) -> ModuleType | None:
        """Return a module; None if it is not one of a message package.

        A package that has Python modules of its own, too, is left to others, but for its ``msg``, ``srv``, ``action``.

        Args:
            name: The module's full name: ``geometry_msgs``, ``geometry_msgs.msg`` or ``geometry_msgs.msg._twist``.
        """
        if "." not in name:  # where packages of Python are found depends on the program that asks
            return self._package(name)
        if name not in self._modules:
            self._modules[name] = self._made(name)
        return self._modules[name]

    def find(self, name: str) -> type:
        """Return the class of a message, a service or an action.

        Args:
            name: Its type, for example ``my_msgs/srv/Start``.

        Raises:
            InputError: If the type does not exist, or a file of the workspace that it needs is wrong.
        """
        self._files.load(name)
        try:
            return _MAKERS[name.split("/")[1]](name)
        except ValueError as error:
            raise InputError(f"{name}: {error}") from error

    def _made(self, name: str) -> ModuleType | None:
        package, kind, *inner = name.split(".")
        if kind not in KINDS or len(inner) > 1 or not (names := self._names(package, kind)):
            return None
        if not inner:
            return self._kind(name, names)
        return self._file(name, [each for each in names if module_name(f"{package}/{kind}/{each}") == name])

    def _names(self, package: str, kind: str) -> list[str]:
        names = self._files.names(package, kind)
        if names and not store.is_of_the_twin(package):
            return names
        return sorted({*interface_types.known_names(package, kind), *names})

    def _package(self, name: str) -> ModuleType | None:
        if name not in self._own and (
            PathFinder.find_spec(name) is not None
            or (folder := self._folder_of(name)) is None
            or name in python_modules(folder)
            or not any(self._files.names(name, kind) for kind in KINDS)
        ):
            return None
        return _package_module(name)

    def _kind(self, name: str, names: list[str]) -> ModuleType:
        module = _package_module(name)
        prefix = name.replace(".", "/")

        def attribute(own: str) -> Any:
            if own not in names:
                raise AttributeError(f"module {name!r} has no attribute {own!r}")
            found = self.find(f"{prefix}/{own}")
            setattr(module, own, found)
            return found

        vars(module).update(__all__=names, __getattr__=attribute, __dir__=lambda: [*vars(module), *names])
        return module

    def _file(self, name: str, names: list[str]) -> ModuleType | None:
        """Return the module of one type, which has the classes of its parts beside it."""
        if not names:
            return None
        module = ModuleType(name)
        pending: list[Any] = [self.find(f"{'/'.join(name.split('.')[:2])}/{own}") for own in names]
        while pending:
            found = pending.pop()
            vars(module).setdefault(found.__name__, found)
            parts = (value for value in vars(found).values() if isinstance(value, type))
            pending += (part for part in parts if part.__module__ == name)
        return module


@cache
def _own_packages() -> frozenset[str]:
    """Return the packages of types that drake_twin knows before any file is read."""
    return interface_types.known_packages()


def _package_module(name: str) -> ModuleType:
    module = ModuleType(name)
    module.__path__ = []
    return module
