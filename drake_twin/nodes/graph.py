"""The topics, services and actions that node programs share with each other and with the twin.

Everything that reaches the twin goes through its recorded methods, so that a replay needs no node. What a node sends to
another one arrives in the next slot: the turns at a later step.
"""

import logging
from collections import deque
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from inspect import isgenerator
from math import inf
from typing import Any

from drake_twin.errors import TwinError
from drake_twin.messages.interface_types import make_response
from drake_twin.nodes.graph_items import Caller, Offer, Publication, Reception
from drake_twin.nodes.message_classes import to_wire
from drake_twin.nodes.outside_services import OutsideServices
from drake_twin.nodes.program import Program
from drake_twin.nodes.qos_events import QosEvents
from drake_twin.nodes.turns import Turns
from drake_twin.twin.endpoints import COMMANDED, PUBLISHED, Endpoint, ServiceEndpoint
from drake_twin.twin.twin import Twin

_log = logging.getLogger(__name__)
_CONTINUE = 10_000_000  # ns of simulation time between two looks at a service's answer that takes longer
_MOST_LINES = 1000
_FRAMES, _TRANSFORMS = ("/tf", "/tf_static"), "tf2_msgs/msg/TFMessage"
_NUMBERS = "std_msgs/msg/Float64MultiArray"  # of which controllers read the numbers only


