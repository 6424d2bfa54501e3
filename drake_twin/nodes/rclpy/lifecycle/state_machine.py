"""The states of a node with a life cycle, and the transitions between them.

Source: ros2/rcl (jazzy), rcl_lifecycle/src/default_state_machine.c.
"""

from typing import ClassVar, NamedTuple

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
    """The state of a node.

    Attributes:
        current: The state.
    """

    def __init__(self) -> None:
        self.current = STATES["unconfigured"]

    @property
    def available(self) -> list[LifecycleTransition]:
        """Return the transitions from the present state."""
        return [item for item in TRANSITIONS if item.start is self.current]

    def trigger(self, key: int | str) -> LifecycleTransition:
        """Make a transition, by its number or name; return it.

        Raises:
            RCLError: If the present state has no such transition.
        """
        for item in self.available:
            if key in (item.transition_id, item.label):
                self.current = item.goal
                return item
        raise RCLError(f"Failed to trigger lifecycle state machine transition {key!r} from {self.current.label}")
