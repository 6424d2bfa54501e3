"""The arguments of a launch file and of those that it includes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.ros2.actions import DeclareLaunchArgument, SetLaunchConfiguration
from drake_twin.ros2.entity import every_entity
from drake_twin.ros2.include import IncludeLaunchDescription, existing_file, load_launch_file
from drake_twin.ros2.launched import LaunchArgument
from drake_twin.ros2.packages import BUILT_IN
from drake_twin.ros2.stand_ins import stand_in_arguments
from drake_twin.ros2.substitution import perform, perform_substitutions

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

_DEEPEST = 20


def collect_arguments(path: str, description: Any, context: LaunchContext) -> list[LaunchArgument]:
    """The arguments, each name once, in the order in which they are declared.

    Nothing is executed but what decides which files are included; an include that cannot be followed is left out, and
    so are arguments that an include gives itself.
    """
    found: dict[str, LaunchArgument] = {}
    for argument in _arguments(path, description, context, frozenset(), 0):
        found.setdefault(argument.name, argument)
    return list(found.values())


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
                        default = perform_substitutions(context, entity.default_value)
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
        names.add(perform(context, name))
        with suppress(InputError):
            context.launch_configurations[perform(context, name)] = perform(
                context, str(value) if isinstance(value, bool | int | float) else value
            )
    source = include.launch_description_source
    if source.is_description:
        return
    path = source.perform_location(context)
    if path.startswith(BUILT_IN):
        yield from (item for item in stand_in_arguments(path) if item.name not in names | given)
        return
    file = str(existing_file(path, context, include.place))
    yield from _arguments(file, load_launch_file(file, context), context, given | names, depth + 1)


def arguments_text(arguments: Sequence[LaunchArgument]) -> str:
    """Arguments as ``ros2 launch --show-args`` prints them."""
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
