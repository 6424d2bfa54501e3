"""Letting go of diagrams, so that their memory comes back.

pydrake ties a simulator, its diagram and its systems to each other, and never lets go of any (drake#22515).
"""

from collections.abc import Iterable, Iterator
from typing import Any

from pydrake.systems.framework import Diagram, System

_PEERS = "_pydrake_internal_ref_cycle_peers"  # where pydrake keeps them


def let_go(items: Iterable[Any]) -> None:
    """Unties simulators, builders, diagrams and systems, with all that is in them; none may be used afterwards."""
    for part in [part for item in items for part in _parts(item)]:  # all first: each look at one ties it again
        peers = getattr(part, _PEERS, None)
        if peers is not None:
            peers.clear()


def _parts(item: Any) -> Iterator[Any]:
    """A diagram, all systems in it, and their ports."""
    yield item
    if isinstance(item, Diagram):
        for system in item.GetSystems():
            yield from _parts(system)
    elif isinstance(item, System):
        yield from map(item.get_input_port, range(item.num_input_ports()))
        yield from map(item.get_output_port, range(item.num_output_ports()))
