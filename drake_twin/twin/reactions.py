"""What a session does by itself between two steps, because of what it hears and where its models are."""

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.twin.clock import Clock
from drake_twin.twin.deployments import Deployments
from drake_twin.twin.event_topics import EventTopics
from drake_twin.twin.performer_detectors import PerformerDetectors
from drake_twin.twin.physics import Physics
from drake_twin.twin.subscriptions import Subscriptions
from drake_twin.twin.touch_detectors import TouchDetectors
from drake_twin.twin.triggers import Triggers


class Reactions:
    """The parts of a session that act by themselves.

    Args:
        clock: The time.
        events: The topics that no port of the diagram has; those of these parts are added to them.
        subscriptions: The callbacks of topics.

    Attributes:
        triggers: What publishes messages when it hears one.
        detectors: What notices performers.
        deployments: What robots have dropped.
        touches: What tells of touches.
    """

    def __init__(self, clock: Clock, events: EventTopics, subscriptions: Subscriptions):
        self.triggers = Triggers(clock, events, subscriptions)
        self.detectors = PerformerDetectors(clock, events, self.triggers.take)
        self.deployments = Deployments(clock, events)
        self.touches = TouchDetectors(clock, events, self.triggers.take)

    @property
    def parts(self) -> tuple[Triggers, PerformerDetectors, Deployments, TouchDetectors]:
        """The parts, which have state."""
        return self.triggers, self.detectors, self.deployments, self.touches

    @property
    def are_watching(self) -> bool:
        """Whether something is looked at after each step."""
        return self.detectors.is_watching or self.touches.is_watching

    def look(self, physics: Physics) -> None:
        """Look at the step that has ended."""
        if self.detectors.is_watching:
            self.detectors.look(physics)
        if self.touches.is_watching:
            self.touches.look(physics)

    def use(self, built: TwinDiagram) -> None:
        """Switch to a newly built diagram."""
        self.detectors.use(built)
        self.deployments.use(built)
        self.touches.use(built)
        others = (*self.detectors.endpoints, *self.deployments.endpoints, *self.touches.endpoints)
        self.triggers.use(built, others)

    def start(self) -> None:
        """Forget what has been heard and noticed; what has been dropped is still there."""
        self.triggers.start()
        self.detectors.start()
        self.deployments.start()
        self.touches.start()
