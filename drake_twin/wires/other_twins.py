"""Two twins on one ROS domain would publish the same topics, two clocks among them: the second one is refused."""

from collections.abc import Iterable, Sequence
from typing import Protocol

from drake_twin.errors import InputError
from drake_twin.findings import first_of
from drake_twin.twin.endpoints import TWIN_NODE

_NAMED = 3  # topics in the message


class SeesGraph(Protocol):
    """A wire that sees who else is on the graph.

    Attributes:
        domain: The ROS domain.
    """

    domain: int

    def topics_beside(self, node: str) -> Sequence[str]:
        """Return the topics that other programs publish in which a node runs.

        Args:
            node: The node's full name.
        """


def refuse_other_twin(wire: SeesGraph, topics: Iterable[str]) -> None:
    """Refuse to publish what another twin publishes already.

    A twin is known by its node ``/drake_twin``: a robot_state_publisher of the user's own does not count.

    Args:
        wire: The wire, on which this twin has no topics yet.
        topics: The topics that this twin would publish.

    Raises:
        InputError: If another twin publishes some of them.
    """
    there = set(wire.topics_beside(TWIN_NODE))
    both = [topic for topic in topics if topic in there]
    if not both:
        return
    named = first_of(both, _NAMED)
    raise InputError(
        f"another twin is on ROS domain {wire.domain} and publishes {named}, which this one would publish as well: end"
        " that twin, or give this one a domain of its own with --ros-domain N, or names of its own with --ros-namespace"
        " NAME, which goes before its topics, services and nodes"
    )