class Graph:
    """What node programs share.

    Args:
        twin: The twin.
        turns: Its time.
        services: Returns the twin's services.

    Attributes:
        twin: The twin.
        publications: Topic → what nodes publish on it.
        receptions: Topic → who of the nodes subscribes to it.
        offers: Service → which nodes offer it.
        node_logs: Node → whether it publishes its log.
        outside: The services of other programs.
        changed: Is called whenever something comes or goes.
        version: Changes whenever something comes or goes.
        quality: Which of the nodes hear each other, and what they are told of it.
        taps: Are called with what nodes publish.
        is_open: Whether messages are passed on.
    """

    def __init__(self, twin: Twin, turns: Turns, services: Callable[[Twin], Iterable[ServiceEndpoint]]):
        self.twin = twin
        self.publications: dict[str, list[Publication]] = {}
        self.receptions: dict[str, list[Reception]] = {}
        self.offers: dict[str, list[Offer]] = {}
        self.outside = OutsideServices(self._is_own, self.note_change)
        self.node_logs: dict[str, bool] = {}
        self._nodes: dict[str, list[Program]] = {}
        self.changed: Callable[[], None] = lambda: None
        self.version = 0
        self.quality = QosEvents(lambda: turns.now, self.post)
        self.taps: list[Callable[[Publication, Any], None]] = []
        self.is_open = True
        self._turns = turns
        self._services_of = services
        self._mail: deque[tuple[int, Callable[[], None]]] = deque()
        self._logged: set[tuple[str, str]] = set()
        self._endpoints: tuple[Endpoint, ...] | None = None
        self._published: dict[str, Endpoint] = {}
        self._commanded: dict[str, Endpoint] = {}
        self._twin_services: tuple[Any, dict[str, ServiceEndpoint]] = (None, {})
        self.follow()

    # Time ------------------------------------------------------------------------------------------------------------

    def post(self, act: Callable[[], None], delay: int = 0) -> None:
        """Let something happen in a later slot, ns from now at least."""
        due = max(self._turns.after, self._turns.now + delay)
        self._mail.append((due, act))
        self.twin.alarm.hasten(due * 1e-9)

    @property
    def has_mail(self) -> bool:
        """Whether anything is to happen in a later slot."""
        return bool(self._mail)

    def deliver(self, *, everything: bool = False) -> None:
        """Let happen what is due, or everything that waits."""
        for _ in range(len(self._mail)):
            due, act = self._mail.popleft()
            if everything or due <= self._turns.limit:
                act()
            else:
                self._mail.append((due, act))
                self.twin.alarm.hasten(due * 1e-9)

    def shift(self, by: int) -> None:
        """Take note of a jump of time by ns."""
        self._mail = deque((due + by, act) for due, act in self._mail)

    def note_change(self) -> None:
        """Take note that something has come or gone."""
        self.version += 1
        self.changed()

    def follow(self) -> None:
        """Follow spawns and deletes."""
        endpoints = self.twin.graph.endpoints
        if endpoints is self._endpoints:
            return
        self._endpoints = endpoints
        self._published = {item.name: item for item in endpoints if item.kind == PUBLISHED}
        self._commanded = {item.name: item for item in endpoints if item.kind == COMMANDED}
        for receptions in self.receptions.values():
            for reception in receptions:
                self._connect(reception)
        for publications in self.publications.values():
            for publication in publications:
                self._tie(publication)
        self.note_change()

    # Topics ----------------------------------------------------------------------------------------------------------

    def advertise(self, publication: Publication) -> None:
        """Add a topic that a node publishes."""
        self.publications.setdefault(publication.topic, []).append(publication)
        self._tie(publication)
        for reception in self.receptions.get(publication.topic, ()):
            self.quality.pair(publication, reception)
        self.note_change()

    def _tie(self, publication: Publication) -> None:
        """Let a publisher command the twin's topic, if there is one that takes what it publishes."""
        item = self._commanded.get(publication.topic)
        if item is publication.command:
            return
        publication.command = None
        if item is None:
            return
        if item.type != publication.type:
            self.log(publication.topic, f"{publication.node} publishes {publication.type}, but it takes {item.type}")
        elif self.quality.commands(publication, item):
            publication.command = item

    def publish(self, publication: Publication, message: Any) -> None:
        """Publish a node's message; it is copied."""
        if not self.is_open:
            return
        topic, item = publication.topic, publication.command
        if topic in _FRAMES and publication.type == _TRANSFORMS:
            placed = {transform.child_frame_id.removeprefix("/") for transform in message.transforms}
            self.twin.diagram.GetSubsystemByName("tf").placed_by_others |= placed
        if item is not None:
            try:
                self.twin.publish(topic, message.data.tolist() if item.type == _NUMBERS else to_wire(message))
            except TwinError as error:
                self.log(topic, str(error).removeprefix(f"{topic}: "))
        if publication.is_timed:
            self.quality.passed(publication)
        if not (publication.matched or self.taps or publication.depth):
            return
        copy = to_wire(message)
        lifespan = publication.profile.lifespan.nanoseconds
        expires = self._turns.now + lifespan if lifespan > 0 else inf
        if publication.depth:
            publication.latched.append((copy, expires))
        for reception in publication.matched:
            self.post(partial(reception.put, copy, expires))
        for tap in self.taps:
            tap(publication, copy)

    def subscribe(self, reception: Reception) -> None:
        """Add a topic that a node subscribes to."""
        self.receptions.setdefault(reception.topic, []).append(reception)
        self._connect(reception)
        for publication in self.publications.get(reception.topic, ()):
            self.quality.pair(publication, reception)
            if reception.wants_latched and publication in reception.matched:
                for message, expires in publication.latched:
                    self.post(partial(reception.put, message, expires))
        self.note_change()

    def _connect(self, reception: Reception) -> None:
        """Subscribe to the twin's topic, if there is one and it is not subscribed to yet."""
        item = self._published.get(reception.topic)
        if item is None or reception.end is not None:
            return
        if item.type != reception.type:
            self.log(item.name, f"{reception.node} expects {reception.type}, but this is {item.type}")
            return
        if not self.quality.hears(reception, item):
            return

        # What has happened at a step is heard at the next one, lest two nodes answer one another without end.
        delay = 0.5 * self.twin.clock.time_step if item.name in self.twin.graph.events else 0.0

        def hear(message: Any) -> None:
            reception.put(message)
            self.twin.alarm.hasten(self.twin.time + delay)

        reception.end = self.twin.graph.subscribe(reception.topic, hear, None, kept=reception.wants_latched)

    def withdraw(self, item: Publication | Reception | Offer | Caller) -> None:
        """Take back what a node publishes, subscribes to, offers or asks."""
        if isinstance(item, Caller):
            self.outside.remove(item)
            self.note_change()
            return
        places: Any = {Publication: self.publications, Reception: self.receptions, Offer: self.offers}[type(item)]
        name = item.name if isinstance(item, Offer) else item.topic
        if item in places.get(name, ()):
            places[name].remove(item)
            if not places[name]:
                del places[name]
        if isinstance(item, Publication | Reception):
            self.quality.part(item)
        if isinstance(item, Reception) and item.end is not None:
            item.end()
            item.end = None
        self.note_change()

    def forget(self, program: Program) -> None:
        """Take back all that a program has."""
        for item in program.belongings:
            if isinstance(item, Publication | Reception | Offer | Caller):
                self.withdraw(item)
        program.belongings.clear()
        for name in [name for name, programs in self._nodes.items() if program in programs]:
            del self._nodes[name]
            self.node_logs.pop(name, None)

    def add_node(self, name: str, program: Program) -> None:
        """Add a node."""
        programs = self._nodes.setdefault(name, [])
        if programs:
            self.log(name, "several nodes have this name")
        programs.append(program)

    def remove_node(self, name: str) -> None:
        """Remove a node; of several with the name, one."""
        programs = self._nodes.get(name, [])
        if programs:
            programs.pop()
        if not programs:
            self._nodes.pop(name, None)
            self.node_logs.pop(name, None)

    def node_names(self) -> list[str]:
        """Return the full names of all nodes, those of the twin among them."""
        of_services = (service.node for service in self.services().values())
        of_twin = {*(item.node for item in self._endpoints or ()), *of_services}
        of_programs = [name for name, programs in self._nodes.items() for _ in programs]
        return sorted([*(of_twin - self._nodes.keys()), *of_programs])

    def service_names(self) -> list[tuple[str, list[str]]]:
        """Return each service with its types."""
        found = {name: {service.type} for name, service in self.services().items()}
        for name, offers in self.offers.items():
            found.setdefault(name, set()).update(offer.type for offer in offers)
        return [(name, sorted(kinds)) for name, kinds in sorted(found.items())]

    def hear(self, topic: str, message: Any) -> None:
        """Pass on to the nodes what another program has published."""
        for reception in self.receptions.get(topic, ()):
            if reception.type == message.__msgtype__:
                self.post(partial(reception.put, message))

    def endpoints(self) -> Iterator[Endpoint]:
        """Yield the topics of nodes that the twin itself does not have."""
        for topic, publications in self.publications.items():
            if topic not in self._published:
                first = publications[0]
                best_effort = all(item.is_best_effort for item in publications)
                yield Endpoint(
                    PUBLISHED,
                    topic,
                    first.type,
                    first.node,
                    latched=any(item.depth for item in publications),
                    is_best_effort=best_effort,
                    **self.quality.offered(publications),
                )
        for topic, receptions in self.receptions.items():
            if topic not in self._commanded:
                best_effort = any(item.is_best_effort for item in receptions)
                latched = all(item.wants_latched for item in receptions)
                yield Endpoint(
                    COMMANDED,
                    topic,
                    receptions[0].type,
                    receptions[0].node,
                    latched=latched,
                    is_best_effort=best_effort,
                    **self.quality.requested(receptions),
                )

    def topics(self) -> dict[str, list[str]]:
        """Return topic → its types."""
        found: dict[str, list[str]] = {}
        for item in self._endpoints or ():
            if item.kind in (PUBLISHED, COMMANDED):
                found.setdefault(item.name, []).append(item.type)
        own: tuple[Mapping[str, Iterable[Any]], ...] = self.publications, self.receptions
        for items in own:
            for name, each in items.items():
                found.setdefault(name, []).extend(item.type for item in each)
        return {name: sorted(set(kinds)) for name, kinds in sorted(found.items())}

    # Services --------------------------------------------------------------------------------------------------------

    def offer(self, offer: Offer) -> None:
        """Add a service that a node offers."""
        self.offers.setdefault(offer.name, []).append(offer)
        self.note_change()

    def has_service(self, name: str, kind: str) -> bool:
        """Return whether a service of a type is there."""
        return self._is_own(name, kind) or self.outside.has_service(name, kind)

    def _is_own(self, name: str, kind: str) -> bool:
        """Return whether the twin or a node offers a service of a type."""
        service = self.services().get(name)
        is_twins = service is not None and service.type == kind
        return is_twins or any(offer.type == kind for offer in self.offers.get(name, ()))

    def services(self) -> Mapping[str, ServiceEndpoint]:
        """Return the twin's services by their names."""
        twin = self.twin
        state = self._endpoints, tuple(tuple(twin.control.manager(robot).states) for robot in twin.robots)
        known, services = self._twin_services
        if known != state:
            services = {service.name: service for service in self._services_of(twin)}
            self._twin_services = state, services
        return services

    def ask(self, name: str, kind: str, request: Any, answered: Callable[[Any], None]) -> None:
        """Send a request to a service; the response arrives in a later slot, if the service is there.

        Args:
            name: The service.
            kind: Its type.
            request: The request.
            answered: Takes the response.
        """
        offer = next((offer for offer in self.offers.get(name, ()) if offer.type == kind), None)
        if offer is not None:
            self.post(partial(offer.put, request, lambda response: self.post(partial(answered, response))))
            return
        service = self.services().get(name)
        if service is None or service.type != kind:
            self._ask_outside(name, kind, request, answered)
            return
        act = partial(self._answer, service, request, answered)
        if service.between_advances:
            self.post(lambda: self.twin.alarm.requests.append(act))
        else:
            self.post(act)

    def _ask_outside(self, name: str, kind: str, request: Any, answered: Callable[[Any], None]) -> None:
        """Ask a service of another program; log if no program offers it."""
        if self.outside.ask(name, kind, request, lambda response: self.post(partial(answered, response))):
            return
        others = ", ".join(dict(self.service_names()).get(name, ()))
        why = f"its type is {others}" if others else "no node offers it"
        self.log(name, f"a request is lost: it is called as {kind}, but {why}")

    def _answer(self, service: ServiceEndpoint, request: Any, answered: Callable[[Any], None]) -> None:
        """Answer a request as the twin's service does."""
        try:
            fields = service.answer(request)
            if isgenerator(fields):
                self._continue(service, fields, answered)
                return
            response = make_response(service.type, fields)
        except (TwinError, ValueError) as error:
            response = make_response(service.type, {}, str(error))
            self.log(service.name, str(error))
        self.post(partial(answered, response))

    def _continue(self, service: ServiceEndpoint, answer: Any, answered: Callable[[Any], None]) -> None:
        try:
            next(answer)
        except StopIteration as end:
            self.post(partial(answered, make_response(service.type, end.value)))
        except (TwinError, ValueError) as error:
            self.log(service.name, str(error))
            self.post(partial(answered, make_response(service.type, {}, str(error))))
        else:
            self.post(partial(self._continue, service, answer, answered), _CONTINUE)

    def log(self, what: str, text: str) -> None:
        """Log once."""
        key = what, text
        if key not in self._logged and len(self._logged) < _MOST_LINES:
            self._logged.add(key)
            _log.warning("%s: %s", what, text)
