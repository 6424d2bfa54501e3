"""The surroundings of launch files while they run: ROS's Python modules, environment variables and ``xacro``.

The stand-ins are in ``sys.modules`` only while launch files run; the modules of a ROS on the path are never used.
Afterwards ``sys.modules``, ``sys.path``, ``os.environ`` and the working directory are restored. Only modules of Python
itself and of its site-packages stay: a later import would find the same, and some (NumPy) cannot be loaded twice.
"""

import importlib
import importlib.abc
import importlib.machinery
import importlib.util
import os
import shlex
import sys
import sysconfig
import types
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path

from drake_twin.description.xacro_file import installed_xacro, tags_with_places
from drake_twin.ros2.graph_modules import GraphFinder, is_graph_module
from drake_twin.ros2.launch.frontend.expose import ACTIONS, SUBSTITUTIONS
from drake_twin.ros2.scopes import set_environment
from drake_twin.ros2.stand_in_modules import ROOTS, StandInFinder, StandInLoader
from drake_twin.ros2.xacro_program import LAUNCH_FILE, PACKAGE_FOLDERS
from drake_twin.scratch_folder import scratch_folder

_PACKAGE = Path(__file__).resolve().parent.parent
_LASTING_FOLDERS = tuple(
    {str(Path(sysconfig.get_paths()[key]).resolve()) for key in ("stdlib", "platstdlib", "purelib", "platlib")}
    | {str(_PACKAGE)}
)

