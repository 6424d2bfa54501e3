"""Release of diagrams, so that their memory is freed.

pydrake makes a reference cycle of a simulator, its diagram and its systems, and never breaks it (drake#22515). Nor can
Python's collector break a cycle through the attributes of a system: pydrake's classes show it their dictionary twice
(``gc.get_referents`` of an instance of a subclass of LeafSystem lists it two times), so that it takes the dictionary to
be in use.
"""

from collections.abc import Iterable, Iterator
from typing import Any

from pydrake.systems.framework import Diagram, System

from drake_twin.sensors.sensor_host import SensorHost

_PEERS = "_pydrake_internal_ref_cycle_peers"  # pydrake's attribute


def release(items: Iterable[Any]) -> None:
    """Break the reference cycles of simulators, builders, diagrams and systems, which cannot be used afterwards."""
    for part in [part for item in items for part in _parts(item)]:  # listed first: each access makes its cycle again
        peers = getattr(part, _PEERS, None)
        if peers is not None:
            peers.clear()
        if isinstance(part, SensorHost):
            part.forget()


def _parts(item: Any) -> Iterator[Any]:
    """Yield an item, and the systems and ports in it."""
    yield item
    if isinstance(item, Diagram):
        for system in item.GetSystems():
            yield from _parts(system)
    elif isinstance(item, System):
        yield from map(item.get_input_port, range(item.num_input_ports()))
        yield from map(item.get_output_port, range(item.num_output_ports()))
