"""The states of a node with a life cycle, and the transitions between them.

Source: ros2/rcl (jazzy), rcl_lifecycle/src/default_state_machine.c.
"""

from collections.abc import Callable
from typing import Any, ClassVar, NamedTuple

from drake_twin.nodes.rclpy._rclpy_pybind11 import RCLError
from drake_twin.nodes.rclpy.native import NativeEnum, unreadable


class TransitionCallbackReturn(NativeEnum):
    """How a transition ends."""

    SUCCESS: ClassVar["TransitionCallbackReturn"]
    FAILURE: ClassVar["TransitionCallbackReturn"]
    ERROR: ClassVar["TransitionCallbackReturn"]

    @unreadable
    def to_label(self) -> str:
        return f"transition_{self.name.lower()}"


TransitionCallbackReturn._add(SUCCESS=97, FAILURE=98, ERROR=99)


class LifecycleState(NamedTuple):
    """A state of a node."""

    label: str
    state_id: int


class LifecycleTransition(NamedTuple):
    """A transition: its number and name, and the states that it leads from and to."""

    transition_id: int
    label: str
    start: LifecycleState
    goal: LifecycleState


STATES = {
    label: LifecycleState(label, number)
    for label, number in (
        ("unknown", 0),
        ("unconfigured", 1),
        ("inactive", 2),
        ("active", 3),
        ("finalized", 4),
        ("configuring", 10),
        ("cleaningup", 11),
        ("shuttingdown", 12),
        ("activating", 13),
        ("deactivating", 14),
        ("errorprocessing", 15),
    )
}

TRANSITIONS = tuple(
    LifecycleTransition(number, label, STATES[start], STATES[goal])
    for number, label, start, goal in (
        (1, "configure", "unconfigured", "configuring"),
        (10, "transition_success", "configuring", "inactive"),
        (11, "transition_failure", "configuring", "unconfigured"),
        (12, "transition_error", "configuring", "errorprocessing"),
        (2, "cleanup", "inactive", "cleaningup"),
        (20, "transition_success", "cleaningup", "unconfigured"),
        (21, "transition_failure", "cleaningup", "inactive"),
        (22, "transition_error", "cleaningup", "errorprocessing"),
        (3, "activate", "inactive", "activating"),
        (30, "transition_success", "activating", "active"),
        (31, "transition_failure", "activating", "inactive"),
        (32, "transition_error", "activating", "errorprocessing"),
        (4, "deactivate", "active", "deactivating"),
        (40, "transition_success", "deactivating", "inactive"),
        (41, "transition_failure", "deactivating", "active"),
        (42, "transition_error", "deactivating", "errorprocessing"),
        (5, "shutdown", "unconfigured", "shuttingdown"),
        (6, "shutdown", "inactive", "shuttingdown"),
        (7, "shutdown", "active", "shuttingdown"),
        (50, "transition_success", "shuttingdown", "finalized"),
        (51, "transition_failure", "shuttingdown", "finalized"),
        (52, "transition_error", "shuttingdown", "errorprocessing"),
        (60, "transition_success", "errorprocessing", "unconfigured"),
        (61, "transition_failure", "errorprocessing", "finalized"),
        (62, "transition_error", "errorprocessing", "finalized"),
    )
)


class StateMachine:
    """The state of a node, with the names that rclpy's C++ gives to what it tells: users' programs ask for the state.

    Args:
        has_services: Whether the node answers and publishes.

    Attributes:
        current: The state.
        is_told: Takes a transition that is to be published.
        services: The node's services, by their names.
    """

    initialized = True

    def __init__(self, has_services: bool) -> None:
        if not isinstance(has_services, bool):
            raise TypeError(f"__init__(): incompatible constructor arguments: {has_services!r} is not a bool")
        self.current = STATES["unconfigured"]
        self.is_told: Callable[[LifecycleTransition], None] = lambda transition: None
        self.services: dict[str, Any] = {}

    @property
    def available(self) -> list[LifecycleTransition]:
        """Return the transitions from the present state."""
        return [item for item in TRANSITIONS if item.start is self.current]

    @property
    def current_state(self) -> tuple[int, str]:
        return self.current.state_id, self.current.label

    available_states = property(lambda self: [(state.state_id, state.label) for state in STATES.values()])
    available_transitions = property(lambda self: [_as_tuple(item) for item in self.available])
    transition_graph = property(lambda self: [_as_tuple(item) for item in TRANSITIONS])

    def __getattr__(self, name: str) -> Any:
        if name.startswith("service_"):
            return self.services.get(name.removeprefix("service_"))
        raise AttributeError(f"{type(self).__name__!r} object has no attribute {name!r}")

    def get_transition_by_label(self, label: str) -> int:
        for item in self.available:
            if item.label == label:
                return item.transition_id
        raise RCLError("Failed to get transition from label")

    def trigger_transition_by_id(self, transition_id: int, publish_update: bool) -> None:
        self._trigger(transition_id, publish_update)

    def trigger_transition_by_label(self, label: str, publish_update: bool) -> None:
        self._trigger(label, publish_update)

    def _trigger(self, key: int | str, publish_update: bool) -> None:
        for item in self.available:
            if key in (item.transition_id, item.label):
                self.current = item.goal
                if publish_update:
                    self.is_told(item)
                return
        text = f"Failed to trigger lifecycle state machine transition {key!r} from {self.current.label}"
        raise RCLError(text)


def _as_tuple(item: LifecycleTransition) -> tuple[int, str, int, str, int, str]:
    start, goal = item.start, item.goal
    return item.transition_id, item.label, start.state_id, start.label, goal.state_id, goal.label
