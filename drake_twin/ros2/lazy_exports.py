"""The names of a stand-in package, each imported from its module when it is first asked for."""

import importlib
import sys
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any

_TREE = __package__
_writes_no_bytecode = sys.dont_write_bytecode

# Package → name → the module that holds it.
EXPORTS: dict[str, dict[str, str]] = {}


def import_own(module: str) -> ModuleType:
    """Import a module of the twin, also while launch files run.

    No bytecode is written then, to leave no trace in other people's packages. That of the twin's modules is.
    """
    before, sys.dont_write_bytecode = sys.dont_write_bytecode, _writes_no_bytecode
    try:
        return importlib.import_module(module)
    finally:
        sys.dont_write_bytecode = before


def lazy_exports(package: str, exports: Mapping[str, str]) -> tuple[list[str], Callable[[str], Any]]:
    """Return ``__all__`` and ``__getattr__`` of a package of stand-ins.

    Args:
        package: The package's ``__name__``.
        exports: Module → the names that the package exports from it, separated by spaces. A module is a file of the
            package, or a module of ROS such as ``launch.events.matchers``.
    """
    modules = {
        name: f"{_TREE if '.' in module else package}.{module}"
        for module, names in exports.items()
        for name in names.split()
    }
    EXPORTS[package] = modules

    def attribute(name: str) -> Any:
        if name not in modules:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        value = getattr(import_own(modules[name]), name)
        setattr(sys.modules[package], name, value)
        return value

    return sorted(modules), attribute
