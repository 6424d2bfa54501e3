"""What is published to a twin and what it publishes, as a node of the ROS graph: topics, actions, their callbacks."""

import logging
from collections.abc import Callable
from math import ceil
from typing import TYPE_CHECKING, Any

from pydrake.systems.framework import Context, Diagram, OutputPort

from drake_twin.controllers.interface import Interface
from drake_twin.diagram.topics import CommandTopic, PublishedTopic
from drake_twin.errors import CommandError, InputError, TwinError
from drake_twin.findings import Finding, Kind
from drake_twin.messages import Numbers, float64_multi_array, message
from drake_twin.messages.draft import Draft, LaterDraft
from drake_twin.systems.no_message import or_none
from drake_twin.systems.plant_reading import Reading
from drake_twin.twin.action import ActionGoal
from drake_twin.twin.endpoints import Endpoint, endpoints_of
from drake_twin.twin.event_topics import EventTopic, EventTopics
from drake_twin.twin.group import Group
from drake_twin.twin.owner import any_thread
from drake_twin.twin.recording import Recorder, recorded
from drake_twin.twin.session import Session
from drake_twin.twin.stepper import Stepper
from drake_twin.twin.subscriptions import Subscription, Subscriptions
from drake_twin.twin.world_topics import WorldTopics
from drake_twin.values import is_number

if TYPE_CHECKING:
    from drake_twin.description.gz_requests import GzRequest

_log = logging.getLogger(__name__)
_END = "the end of a subscription"
_FREE = (-float("inf"), float("inf"))


