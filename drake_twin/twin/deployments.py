"""The models that robots have dropped, as gz-sim's Breadcrumbs: how many, and which are to be fixed to the world."""

import logging
from collections.abc import Callable, Iterator, Mapping
from typing import TYPE_CHECKING, Any, TypeAlias

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import TwinError
from drake_twin.twin.clock import Clock
from drake_twin.twin.endpoints import PUBLISHED, TWIN_NODE, Endpoint
from drake_twin.twin.event_topics import EventTopics
from drake_twin.twin.schedule import step_at

_log = logging.getLogger(__name__)

if TYPE_CHECKING:
    from drake_twin.description.breadcrumbs import Deploy
    from drake_twin.description.gz_requests import GzRequest

Request: TypeAlias = "Callable[[GzRequest, Callable[[TwinError], None]], None]"

_NUMBER = "std_msgs/msg/Int32"
_DEPTH = 10


class Deployments:
    """What a session's robots have dropped.

    Args:
        clock: The time.
        events: The topics that no port of the diagram has.

    Attributes:
        endpoints: The topics that tell how many are left.
        moving: The time (s) at which a model is to be fixed to the world, and its name, in the order of their drop.
    """

    def __init__(self, clock: Clock, events: EventTopics):
        self._clock, self._events = clock, events
        self.endpoints: tuple[Endpoint, ...] = ()
        self.moving: list[tuple[float, str]] = []
        self._counts: dict[tuple[str, str], int] = {}
        self._names: dict[tuple[str, str], str] = {}
        self._robots: set[str] = set()

    def use(self, built: TwinDiagram) -> None:
        """Switch to a newly built diagram; what robots have dropped is forgotten with them."""
        known = list(deploys(built))
        self._counts = {(item.owner, item.number): self._counts.get((item.owner, item.number), 0) for item in known}
        self._names = {(item.owner, item.number): item.name for item in known}
        self._robots = {plan.name for plan in built.plans}
        self.moving = [entry for entry in self.moving if entry[1] in self._robots]
        topics = dict.fromkeys(f"{item.topic}/remaining" for item in known)
        self.endpoints = tuple(Endpoint(PUBLISHED, topic, _NUMBER, TWIN_NODE, depth=_DEPTH) for topic in topics)

    def count(self, request: "Deploy") -> int:
        """Return how many have been dropped."""
        return self._counts.get((request.owner, request.number), 0)

    def note(self, request: "Deploy", name: str) -> None:
        """Count a model that has been dropped."""
        self._counts[request.owner, request.number] = self.count(request) + 1
        if request.fixed_after is not None:
            self.moving.append((self._clock.time + request.fixed_after, name))

    def tell(self, request: "Deploy") -> None:
        """Publish how many are left: a negative number where they are without end, as gz-sim counts."""
        left = (-1 if request.most is None else request.most) - self.count(request)
        self._events[f"{request.topic}/remaining"].put(lambda: {"data": left})

    def fix_due(self, request: Request) -> bool:
        """Request that the models are fixed that are to be so at the present step; return whether there are some."""
        if not self.moving:
            return False
        from drake_twin.description.gz_requests import FixModel

        due = [entry for entry in self.moving if step_at(entry[0], self._clock.time_step) <= self._clock.step]
        self.moving = [entry for entry in self.moving if entry not in due]
        for _, name in due:
            request(FixModel(name), lambda error: _log.warning("%s", error))
        return bool(due)

    def due_steps(self) -> list[float]:
        """Return the steps at which something is due."""
        return [max(step_at(time, self._clock.time_step), self._clock.step + 1) for time, _ in self.moving]

    def start(self) -> None:
        """Forget when models are to be fixed; those that are still there count, as their names are taken."""
        self.moving = []
        for key, name in self._names.items():
            if not any(robot.startswith(f"{name}_") for robot in self._robots):
                self._counts[key] = 0

    def state(self) -> dict[str, Any]:
        """Return the entry of a snapshot that this part keeps."""
        counts = [[owner, number, count] for (owner, number), count in self._counts.items() if count]
        found: dict[str, Any] = {"deployed": counts} if counts else {}
        return found | ({"to_be_fixed": [list(entry) for entry in self.moving]} if self.moving else {})

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned.

        Raises:
            ValueError: If they are those of other robots.
        """
        counts = {(str(owner), str(number)): int(count) for owner, number, count in state.get("deployed", ())}
        if not counts.keys() <= self._counts.keys():
            raise ValueError("its robots have dropped other models")
        self._counts = dict.fromkeys(self._counts, 0) | counts
        self.moving = [(float(time), str(name)) for time, name in state.get("to_be_fixed", ())]


def deploys(built: TwinDiagram) -> "Iterator[Deploy]":
    """Yield what robots can drop."""
    requests = [item.request for owned in built.triggers for item in owned.trigger.requests]
    if requests:
        from drake_twin.description.breadcrumbs import Deploy

        yield from (request for request in requests if isinstance(request, Deploy))
