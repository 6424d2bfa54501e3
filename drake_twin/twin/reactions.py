"""What a session does by itself between two steps, because of what it hears and where its models are."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.twin.clock import Clock
from drake_twin.twin.endpoints import Endpoint
from drake_twin.twin.event_topics import EventTopics
from drake_twin.twin.physics import Physics
from drake_twin.twin.subscriptions import Subscriptions
from drake_twin.twin.triggers import Triggers

if TYPE_CHECKING:
    from drake_twin.twin.deployments import Deployments
    from drake_twin.twin.performer_detectors import PerformerDetectors
    from drake_twin.twin.touch_detectors import TouchDetectors

# Entry of a snapshot → the attribute of the part that it is of.
_ENTRIES = {"detected": "detectors", "touching": "touches", "deployed": "deployments", "to_be_fixed": "deployments"}


class Reactions:
    """The parts of a session that act by themselves; those that nothing in the twin asks for are not there.

    Args:
        clock: The time.
        events: The topics that no port of the diagram has; those of these parts are added to them.
        subscriptions: The callbacks of topics.

    Attributes:
        triggers: What publishes messages when it hears one.
        are_noticing: Whether there is something that may be looked at after each step.
        detectors: What notices performers.
        deployments: What robots have dropped.
        touches: What tells of touches.
    """

    def __init__(self, clock: Clock, events: EventTopics, subscriptions: Subscriptions):
        self._clock, self._events = clock, events
        self.triggers = Triggers(clock, events, subscriptions)
        self.detectors: PerformerDetectors | None = None
        self.deployments: Deployments | None = None
        self.touches: TouchDetectors | None = None
        self.are_noticing = False

    @property
    def are_watching(self) -> bool:
        """Whether something is looked at after each step."""
        is_noticed = self.detectors is not None and self.detectors.is_watching
        return is_noticed or (self.touches is not None and self.touches.is_watching)

    def look(self, physics: Physics) -> None:
        """Look at the step that has ended."""
        for part in (self.detectors, self.touches):
            if part is not None and part.is_watching:
                part.look(physics)

    def use(self, built: TwinDiagram) -> None:
        """Switch to a newly built diagram."""
        self._make(built)
        others: list[Endpoint] = []
        detection = built.detection
        for noticing in (self.detectors, self.touches):
            if noticing is not None and detection is not None:
                noticing.use(built, detection)
                others += noticing.endpoints
        if self.deployments is not None:
            self.deployments.use(built)
            others += self.deployments.endpoints
        self.triggers.use(built, others)

    def start(self) -> None:
        """Forget what has been heard and noticed; what has been dropped is still there."""
        for part in (self.triggers, self.detectors, self.deployments, self.touches):
            if part is not None:
                part.start()

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that the parts keep."""
        found: dict[str, Any] = {}
        for part in (self.triggers, self.detectors, self.deployments, self.touches):
            if part is not None:
                found |= part.state()
        return found

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned.

        Raises:
            ValueError: If they are those of other models.
        """
        for entry, part in _ENTRIES.items():
            if state.get(entry) and getattr(self, part) is None:
                raise ValueError(f"nothing in it has the entry {entry!r}")
        for each in (self.triggers, self.detectors, self.deployments, self.touches):
            if each is not None:
                each.set_state(state)

    def _make(self, built: TwinDiagram) -> None:
        """Make the parts that a diagram needs, and drop the others."""
        detection = built.detection
        if detection is None or not detection.detectors:
            self.detectors = None
        elif self.detectors is None:
            from drake_twin.twin.performer_detectors import PerformerDetectors

            self.detectors = PerformerDetectors(self._clock, self._events, self.triggers.take)
        if detection is None or not detection.touches:
            self.touches = None
        elif self.touches is None:
            from drake_twin.twin.touch_detectors import TouchDetectors

            self.touches = TouchDetectors(self._clock, self._events, self.triggers.take)
        self.are_noticing = self.detectors is not None or self.touches is not None
        drops = False
        if any(owned.trigger.requests for owned in built.triggers):
            from drake_twin.twin.deployments import Deployments, deploys

            drops = any(deploys(built))
            if drops and self.deployments is None:
                self.deployments = Deployments(self._clock, self._events)
        if not drops:
            self.deployments = None
