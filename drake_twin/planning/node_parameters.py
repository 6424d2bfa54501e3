"""The parameters of a robot's ``controller_manager`` and ``robot_state_publisher``, as these declare them in ROS.

Source: ``controller_manager_parameters.yaml`` of Jazzy's ros2_control and ``robot_state_publisher.cpp``. A parameter
that has no effect here is declared all the same, so that programs which set it find it.
"""

import math
from collections.abc import Iterator
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.declared_parameters import DeclaredParameter
from drake_twin.messages.parameter_value import type_of
from drake_twin.planning.controller_plan import USE_SIM_TIME
from drake_twin.planning.robot_plan import RobotPlan

CONTROLLER_MANAGER, STATE_PUBLISHER = "controller_manager", "robot_state_publisher"
STRICTNESS = "defaults.switch_controller.strictness"
STRICTNESSES = {"best_effort": 1, "strict": 2}  # as a request of a switch has them
_UNUSED = "without effect in the twin"
_ABOVE_ZERO = math.nextafter(0.0, 1.0)
_THRESHOLDS = {  # measured value → thresholds of its mean error and standard deviation, each for a warning and an error
    "controller_manager.periodicity": ((5.0, 10.0), (5.0, 10.0)),  # Hz
    "controllers.periodicity": ((5.0, 10.0), (5.0, 10.0)),
    "controllers.execution_time": ((1000.0, 2000.0), (100.0, 200.0)),  # µs
    "hardware_components.periodicity": ((5.0, 10.0), (5.0, 10.0)),
    "hardware_components.execution_time": ((1000.0, 2000.0), (100.0, 200.0)),
}


@dataclass(frozen=True)
class _Given(DeclaredParameter):
    """A parameter that upstream lets set, and that the robot's files alone give here."""

    def refusal(self, value: Any) -> str:
        given = tuple(value) if isinstance(value, list) else value
        if given == self.value:
            return ""
        return f"parameter {self.name!r} cannot be changed while the twin runs: the robot's files give it"


@dataclass(frozen=True)
class _Frequency(DeclaredParameter):
    """A rate that the node checks itself, so that its descriptor has no range."""

    def refusal(self, value: Any) -> str:
        if reason := super().refusal(value):
            return reason
        return "" if 0.0 <= value <= 1000.0 else f"{self.name} must be between 0.0 and 1000.0"


def node_parameters(plan: RobotPlan, node: str) -> dict[str, DeclaredParameter]:
    """Return the parameters of a robot's node by their names; empty for a node that is a controller.

    Args:
        plan: The robot.
        node: `CONTROLLER_MANAGER` or `STATE_PUBLISHER`.
    """
    declared = {CONTROLLER_MANAGER: _of_manager, STATE_PUBLISHER: _of_publisher}.get(node)
    return {} if declared is None else {item.name: item for item in (use_sim_time(), *declared(plan))}


def use_sim_time() -> DeclaredParameter:
    """Return the parameter that all nodes have."""
    return DeclaredParameter(USE_SIM_TIME, 1, value=True, description="Whether the time is that of /clock")


def _of_publisher(plan: RobotPlan) -> Iterator[DeclaredParameter]:
    yield _Given("robot_description", 4, plan.description.text, "The robot as URDF")
    text = "The highest rate of its moving joints on /tf (Hz); 0 for that of the joint states"
    yield _Frequency("publish_frequency", 3, float(plan.robot.publish_frequency), text, is_live=True)
    text = "What stands before the names of the links in /tf and /tf_static"
    yield DeclaredParameter("frame_prefix", 4, plan.frame_prefix, text, is_live=True)
    text = f"Whether joint states are taken that are older than the last ones: {_UNUSED}, where none are"
    yield DeclaredParameter("ignore_timestamp", 1, value=False, description=text)


def _of_manager(plan: RobotPlan) -> Iterator[DeclaredParameter]:
    def fixed(name: str, value: bool, text: str) -> DeclaredParameter:
        return DeclaredParameter(name, 1, value, text, is_read_only=True)

    manager = plan.manager
    text = "The rate at which controllers are updated (Hz)"
    yield DeclaredParameter("update_rate", 2, round(manager.update_rate), text, lower=1, is_read_only=True)
    text = "Whether commands are clamped to the limits of the joints"
    yield fixed("enforce_command_limits", manager.enforce_command_limits, text)
    yield fixed("handle_exceptions", True, f"Whether exceptions of controllers are caught: {_UNUSED}")
    for state in ("unconfigured", "inactive"):
        name = f"hardware_components_initial_state.{state}"
        of_state = tuple(each for each, (its, _) in manager.hardware_states.items() if its == state)
        yield _Given(name, 9, of_state, f"The hardware components that are {state} at the start")
    text = f"Whether to end where hardware does not reach its state at the start: {_UNUSED}"
    yield fixed("hardware_components_initial_state.shutdown_on_initial_state_failure", True, text)
    (strictness,) = (name for name, number in STRICTNESSES.items() if number == manager.strictness)
    yield DeclaredParameter(
        STRICTNESS,
        4,
        strictness,
        "The strictness of a switch of controllers that names none",
        f"one of {', '.join(STRICTNESSES)}",
        choices=tuple(STRICTNESSES),
        is_filled=True,
        is_live=True,
    )
    text = "Whether controllers may claim interfaces of inactive hardware"
    name = "defaults.allow_controller_activation_with_inactive_hardware"
    yield fixed(name, manager.uses_inactive_hardware, text)
    text = f"Whether controllers are deactivated with hardware that deactivates itself: {_UNUSED}"
    yield fixed("defaults.deactivate_controllers_on_hardware_self_deactivate", True, text)
    for measured, thresholds in _THRESHOLDS.items():
        for statistic, levels in zip(("mean_error", "standard_deviation"), thresholds, strict=True):
            for level, value in zip(("warn", "error"), levels, strict=True):
                name = f"diagnostics.threshold.{measured}.{statistic}.{level}"
                yield DeclaredParameter(name, 3, value, f"A limit in diagnostics: {_UNUSED}", lower=_ABOVE_ZERO)
    yield DeclaredParameter("overruns.print_warnings", 1, value=False, description=f"{_UNUSED}".capitalize())
    for item in plan.controllers:
        yield _Given(f"{item.name}.type", type_of(item.type), item.type, "The plugin of the controller")
