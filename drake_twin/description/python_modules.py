"""The Python modules of a ROS package: what ``import`` finds once it is installed, found in its sources.

A module need not have the package's name, nor lie in a folder of its own name: ``package_dir`` of a setup.py or
setup.cfg and ``PACKAGE_DIR`` of ``ament_python_install_package`` say where it is.
"""

from collections.abc import Iterable, Iterator
from functools import lru_cache
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import spec_from_file_location
from pathlib import Path

from drake_twin.description.cmake_install import cmake_installs
from drake_twin.description.setup_expressions import read_setup_cfg, read_setup_py
from drake_twin.description.share_layout import package_name


def source_of(package: Path) -> Path:
    """Return the source folder of a package that looks as if it were installed."""
    file = package / "package.xml"
    return file.resolve().parent if file.is_symlink() else package.resolve()


@lru_cache(maxsize=1024)
def python_modules(package: Path) -> dict[str, Path]:
    """Return the top-level modules of a package by name: the folder of a Python package, or the file of a module.

    Args:
        package: The folder with the package.xml, of a source or an installed package.
    """
    package = source_of(package)
    found: dict[str, Path] = {}
    for name, place in (*_of_setup(package), *_of_cmake(package)):
        found.setdefault(name, place)
    own = package_name(package)
    installed = package.parents[1].glob("lib/python3*/*-packages") if package.parent.name == "share" else ()
    for folder in (package, package / "src", *installed):
        if (folder / own).is_dir():
            found.setdefault(own, folder / own)
    return found


def module_spec(name: str, packages: Iterable[Path]) -> ModuleSpec | None:
    """Return how to import a top-level module from the first of some packages that has it; None if none has."""
    for package in packages:
        place = python_modules(package).get(name)
        if place is None:
            continue
        if place.stem == name:
            return PathFinder.find_spec(name, [str(place.parent)])
        if (place / "__init__.py").is_file():
            return spec_from_file_location(name, place / "__init__.py", submodule_search_locations=[str(place)])
    return None


def _of_setup(package: Path) -> Iterator[tuple[str, Path]]:
    setup, configured = read_setup_py(package), read_setup_cfg(package)
    folders = dict(setup.package_dir)
    for line in configured.get("options", "package_dir", fallback="").splitlines():
        name, equals, folder = line.partition("=")
        if equals:
            folders[name.strip()] = folder.strip()
    root = package / folders.pop("", "")
    for name, folder in folders.items():
        if "." not in name and (package / folder).is_dir():
            yield name, package / folder
    for name in setup.packages:
        if "." not in name and (root / name).is_dir():
            yield name, root / name
    if root != package and root.is_dir():  # whatever find_packages() finds there
        yield from ((file.parent.name, file.parent) for file in sorted(root.glob("*/__init__.py")))
    for name in setup.py_modules:
        if (file := root / f"{name}.py").is_file():
            yield name, file


def _of_cmake(package: Path) -> Iterator[tuple[str, Path]]:
    if (package / "CMakeLists.txt").is_file():
        yield from cmake_installs(package, package_name(package), "python")
