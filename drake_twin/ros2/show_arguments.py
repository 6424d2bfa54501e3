"""The arguments of a launch file and of the files that it includes."""

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.built_in_packages import built_in_arguments
from drake_twin.ros2.launch.actions.declare_launch_argument import DeclareLaunchArgument
from drake_twin.ros2.launch.actions.include_launch_description import IncludeLaunchDescription
from drake_twin.ros2.launch.actions.set_launch_configuration import SetLaunchConfiguration
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_files import existing_file, load_launch_file
from drake_twin.ros2.launched import LaunchArgument
from drake_twin.ros2.packages import BUILT_IN
from drake_twin.ros2.text_parts import as_text
from drake_twin.ros2.visiting import every_entity

_DEEPEST = 20


def collect_arguments(path: str, description: Any, context: LaunchContext) -> list[LaunchArgument]:
    """Return the arguments, each name once: those of the file itself, then those of the files that it includes.

    Only what decides which files are included is executed. An include that cannot be followed is left out, and so are
    arguments that an include gives itself.

    Args:
        path: The launch file.
        description: Its description.
        context: The context.
    """
    found: dict[str, LaunchArgument] = {}
    for argument in _arguments(path, description, context, frozenset(), 0):
        found.setdefault(argument.name, argument)
    own = {entity.name for entity in every_entity(description) if isinstance(entity, DeclareLaunchArgument)}
    return sorted(found.values(), key=lambda argument: argument.name not in own)


def _arguments(
    path: str, description: Any, context: LaunchContext, given: frozenset[str], depth: int
) -> Iterator[LaunchArgument]:
    with context.in_file(path, None):
        for entity in every_entity(description):
            if isinstance(entity, DeclareLaunchArgument):
                if entity.name not in given:
                    yield entity.declared()
                if entity.default_value is not None and entity.name not in context.launch_configurations:
                    with suppress(InputError):
                        default = context.perform_substitution(entity.default_value)
                        context.launch_configurations[entity.name] = default
            elif isinstance(entity, SetLaunchConfiguration):
                with suppress(InputError):
                    entity.execute(context)
            elif isinstance(entity, IncludeLaunchDescription) and depth < _DEEPEST:
                with suppress(InputError):
                    yield from _of_include(entity, context, given, depth)


def _of_include(
    include: IncludeLaunchDescription, context: LaunchContext, given: frozenset[str], depth: int
) -> Iterator[LaunchArgument]:
    names = set()
    for name, value in include.launch_arguments:
        names.add(context.perform_substitution(name))
        with suppress(InputError):
            text = context.perform_substitution(as_text(value))
            context.launch_configurations[context.perform_substitution(name)] = text
    source = include.launch_description_source
    if source.is_description:
        return
    path = source.perform_location(context)
    if path.startswith(BUILT_IN):
        yield from (item for item in built_in_arguments(path) if item.name not in names | given)
        return
    file = str(existing_file(path, context, include.place))
    yield from _arguments(file, load_launch_file(file, context), context, given | names, depth + 1)


def arguments_text(arguments: Sequence[LaunchArgument]) -> str:
    """Return arguments as ``ros2 launch --show-args`` prints them."""
    if not arguments:
        return "Arguments (pass arguments as '<name>:=<value>'):\n\n  No arguments."
    lines = ["Arguments (pass arguments as '<name>:=<value>'):"]
    for argument in arguments:
        lines += ["", f"    '{argument.name}':", f"        {argument.description or 'no description given'}"]
        if argument.choices:
            lines.append(f"        Valid choices are: {', '.join(repr(choice) for choice in argument.choices)}")
        if argument.default is not None:
            lines.append(f"        (default: '{argument.default}')")
    return "\n".join(lines)
