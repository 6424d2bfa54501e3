"""The modules of the user's packages that register tags and substitutions of launch files.

A package names its launch extensions as entry points of the group ``launch.frontend.launch_extension``, for ROS, or of
one of the twin's. Its module is imported when a launch file has a tag or a substitution that is unknown without it.
"""

import ast
import importlib
import os
from collections.abc import Iterable, Iterator
from configparser import ConfigParser
from configparser import Error as ConfigError
from pathlib import Path

from drake_twin.description.package_index import containing_package, packages_in, workspace_of
from drake_twin.description.source_file import file_text
from drake_twin.extensions import entry_points_of
from drake_twin.ros2.evaluation import current_context
from drake_twin.ros2.launch.launch_context import LaunchContext

_GROUP = "launch.frontend.launch_extension"


def load_extensions(group: str) -> None:
    """Import the extensions that Python packages name in a group, and the launch extensions that are visible.

    An extension that fails is noted in the context, and ignored like in ROS.
    """
    context = current_context()
    for place, modules in _visible_extensions(context, group):
        if place in context.extensions:
            continue
        context.extensions[place] = ""
        for module in modules:
            try:
                importlib.import_module(module)
            except (Exception, SystemExit) as error:  # the package's code raises whatever it likes
                context.extensions[place] = f"the launch extension {module} fails ({error})"


def extension_problems() -> str:
    """Return the extensions that failed, as the end of an error message."""
    problems = [problem for problem in current_context().extensions.values() if problem]
    return "".join(f"; {problem}" for problem in problems)


def extension_modules(package: Path) -> Iterator[str]:
    """Yield the modules that a package names as launch extensions.

    Its setup.py and setup.cfg are read, not run.

    Args:
        package: The folder with the package.xml, of a source or an installed package.
    """
    if package.parent.name == "share":
        files = package.parents[1].glob(f"lib*/python3*/*-packages/{package.name}-*-info/entry_points.txt")
        lines = [line for file in files for line in _of_config(file, _GROUP)]
    else:
        lines = [*_of_config(package / "setup.cfg", "options.entry_points"), *_of_setup_py(package / "setup.py")]
    for line in lines:
        module = line.partition("=")[2].partition(":")[0].strip()
        if module:
            yield module


def _visible_extensions(context: LaunchContext, group: str) -> Iterator[tuple[str, Iterable[str]]]:
    """Yield groups of installed Python packages, and ROS packages: each with its modules."""
    for name in (group, _GROUP):
        yield name, (point.module for point in entry_points_of(name))
    for package in _visible_packages(context):
        yield str(package), extension_modules(package)


def _visible_packages(context: LaunchContext) -> Iterator[Path]:
    """Yield the package of the launch file at hand, its workspace's, and those in the folders that were named."""
    folders = list(context.packages.folders)
    file = context.current_launch_file
    own = None if file is None else containing_package(Path(file).resolve())
    if own is not None:
        yield own
        folders.append(workspace_of(own))
    prefixes = os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep)
    folders += [Path(prefix) / "share" for prefix in prefixes if prefix]
    for folder in folders:
        yield from packages_in(folder)


def _of_config(file: Path, section: str) -> list[str]:
    """Return the entry points, ``name = module``, in a section of entry_points.txt or setup.cfg."""
    parser = ConfigParser(delimiters=("=",), interpolation=None)
    try:
        parser.read(file, encoding="utf-8")
    except (ConfigError, UnicodeDecodeError):
        return []
    if section == _GROUP:
        return [f"{name} = {module}" for name, module in parser.items(section)] if parser.has_section(section) else []
    return parser.get(section, _GROUP, fallback="").splitlines()


def _of_setup_py(file: Path) -> list[str]:
    try:
        tree = ast.parse(file_text(file, errors="replace"))
    except (OSError, SyntaxError, ValueError, RecursionError):
        return []
    lines: list[str] = []
    for node in ast.walk(tree):
        for key, value in zip(node.keys, node.values, strict=True) if isinstance(node, ast.Dict) else ():
            if isinstance(key, ast.Constant) and key.value == _GROUP and isinstance(value, ast.List):
                lines += [str(item.value) for item in value.elts if isinstance(item, ast.Constant)]
    return lines
