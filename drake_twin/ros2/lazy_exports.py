"""The names of a stand-in package, each imported from its module when it is first asked for."""

import re
import sys
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from drake_twin.extensions import import_own

_TREE = __package__
_CLASS = re.compile(r"^(?:class )?([A-Z]\w*[a-z]\w*)(?=[(:]| = )", re.MULTILINE)

# Package → name → the module that holds it.
EXPORTS: dict[str, dict[str, str]] = {}


def classes_in(package: str) -> dict[str, str]:
    """Return the public classes of a package's modules, and their other names, as `lazy_exports` takes them.

    Args:
        package: The package's ``__file__``.
    """
    return {
        file.stem: " ".join(_CLASS.findall(file.read_text(encoding="utf-8")))
        for file in sorted(Path(package).parent.glob("[a-z]*.py"))
    }


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
