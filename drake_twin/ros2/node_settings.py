"""What is set for all nodes of a scope: their parameters and remappings."""

from collections.abc import Iterable
from typing import Any

from drake_twin.errors import InputError
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.typed_text import typed_text


def add_global(context: LaunchContext, key: str, item: Any) -> None:
    """Add a parameter (``global_params``) or remapping (``ros_remaps``) for the nodes that follow in the scope."""
    context.launch_configurations[key] = [*context.launch_configurations.get(key, []), item]


def global_parameters(context: LaunchContext) -> list[Any]:
    """Return the parameters of all nodes of the scope.

    ROS passes a value on the node's command line, as Python prints it: a list becomes the text ``(1, 2)``.
    """
    items = context.launch_configurations.get("global_params", [])
    return [
        {item[0]: typed_text(str(item[1]), can_be_str=True).value} if isinstance(item, tuple) else item
        for item in items
    ]


def remapping_pairs(context: LaunchContext, remappings: Iterable[Any]) -> list[tuple[str, str]]:
    """Return the remappings of all nodes of the scope, and then those of one node, as (from, to).

    Args:
        context: The context.
        remappings: The node's own: pairs of texts or substitutions.

    Raises:
        InputError: If one is not a pair.
    """
    pairs = list(context.launch_configurations.get("ros_remaps", []))
    for pair in remappings:
        if isinstance(pair, str) or not isinstance(pair, Iterable) or len(list(pair)) != 2:
            raise InputError(f"a remapping is a pair (from, to), and this is {pair!r}")
        source, target = pair
        pairs.append((context.perform_substitution(source), context.perform_substitution(target)))
    return pairs
