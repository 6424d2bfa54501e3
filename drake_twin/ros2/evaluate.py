"""Evaluates a launch file without ROS: what it starts.

A launch file is code and runs as its user's, as with ``ros2 launch``: Python files, ``$(eval …)``, ``$(command …)`` and
PythonExpression are executed.
"""

import sys
from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from difflib import get_close_matches
from pathlib import Path, PurePath

from drake_twin.description.package_index import PackageIndex, absolute_path
from drake_twin.errors import InputError
from drake_twin.ros2.built_in_packages import BUILT_IN_PACKAGES
from drake_twin.ros2.endings import endings
from drake_twin.ros2.evaluation import active
from drake_twin.ros2.launch.events.shutdown import Shutdown
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch_files import enter_file, load_launch_file
from drake_twin.ros2.launched import LaunchArgument, Launched, Noted, UnfiredHandler
from drake_twin.ros2.packages import AbsentError, LaunchPackages
from drake_twin.ros2.ros_modules import ros_in_place
from drake_twin.ros2.show_arguments import collect_arguments


def evaluate(
    file: str | Path,
    arguments: Mapping[str, str] | None = None,
    packages: PackageIndex | None = None,
    words: Sequence[str] = (),
) -> Launched:
    """Return what a launch file starts.

    Args:
        file: A Python, XML or YAML launch file.
        arguments: Values for its arguments, as typed after ``ros2 launch``.
        packages: Where packages are; the twin's own index by default.
        words: How ``ros2 launch`` would be told the file, such as ``PACKAGE FILE``; its path by default.

    Raises:
        InputError: If the file cannot be used: not found, wrong, arguments without a value, a Python error in it, ….
    """
    path = _existing(file)
    return _evaluated(path, lambda context: load_launch_file(path, context), arguments, packages, words)


def evaluate_description(
    description: LaunchDescription,
    arguments: Mapping[str, str] | None = None,
    packages: PackageIndex | None = None,
) -> Launched:
    """Return what a launch description starts that a Python program built of `drake_twin.launch`'s entities.

    Args:
        description: The description.
        arguments: Values for its arguments.
        packages: Where packages are; the twin's own index by default.

    Raises:
        InputError: As `evaluate`.
    """
    file = sys.argv[0] if description.place is None else description.place.file
    return _evaluated(absolute_path(file), lambda context: description, arguments, packages)


def _evaluated(
    path: str,
    load: Callable[[LaunchContext], LaunchDescription],
    arguments: Mapping[str, str] | None,
    packages: PackageIndex | None,
    words: Sequence[str] = (),
) -> Launched:
    arguments, packages = dict(arguments or {}), packages or PackageIndex()
    with ros_in_place(path, arguments, packages.folders, words):
        context = _context(arguments, packages)
        with active(context):
            try:
                enter_file(path, load(context), context, None)
                context.events.run()
                reason, end = context.events.shutdown_reason, context.events.shutdown_time
                if end:  # nodes may end before
                    context.events.come_to_rest(context.events.handlers, end)
                found = tuple(endings(context))
            except AbsentError as error:
                raise _with_all_absent(error, context) from None
    return Launched(
        processes=tuple(context.processes),
        failed_includes=tuple(context.failed_includes),
        absent_packages=tuple(context.packages.absent),
        unfired_handlers=tuple(
            UnfiredHandler(handler.what, len(handler.entities), handler.place)
            for handler in reversed(context.events.handlers)
            if not handler.fired and handler.waits_for is not Shutdown and handler.place is not None
        ),
        undeclared_arguments={name: _closest(name, context) for name in arguments if name not in context.declared},
        lost_arguments=tuple(_lost_arguments(context)),
        log=tuple(context.log),
        refused_by_ros=tuple(context.refused),
        configurations={name: value for name, value in context.launch_configurations.items() if isinstance(value, str)},
        shutdown=reason,
        shutdown_time=end,
        endings=found,
    )


def _closest(name: str, context: LaunchContext) -> str:
    return next(iter(get_close_matches(name, sorted(context.declared), n=1)), "")


def _lost_arguments(context: LaunchContext) -> Iterator[Noted]:
    """Yield the arguments of includes that ROS 2 takes in silence, and nothing uses."""
    for include in dict.fromkeys(context.includes):
        for name, count in Counter(include.arguments).items():
            what = f"argument {name} of include {PurePath(include.file).name}"
            if name not in context.declared | context.read:
                hint = f". Did you mean {close!r}?" if (close := _closest(name, context)) else ""
                yield Noted(f"{what} (no file declares or reads it){hint}", include.place)
            if count > 1:
                yield Noted(f"{what} (it is given again, and the last value counts)", include.place)


def declared_arguments(
    file: str | Path, packages: PackageIndex | None = None, arguments: Mapping[str, str] | None = None
) -> tuple[LaunchArgument, ...]:
    """Return the arguments that a launch file and the files it includes declare, as ``ros2 launch --show-args``.

    Args:
        file: A Python, XML or YAML launch file.
        packages: Where packages are; the twin's own index by default.
        arguments: Values that decide which files are included.

    Raises:
        InputError: If the file cannot be read.
    """
    path = _existing(file)
    arguments, packages = dict(arguments or {}), packages or PackageIndex()
    with ros_in_place(path, arguments, packages.folders):
        context = _context(arguments, packages)
        with active(context):
            return tuple(collect_arguments(path, load_launch_file(path, context), context))


def _with_all_absent(error: AbsentError, context: LaunchContext) -> AbsentError:
    """Return the error with all that is missing."""
    names = list(context.packages.absent)
    reasons = [include.reason for include in context.failed_includes]
    text = error.message.rstrip(".")
    if names:
        text += (
            f". Absent packages: {', '.join(names)}. Name the folders that hold them with --package-path, or in"
            " AMENT_PREFIX_PATH or ROS_PACKAGE_PATH"
        )
    modules = [reason for reason in reasons if "Python module" in reason and reason not in text]
    if modules:
        text += f". Includes that were left out: {'; '.join(dict.fromkeys(modules))}"
    return AbsentError(text, file=error.file, line=error.line, valid=error.valid, value=error.value)


def _context(arguments: Mapping[str, str], packages: PackageIndex) -> LaunchContext:
    index = LaunchPackages(packages, BUILT_IN_PACKAGES)
    return LaunchContext(
        argv=[f"{name}:={value}" for name, value in arguments.items()], packages=index, arguments=arguments
    )


def _existing(file: str | Path) -> str:
    path = absolute_path(file)
    if not Path(path).is_file():
        raise InputError("the launch file does not exist", file=path)
    return path
