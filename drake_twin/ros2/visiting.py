"""Visiting entities in order, as ROS does."""

from collections.abc import Callable, Iterable, Iterator
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_errors import launch_error


def visit_all(entity: Any, context: LaunchContext) -> None:
    """Visit an entity and all that it leads to, depth first.

    Raises:
        InputError: If something in the list is not an entity, or an action cannot be executed.
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


def visit_list(entities: Iterable[Any], context: LaunchContext) -> None:
    """Visit entities in turn."""
    for entity in entities:
        visit_all(entity, context)


def every_entity(entity: Any, *, conditional: bool = True) -> Iterator[Any]:
    """Yield an entity and those that it holds, without executing anything.

    Args:
        entity: The entity.
        conditional: Whether to include those that are visited only under a condition.
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
    if isinstance(returned, Iterable) and not (isinstance(returned, str) or callable(getattr(returned, "visit", None))):
        return returned
    return (returned,)  # of something else, visiting it raises an error that shows it


def _shown(value: object) -> str:
    text = repr(value)
    return f"{text if len(text) <= 60 else text[:60] + '…'} (a {type(value).__name__})"
