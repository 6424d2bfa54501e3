"""Launch descriptions and what they consist of: entities that are visited in order."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.ros2.launch_errors import launch_error

if TYPE_CHECKING:
    from drake_twin.ros2.context import LaunchContext

_OWN_FOLDER = str(Path(__file__).parent)


def place_of_caller() -> Place | None:
    """The line, outside of this package, that led to the call: where a launch file constructs an action."""
    frame = sys._getframe(1)
    while frame is not None:
        file = frame.f_code.co_filename
        if not file.startswith((_OWN_FOLDER, "<")):
            return Place(file, frame.f_lineno)
        frame = frame.f_back  # type: ignore[assignment]
    return None


class LaunchDescriptionEntity:
    """Anything that a launch description may hold.

    Attributes:
        place: where it was written.
    """

    place: Place | None = None

    def visit(self, context: LaunchContext) -> Iterable[Any] | None:
        """Does what the entity is for; returns the entities to visit next."""
        return None

    def describe_sub_entities(self) -> list[Any]:
        """The entities that it always visits."""
        return []

    def describe_conditional_sub_entities(self) -> list[tuple[str, list[Any]]]:
        """The entities that it may visit, each with the condition in words."""
        return []

    def describe(self) -> str:
        """The entity in a few words."""
        return f"{type(self).__name__}"

    def get_asyncio_future(self) -> None:
        """None: evaluation is synchronous."""


class Action(LaunchDescriptionEntity):
    """An entity that does something when it is visited, if its condition holds.

    Args:
        condition: a condition, or None.
    """

    def __init__(self, *, condition: Any = None):
        if condition is not None and not callable(getattr(condition, "evaluate", condition)):
            raise TypeError(f"condition= takes a condition such as IfCondition, and {condition!r} is none")
        self._condition = condition
        self.place = place_of_caller()

    @property
    def condition(self) -> Any:
        """The condition, or None."""
        return self._condition

    def visit(self, context: LaunchContext) -> Iterable[Any] | None:
        """Executes the action if its condition holds."""
        if self._condition is None or self._condition.evaluate(context):
            return self.execute(context)
        return None

    def execute(self, context: LaunchContext) -> Iterable[Any] | None:
        """Does what the action is for; returns the entities to visit next."""
        return None


class LaunchDescription(LaunchDescriptionEntity):
    """A list of entities that are visited in turn.

    Args:
        initial_entities: the entities.
        deprecated_reason: why the file should not be used any more; ignored.
    """

    def __init__(self, initial_entities: Iterable[Any] | None = None, *, deprecated_reason: str | None = None):
        self._entities = list(initial_entities or ())
        self._deprecated_reason = deprecated_reason
        self.place = place_of_caller()

    @property
    def entities(self) -> list[Any]:
        """The entities."""
        return self._entities

    @property
    def deprecated(self) -> bool:
        """Whether the file should not be used any more."""
        return self._deprecated_reason is not None

    @property
    def deprecated_reason(self) -> str | None:
        """Why not."""
        return self._deprecated_reason

    def add_entity(self, entity: Any) -> None:
        """Adds an entity at the end."""
        self._entities.append(entity)

    def add_action(self, action: Any) -> None:
        """Adds an action at the end."""
        self.add_entity(action)

    def visit(self, context: LaunchContext) -> list[Any]:
        """The entities."""
        return self._entities

    def describe_sub_entities(self) -> list[Any]:
        """The entities."""
        return self._entities

    def get_launch_arguments(self, conditional_inclusion: bool = False) -> list[Any]:
        """The DeclareLaunchArgument actions that stand in the description itself and in its groups."""
        from drake_twin.ros2.actions import DeclareLaunchArgument

        entities = every_entity(self, conditional=conditional_inclusion)
        return [entity for entity in entities if isinstance(entity, DeclareLaunchArgument)]


def visit_all(entity: Any, context: LaunchContext) -> None:
    """Visits an entity and all that it leads to, depth first, as ROS does.

    Raises:
        InputError: something in the list is not an entity, or an action cannot be executed.
    """
    with context.at(getattr(entity, "place", None)):
        try:
            if not callable(getattr(entity, "visit", None)):
                raise InputError(f"a launch description holds actions, and {_shown(entity)} is not one")
            following = list(_entities(entity.visit(context)))
        except (Exception, SystemExit) as error:  # a launch file's code raises whatever it likes
            raise launch_error(error, context) from None
        for item in following:
            visit_all(item, context)


def visit_all_entities_and_collect_futures(entity: Any, context: LaunchContext) -> list[Any]:
    """ROS's name for `visit_all`; there is nothing to wait for."""
    visit_all(entity, context)
    return []


def visit_list(entities: Iterable[Any], context: LaunchContext) -> None:
    """Visits entities in turn."""
    for entity in entities:
        visit_all(entity, context)


def as_entities(entities: Any) -> list[Any]:
    """One entity, or a list of them, nested or not, as a flat list."""
    if entities is None:
        return []
    if isinstance(entities, Iterable) and not isinstance(entities, str | LaunchDescriptionEntity):
        return [item for part in entities for item in as_entities(part)]
    return [entities]


def every_entity(entity: Any, *, conditional: bool = True) -> Iterator[Any]:
    """An entity and those that it holds, without executing anything.

    Args:
        entity: the entity.
        conditional: whether those that are visited only under a condition are among them.
    """
    yield entity
    describe: Callable[[], list[Any]] | None = getattr(entity, "describe_sub_entities", None)
    below = list(describe()) if describe else []
    further = getattr(entity, "describe_conditional_sub_entities", None)
    if conditional and further is not None:
        below += [item for _, items in further() for item in items]
    for item in below:
        yield from every_entity(item, conditional=conditional)


def _entities(returned: Any) -> Iterable[Any]:
    if returned is None:
        return ()
    if callable(getattr(returned, "visit", None)):
        return (returned,)
    if isinstance(returned, Iterable) and not isinstance(returned, str):
        return returned
    return (returned,)  # visiting it says what is wrong with it


def _shown(value: object) -> str:
    text = repr(value)
    return f"{text if len(text) <= 60 else text[:60] + '…'} (a {type(value).__name__})"
