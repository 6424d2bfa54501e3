"""What a session does by itself between two steps, because of what it hears and where its models are."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any, Protocol

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.twin.clock import Clock
from drake_twin.twin.event_topics import EventTopics
from drake_twin.twin.physics import Physics
from drake_twin.twin.subscriptions import Subscriptions
from drake_twin.twin.triggers import Triggers

if TYPE_CHECKING:
    from drake_twin.twin.deployments import Deployments
    from drake_twin.twin.performer_detectors import PerformerDetectors
    from drake_twin.twin.touch_detectors import TouchDetectors


class _Part(Protocol):
    def start(self) -> None: ...
    def state(self) -> dict[str, Any]: ...
    def set_state(self, state: Any) -> None: ...


class Reactions:
    """The parts of a session that act by themselves; those that few worlds need are loaded with the first one.

    Args:
        clock: The time.
        events: The topics that no port of the diagram has; those of these parts are added to them.
        subscriptions: The callbacks of topics.

    Attributes:
        triggers: What publishes messages when it hears one.
        detectors: What notices performers; None before there is some.
        touches: What tells of touches, likewise.
        deployments: What robots have dropped, likewise.
    """

    def __init__(self, clock: Clock, events: EventTopics, subscriptions: Subscriptions):
        self._clock, self._events = clock, events
        self.triggers = Triggers(clock, events, subscriptions)
        self.detectors: PerformerDetectors | None = None
        self.touches: TouchDetectors | None = None
        self.deployments: Deployments | None = None

    @property
    def parts(self) -> Sequence[_Part]:
        """The parts, which have state."""
        parts = self.triggers, self.detectors, self.deployments, self.touches
        return [part for part in parts if part is not None]

    @property
    def are_pending(self) -> bool:
        """Whether something is due at a step."""
        return bool(self.triggers.pending) or (self.deployments is not None and bool(self.deployments.moving))

    @property
    def are_watching(self) -> bool:
        """Whether something is looked at after each step."""
        if self.detectors is not None and self.detectors.is_watching:
            return True
        return self.touches is not None and self.touches.is_watching

    def use(self, built: TwinDiagram) -> None:
        """Switch to a newly built diagram."""
        detection = built.detection
        if detection is not None and detection.detectors and self.detectors is None:
            from drake_twin.twin.performer_detectors import PerformerDetectors

            self.detectors = PerformerDetectors(self._clock, self._events, self.triggers.take)
        if detection is not None and detection.touches and self.touches is None:
            from drake_twin.twin.touch_detectors import TouchDetectors

            self.touches = TouchDetectors(self._clock, self._events, self.triggers.take)
        if self.deployments is None and any(item.trigger.requests for item in built.triggers):
            from drake_twin.twin.deployments import Deployments

            self.deployments = Deployments(self._clock, self._events)
        known = [part for part in (self.detectors, self.touches, self.deployments) if part is not None]
        for part in known:
            part.use(built)
        self.triggers.use(built, [endpoint for part in known for endpoint in part.endpoints])

    def look(self, physics: Physics) -> None:
        """Look at the step that has ended."""
        for part in (self.detectors, self.touches):
            if part is not None and part.is_watching:
                part.look(physics)

    def act(self) -> None:
        """Do what is due at the present step."""
        if self.triggers.pending:
            self.triggers.apply()
        if self.deployments is not None and self.deployments.moving:
            self.deployments.fix_due(self.triggers.request)

    def due_steps(self) -> list[float]:
        """Return the steps at which something is due."""
        due = self.triggers.due_steps() if self.triggers.pending else []
        return due if self.deployments is None else [*due, *self.deployments.due_steps()]

    def start(self) -> None:
        """Forget what has been heard and noticed; what has been dropped is still there."""
        for part in self.parts:
            part.start()
