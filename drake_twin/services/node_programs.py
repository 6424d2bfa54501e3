"""The node programs of a twin's scenario, with the twin's services."""

from collections.abc import Callable
from typing import TYPE_CHECKING

from drake_twin.services.offered import services_of
from drake_twin.twin.twin import Twin

if TYPE_CHECKING:
    from drake_twin.nodes.nodes import Nodes


def start_nodes(twin: Twin, is_stopped: Callable[[], bool] = lambda: False) -> "Nodes | None":
    """Let the node programs of a twin's scenario run with it, from the time that it has on.

    Args:
        twin: The twin; its `Twin.close` ends them.
        is_stopped: Whether the run is to end, so that no program is waited for.

    Returns:
        The programs; None if the scenario has none.

    Raises:
        InputError: If a program does not exist.
    """
    if not twin.scenario.nodes:
        return None
    from drake_twin.nodes.nodes import Nodes

    nodes = Nodes(twin, services=services_of, is_stopped=is_stopped)
    twin.companions.append(nodes)
    return nodes