# What a sourced ROS sets and launch files read by subscript.
_ROS_ENVIRONMENT = {"ROS_DISTRO": "jazzy", "ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}
_DEFAULTS = (
    *("GAZEBO_MODEL_PATH", "GAZEBO_RESOURCE_PATH", "GAZEBO_PLUGIN_PATH", "GZ_SIM_RESOURCE_PATH"),
    *("GZ_SIM_SYSTEM_PLUGIN_PATH", "IGN_GAZEBO_RESOURCE_PATH", "IGN_GAZEBO_SYSTEM_PLUGIN_PATH", "AMENT_PREFIX_PATH"),
    *("LD_LIBRARY_PATH", "ROS_PACKAGE_PATH"),
)


@contextmanager
def no_trace() -> Iterator[None]:
    """Restore modules, path, environment, arguments and working directory at the end."""
    modules, path, path_list = dict(sys.modules), list(sys.path), sys.path
    finders, environment, argv = list(sys.meta_path), dict(os.environ), sys.argv
    bytecode, output = sys.dont_write_bytecode, sys.stdout
    folder = os.getcwd()
    sys.dont_write_bytecode = True  # no __pycache__ in other people's packages
    try:
        yield
    finally:
        sys.dont_write_bytecode, sys.stdout, sys.argv = bytecode, output, argv
        os.chdir(folder)
        set_environment(environment)
        sys.path = path_list
        sys.path[:] = path
        sys.meta_path[:] = finders
        for name, module in list(sys.modules.items()):
            if name not in modules and not _lasts(name, module):
                del sys.modules[name]
        for name, module in modules.items():
            if sys.modules.get(name) is not module:
                sys.modules[name] = module


@contextmanager
def ros_in_place(
    file: str, arguments: Mapping[str, str], package_folders: Iterable[Path] = (), words: Sequence[str] = ()
) -> Iterator[None]:
    """Provide ROS's modules, environment variables and the ``xacro`` command, as if ROS were sourced.

    Args:
        file: The launch file, for ``sys.argv``.
        arguments: Its arguments, for ``sys.argv``.
        package_folders: Where the ``xacro`` command searches packages first.
        words: What stands for the launch file in ``sys.argv``; its path by default.
    """
    with ACTIONS.passing(), SUBSTITUTIONS.passing(), no_trace(), tags_with_places(installed_xacro()):
        for name in [name for name in sys.modules if _is_ros(name)]:
            del sys.modules[name]
        importlib.invalidate_caches()
        sys.meta_path[:0] = [StandInFinder(), _XacroFinder()]
        sys.meta_path += [_WorkspaceFinder(), GraphFinder()]
        os.environ.update(_ROS_ENVIRONMENT)
        for name in _DEFAULTS:
            os.environ.setdefault(name, "")
        places = (_xacro_folder(), os.environ.get("PATH", ""), _simulators_folder())
        os.environ["PATH"] = os.pathsep.join(filter(None, places))
        os.environ[LAUNCH_FILE] = os.path.abspath(file)
        os.environ[PACKAGE_FOLDERS] = os.pathsep.join(str(folder) for folder in package_folders)
        sys.argv = ["ros2", "launch", *(words or [file]), *(f"{name}:={value}" for name, value in arguments.items())]
        sys.stdout = sys.stderr  # what launch files print does not belong to the program's result
        yield


class _XacroFinder(importlib.abc.MetaPathFinder):
    """Finds the twin's own xacro before that of a ROS on the path."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: types.ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return xacro's spec; None for another module."""
        return importlib.machinery.PathFinder.find_spec("xacro", _site_folders()) if fullname == "xacro" else None


class _WorkspaceFinder(importlib.abc.MetaPathFinder):
    """Finds the Python modules of ROS packages, and those beside the launch file, after everything else."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: types.ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        """Return the module's spec; None if no package has it."""
        from drake_twin.description.package_index import containing_package
        from drake_twin.ros2.evaluation import current_context

        if "." in fullname:
            return None
        context = current_context()
        file = context.current_launch_file
        folders = [] if file is None else [Path(file).resolve().parent]
        own = None if file is None else containing_package(Path(file).resolve())
        if own is not None:
            folders.append(own)
        share = context.packages.present(fullname, file) if context.packages.is_present(fullname, file) else None
        if share is not None:
            folders += [share, *share.parent.parent.glob("l*/python3*/*-packages")]
        places = [str(place) for folder in folders for place in (folder, folder / "src")]
        spec = importlib.machinery.PathFinder.find_spec(fullname, places)
        if spec is None or spec.origin is None:  # a folder without __init__.py is not a module here
            return None
        return spec


def _is_ros(name: str) -> bool:
    return _root(name) in ROOTS or is_graph_module(name) or _is_foreign_xacro(name)


def _root(name: str) -> str:
    return name.partition(".")[0]


def _site_folders() -> list[str]:
    paths = sysconfig.get_paths()
    return list(dict.fromkeys((paths["purelib"], paths["platlib"])))


def _is_foreign_xacro(name: str) -> bool:
    if _root(name) != "xacro":
        return False
    origin = getattr(sys.modules["xacro"], "__file__", None) if "xacro" in sys.modules else None
    return origin is None or not origin.startswith(tuple(_site_folders()))


def _lasts(name: str, module: types.ModuleType | None) -> bool:
    """Return whether a module that launch files imported stays: any later import would find the same."""
    spec = getattr(module, "__spec__", None)
    if spec is None or spec.name != name or isinstance(spec.loader, StandInLoader):
        return False
    if spec.origin in ("built-in", "frozen"):
        return True
    places = [spec.origin] if spec.origin else list(spec.submodule_search_locations or ())
    return bool(places) and str(Path(places[0]).resolve()).startswith(_LASTING_FOLDERS)


# What launch files look for on PATH before they start it, which the twin does in its place.
_GZ, _CLASSIC = "Gazebo Sim, version 8.0.0", "Gazebo multi-robot simulator, version 11.10.2"
_SIMULATORS = {"gz": _GZ, "ign": _GZ, **dict.fromkeys(("gazebo", "gzserver", "gzclient"), _CLASSIC), "rviz2": "rviz2"}


def _xacro_folder() -> str:
    """Return a folder with a ``xacro`` command, for launch files that start it themselves."""
    folder = scratch_folder() / "bin"
    _add_program(folder / "xacro", _python("drake_twin.ros2.xacro_program"))
    return str(folder)


def _simulators_folder() -> str:
    """Return a folder with programs of Gazebo and ROS for launch files that look whether they are there.

    It is the last one on PATH. ``ros2`` answers about packages; a simulator only tells a version, and ``gz sdf -p``
    prints a file as it is: gz makes SDF of a URDF there, and the twin reads both.
    """
    folder = scratch_folder() / "simulators"
    _add_program(folder / "ros2", _python("drake_twin.ros2.package_command"))
    for name, version in _SIMULATORS.items():
        refused = f'*) echo "{name} $*: the twin runs in its place" >&2; exit 1'
        printed = '"sdf -p "*|"sdf --print "*) exec cat -- "$3"' if version == _GZ else "'')"
        _add_program(folder / name, f'case "$*" in *--version*) echo "{version}";; {printed};; {refused};; esac')
    return str(folder)


def _python(module: str) -> str:
    code = f"import sys; sys.path.insert(0, {str(_PACKAGE.parent)!r}); from {module} import main; sys.exit(main())"
    return f'exec {shlex.quote(sys.executable)} -c {shlex.quote(code)} "$@"'


def _add_program(file: Path, script: str) -> None:
    if not file.exists():
        file.parent.mkdir(exist_ok=True)
        file.write_text(f"#!/bin/sh\n{script}\n")
        file.chmod(0o755)