class Graph(Group, path="twin.graph"):
    """Topics and actions; `Twin.graph`."""

    def __init__(self, session: Session, stepper: Stepper, recorder: Recorder):
        super().__init__(session, stepper, recorder)
        self._unheard: set[str] = set()
        self._world = WorldTopics(session)
        self._endpoints: tuple[Diagram | None, tuple[Endpoint, ...]] = (None, ())

    def topics(self) -> dict[str, str]:
        """Return topic → ROS message type: what the twin publishes, then what it listens to."""
        built = self._session.built
        published = {item.topic: item.type for item in built.published.values()}
        published = {item.name: item.type for item in self.events.endpoints} | published
        heard = {item.name: item.type for item in self._session.triggers.endpoints}
        heard |= {item.topic: item.type for item in built.commanded.values()} | self._world.types
        return published | heard

    def actions(self) -> dict[str, str]:
        """Return action → ROS action type."""
        return {action: item.type for action, item in self._session.built.actions.items()}

    @property
    @any_thread
    def events(self) -> EventTopics:
        """The topics that no port of the diagram has: ``/rosout``, ``/parameter_events``, ``/diagnostics``."""
        return self._session.events

    @property
    def endpoints(self) -> tuple[Endpoint, ...]:
        """The topics out and in and the actions, each with its node, robot and controller.

        The same tuple is returned until a spawn, a delete or a restored state changes them.
        """
        built, (diagram, known) = self._session.built, self._endpoints
        if diagram is not built.diagram:
            more = (item for item in self.events.endpoints if item.name not in built.published)
            of_world = self._world.endpoints()
            known_there = {item.name for item in of_world}
            triggers = (item for item in self._session.triggers.endpoints if item.name not in known_there)
            new = *endpoints_of(built), *of_world, *triggers, *more
            self._endpoints = built.diagram, known if new == known else new
        return self._endpoints[1]

    def command_topic(self, topic: Any) -> CommandTopic:
        """Return a topic that a controller listens to.

        Raises:
            InputError: If no controller listens to it.
        """
        commanded = self._session.built.commanded
        if not isinstance(topic, str) or topic not in commanded:
            why = "".join(f" ({item})" for item in self._not_started(str(topic)))
            raise InputError(f"nothing listens to {topic!r}{why}", value=str(topic), valid=commanded)
        return commanded[topic]

    def _not_started(self, topic: str) -> list[Finding]:
        """Return why the controllers that a topic's name has are not started."""
        wanted = tuple(f"controller {part}: " for part in topic.split("/"))
        findings = self._session.built.findings
        return [item for item in findings if item.kind is Kind.NOT_STARTED and item.what.startswith(wanted)]

    def published_topic(self, topic: Any) -> PublishedTopic:
        """Return a topic that the twin publishes.

        Raises:
            InputError: If it does not publish the topic.
        """
        published = self._session.built.published
        if not isinstance(topic, str) or topic not in published:
            valid = (*published, *self.events)
            raise InputError(f"nothing is published on {topic!r}", value=str(topic), valid=valid)
        return published[topic]

    def deliver(self, topic: Any, data: Any) -> None:
        """Publish a command that is not recorded, such as a timed one; see `Twin.publish`."""
        self._deliver(topic, data)

    def hears(self, topic: str) -> bool:
        """Return whether the twin listens to a topic."""
        session = self._session
        is_heard = topic in session.built.commanded or session.triggers.hears(topic)
        return is_heard or topic in self._world.types

    def _deliver(self, topic: Any, data: Any) -> None:
        session = self._session
        commanded = session.physics.built.commanded
        item = commanded.get(topic) if isinstance(topic, str) else None
        is_done = item is None and isinstance(topic, str) and topic in self._world.types
        if is_done:
            self._world.hear(topic, data)
        if session.triggers.heard and session.triggers.hears(topic):
            session.triggers.hear(topic, data)
            is_done = item is None
        if is_done:
            return
        item = item or self.command_topic(topic)
        heard, refused = False, None
        for port in session.physics.built.listeners[item.topic]:
            item = commanded[port]
            control = session.controls[item.robot]
            if control.stopped:
                why = f"the emergency stop of {item.robot!r} holds: clear_emergency_stop() ends it"
                refused = refused or CommandError(f"{topic}: {why}")
                continue
            delay = control.command_delay
            if not delay and not control.manager.is_active(item.controller):
                continue
            try:
                value = control.read(item, data)
            except CommandError as error:
                refused = error.about(topic)
                if error.deactivates and delay:  # its controller refuses it when it arrives
                    session.commands.hold(port, message(item.type, data), session.clock.time + delay)
                elif error.deactivates:
                    control.deactivate(item.controller, refused.message)
                continue
            if delay:
                session.commands.hold(port, message(item.type, data), session.clock.time + delay)
            else:
                session.commands.pend(port, value)
            heard = True
        if refused is not None and not heard:
            raise refused
        if not heard and topic not in self._unheard:
            self._unheard.add(topic)
            _log.warning("%s: no controller hears this: %s is not active", topic, item.controller)

    def check(self, topic: Any, data: Any) -> None:
        """Check whether a controller accepts a command.

        Raises:
            InputError: If no controller listens to the topic, or its controller refuses the data.
        """
        session = self._session
        if isinstance(topic, str) and topic in self._world.types:
            self._world.read(topic, data)
            return
        if session.triggers.hears(topic) and topic not in session.built.commanded:
            session.triggers.check(topic, data)
            return
        item = self.command_topic(topic)
        try:
            session.controls[item.robot].read(item, data)
        except CommandError as error:
            raise error.about(topic) from None

    def command(self, topic: Any) -> Any:
        """Return the message last published on a topic; None before the first, and once it has expired.

        Raises:
            InputError: If no controller listens to the topic.
        """
        ports = self._session.built.listeners[self.command_topic(topic).topic]
        values = [value for port in ports if (value := self._session.commands.last(port)) is not None]
        value = values[0] if values else None
        return float64_multi_array(value.data) if isinstance(value, Numbers) else value

    def command_limits(self, topic: Any) -> dict[Interface, tuple[float, float]]:
        """Return the interfaces that a command's numbers drive, in order, with their limits; empty for other messages.

        Raises:
            InputError: If no controller listens to the topic.
        """
        item = self.command_topic(topic)
        if item.type != "std_msgs/msg/Float64MultiArray":
            return {}
        description = self._session.plan(item.robot).description
        claims = self._session.controls[item.robot].controllers[item.controller].claims
        return {
            claim: _FREE if "/" in claim.joint else description.limits_of_command(claim.joint, claim.name)
            for claim in claims
        }

    @recorded("silence")
    def silence(self, topic: str) -> None:
        """Drop the scenario's own timed commands on a topic until the next reset.

        Raises:
            InputError: If no controller listens to the topic.
        """
        is_heard = self._session.triggers.hears(topic)
        self._session.commands.silenced.add(topic if is_heard else self.command_topic(topic).topic)

    @recorded("send_goal")
    def send_goal(self, action: str, goal: Any, on_result: Callable[[ActionGoal], None] | None = None) -> ActionGoal:
        """Send a goal to an action; the controller accepts it at its next update.

        Args:
            action: For example ``/robot_1/joint_trajectory_controller/follow_joint_trajectory``.
            goal: The action's goal message, or its fields as a mapping.
            on_result: Called with the goal when it ends, at that very simulation time.

        Raises:
            InputError: If the action is unknown.
            CommandError: If the goal is rejected.
        """
        session = self._session
        if not isinstance(action, str) or action not in session.built.actions:
            raise InputError(f"unknown action {action!r}", value=str(action), valid=session.built.actions)
        if on_result is not None and not callable(on_result):
            raise InputError(f"{on_result!r} cannot be called with the goal when it ends")
        item = session.built.actions[action]
        control = session.controls[item.robot]
        if control.stopped or not control.manager.is_active(item.controller):
            why = "the emergency stop holds" if control.stopped else f"controller {item.controller} is not active"
            raise CommandError(f"{action}: the goal is rejected: {why}")
        session.commands.put_pending(session.clock.time, item)
        try:
            value = control.read(item, goal)
        except CommandError as error:
            raise error.about(f"{action}: the goal is rejected") from None
        # At once, as the controller counts its goals, and this one may be cancelled before the next step.
        session.commands.set(action, value, session.clock.time)
        return session.goals.add(action, item, value, control, on_result)

    def subscribe(
        self, topic: Any, callback: Any, rate: Any, *, drafts: bool = False, kept: bool = True
    ) -> Callable[[], None]:
        """Call back with a topic's messages, also with latched ones from before if wanted; see `Twin.subscribe`."""
        if not callable(callback):
            raise InputError(f"{callback!r} cannot be called with the messages of {topic!r}")
        if rate is not None and not is_number(rate, 1e-6):
            raise InputError(f"invalid rate {rate!r} Hz: it must be a number above zero")
        session = self._session
        if (event := self._event(topic)) is not None:
            if event.endpoint.rate is None:
                return event.subscribe(callback, drafts=drafts, kept=kept)
            period = 1.0 / (rate or event.endpoint.rate)
            subscription = Subscription(topic, callback, period, session.clock.time, takes_drafts=drafts)
            return self._owner.guard(_END, session.subscriptions.add(subscription))
        name = self.published_topic(topic).topic
        passed_over = () if kept else tuple(session.built.publishers[name])

        def of_port(port: str) -> Subscription:
            item = session.built.published[port]
            period, time = _period(item, rate), session.clock.time
            subscription = Subscription(
                port,
                callback,
                period,
                time,
                takes_drafts=drafts,
                delay=item.delay,
                offset=item.offset,
                draft_at=item.draft_at if drafts else None,
                has_publications=item.publication is not None,
            )
            if port in passed_over and period is None:
                subscription.pass_over(self._message(item))
            return subscription

        return self._owner.guard(_END, session.subscriptions.add_topic(name, of_port))

    def subscribe_drafts(self, topic: str, callback: Callable[[Draft], None]) -> Callable[[], None]:
        """Call back with drafts of a topic's messages, which any thread may make; otherwise like `Twin.subscribe`."""
        return self.subscribe(topic, callback, None, drafts=True)

    def latest(self, topic: Any) -> Any:
        """Return a topic's message at the present time; see `Twin.latest`."""
        if (event := self._event(topic)) is not None:
            return event.latest()
        built = self._session.built
        for port in built.publishers[self.published_topic(topic).topic]:
            message = self._message(built.published[port])
            if message is not None:
                return message
        return None

    def _event(self, topic: Any) -> EventTopic | None:
        """Return the topic of a name that no port of the diagram has; None for others."""
        is_of_diagram = not isinstance(topic, str) or topic in self._session.physics.built.published
        return None if is_of_diagram else self.events.get(topic)

    def feed(self, subscriptions: Subscriptions) -> None:
        """Let subscriptions take their messages from here, and triggers give theirs."""
        self._session.triggers.publish = self.deliver
        self._session.triggers.request = self._request
        subscriptions.ports_of = lambda topic: self._session.built.publishers.get(topic, ())
        subscriptions.read, subscriptions.publication, subscriptions.draft = self._read, self._publication, self._draft
        subscriptions.use(self._session.clock.time_step)  # hears the ports of those that there are already

    def _request(self, request: "GzRequest", refuse: Callable[[TwinError], None]) -> None:
        from drake_twin.twin.model_requests import ModelRequests

        ModelRequests(self._session, self._stepper, self._recorder).do(request, refuse)

    def _publication(self, topic: str, reading: Reading) -> Any:
        item = self._session.physics.built.published.get(topic)
        return None if item is None or item.publication is None else item.publication(reading.root_context)

    def read(self) -> Reading:
        """Read what messages are drafted from, at the present time."""
        return self._read()

    def _read(self) -> Reading:
        physics = self._session.physics
        return Reading(physics.built.ports, physics.context, physics.plant_context)

    def draft(self, topic: str, reading: Reading) -> Draft | None:
        """Draft a topic's message from a reading of the present time; None without one, or if its robot is deleted.

        Raises:
            RunError: If it needs the step to come, and Drake cannot solve it.
        """
        return self._draft(topic, reading)

    def _draft(self, topic: str, reading: Reading) -> Draft | None:
        item = self._session.physics.built.published.get(topic)
        if item is None:
            event = self._event(topic)
            return None if event is None else event.present()
        if item.controller and not self._is_published(item):
            return None
        if item.drafter is None:
            message = self._evaluate(item.port, reading.root_context)
            return None if message is None else LaterDraft(lambda: message)
        try:
            draft = item.drafter(reading)
        except (RuntimeError, SystemExit) as error:
            raise self._session.failure(error) from error
        if item.delay is None:
            return draft
        return LaterDraft(lambda: draft.message() if topic in self._session.built.published else None)

    def evaluate(self, port: OutputPort) -> Any:
        """Return the value of an output port of `Twin.diagram` or of its plant, at the present time.

        Raises:
            RunError: If it needs the step to come (efforts, accelerations, contacts), and Drake cannot solve it.
        """
        physics = self._session.physics
        port = physics.built.ports.valid(port)
        system = port.get_system()
        is_root = system is physics.built.diagram
        return self._evaluate(port, physics.context if is_root else system.GetMyContextFromRoot(physics.context))

    def _evaluate(self, port: OutputPort, context: Context) -> Any:
        try:
            return or_none(port.Eval(context))
        except (RuntimeError, SystemExit) as error:
            raise self._session.failure(error) from error

    def _message(self, item: PublishedTopic) -> Any:
        return self._evaluate(item.port, self._session.physics.context) if self._is_published(item) else None

    def _is_published(self, item: PublishedTopic) -> bool:
        return not item.controller or self._session.controls[item.robot].manager.is_active(item.controller)


def _period(item: PublishedTopic, rate: float | None) -> float | None:
    """Return the time between two deliveries (s) for a rate (Hz), by default the topic's own; None for once."""
    if item.rate is None:
        return None
    rate = rate or item.rate
    if item.sensor:
        rate = item.rate / max(1, ceil(item.rate / rate - 1e-9))  # it measures at multiples of its own period only
    return 1.0 / rate
