"""Sliders for commanded joints: one for each number of a command topic."""

from collections.abc import Iterator
from math import isfinite, pi
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import Joint
from drake_twin.errors import InputError
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.twin.twin import Twin

_NUMBERS, _TRAJECTORY = "std_msgs/msg/Float64MultiArray", "trajectory_msgs/msg/JointTrajectory"
_GRIPPER, _PARALLEL_GRIPPER = "control_msgs/action/GripperCommand", "control_msgs/action/ParallelGripperCommand"
_UNITS = {
    "position": ("rad", "m"),
    "velocity": ("rad/s", "m/s"),
    "effort": ("N·m", "N"),
}
_WIDEST = {
    "position": 2 * pi,
    "velocity": 20.0,
    "effort": 200.0,
}  # for joints without a limit, or with a very large one
_SHORTEST_MOVE = 0.2  # s
_PART_OF_VELOCITY_LIMIT = 0.5  # of trajectories that a slider sends
_UNLIMITED_VELOCITY = 1.0  # rad/s or m/s, where a joint has no limit


@dataclass(frozen=True)
class Slider:
    """One number of a command.

    Attributes:
        joint: The joint, or the reference of another controller.
        interface: ``position``, ``velocity`` or ``effort``.
        unit: The unit.
        lower: The lowest value, in the unit.
        upper: The highest value, in the unit.
    """

    joint: str
    interface: str
    unit: str
    lower: float
    upper: float


@dataclass(frozen=True)
class SliderGroup:
    """A command topic, or a gripper's action, and its sliders.

    Attributes:
        topic: The topic or the action.
        type: Its ROS type.
        robot: The robot's name.
        controller: The controller that subscribes.
        sliders: One for each number, in order; for a trajectory one for each joint.
    """

    topic: str
    type: str
    robot: str
    controller: str
    sliders: tuple[Slider, ...]


def slider_groups(twin: Twin) -> tuple[SliderGroup, ...]:
    """Return the command topics and actions that sliders can command."""
    plans = {plan.name: plan for plan in twin.built.plans}
    groups = []
    for topic, item in twin.built.commanded.items():
        plan = plans[item.robot]
        if item.type == _NUMBERS:
            sliders = [
                _slider(plan, interface.joint, interface.name, *bounds)
                for interface, bounds in twin.graph.command_limits(topic).items()
                if interface.joint not in plan.description.gpios
            ]
        elif item.type == _TRAJECTORY:
            claims = next(each.claims for each in plan.controllers if each.name == item.controller)
            joints = dict.fromkeys(claim.joint for claim in claims if claim.joint in plan.description.joints_by_name)
            limits = {joint: plan.description.joints_by_name[joint].limits for joint in joints}
            sliders = [_slider(plan, name, "position", item.lower, item.upper) for name, item in limits.items()]
        else:
            continue
        if sliders:
            groups.append(SliderGroup(topic, item.type, item.robot, item.controller, tuple(sliders)))
    return (*groups, *_grippers(twin))


def _grippers(twin: Twin) -> Iterator[SliderGroup]:
    actions = twin.graph.actions()
    for plan in twin.built.plans:
        for controller in plan.controllers:
            action = f"{plan.robot.topic_namespace}/{controller.name}/gripper_cmd"
            if actions.get(action) not in (_GRIPPER, _PARALLEL_GRIPPER) or not controller.claims:
                continue
            joint = plan.description.joints_by_name[controller.claims[0].joint]
            yield SliderGroup(action, actions[action], plan.name, controller.name, (joint_slider(joint),))


def joint_slider(joint: Joint) -> Slider:
    """Return a slider for a joint's position."""
    return _bounded(joint, joint.name, "position", joint.limits.lower, joint.limits.upper)


class JointCommands:
    """Reads the value of every slider from a twin, and publishes changed values.

    Args:
        twin: The twin.

    Attributes:
        groups: Topic or action → its sliders.
    """

    def __init__(self, twin: Twin):
        self._twin = twin
        self.groups = {group.topic: group for group in slider_groups(twin)}
        self._targets: dict[str, np.ndarray] = {}

    def values(self, topic: str) -> np.ndarray:
        """Return the present command; without one, the values that would keep the joints at rest."""
        group = self.groups[topic]
        if group.type != _NUMBERS:
            return self._targets.get(topic, self._at_rest(group))
        command = self._twin.graph.command(topic)
        return self._at_rest(group) if command is None else np.asarray(command.data, dtype=float)

    def message(self, topic: str) -> dict[str, Any]:
        """Return the fields of a message on a topic that has sliders: their present values."""
        group, values = self.groups[topic], self.values(topic)
        return self._trajectory(group, values) if group.type == _TRAJECTORY else {"data": values.tolist()}

    def move(self, topic: str, index: int, value: float) -> None:
        """Command one number and keep the others; the scenario's own commands on the topic end.

        Raises:
            InputError: If the topic or the index has no slider, or the twin refuses the command.
        """
        if topic not in self.groups:
            raise InputError(f"{topic!r} has no sliders", value=topic, valid=self.groups)
        group = self.groups[topic]
        if not 0 <= index < len(group.sliders):
            raise InputError(f"{topic}: unknown slider {index}: the command has {len(group.sliders)} numbers")
        values = self.values(topic).copy()
        values[index] = min(max(value, group.sliders[index].lower), group.sliders[index].upper)
        if group.type in (_GRIPPER, _PARALLEL_GRIPPER):
            self._twin.graph.send_goal(topic, self._grip(group, float(values[0])))
        else:
            self._twin.graph.silence(topic)
            self._twin.publish(topic, values if group.type == _NUMBERS else self._trajectory(group, values))
        if group.type != _NUMBERS:
            self._targets[topic] = values

    def forget(self) -> None:
        """Forget the targets of trajectories and grippers, after a reset or a switch."""
        self._targets.clear()

    def _at_rest(self, group: SliderGroup) -> np.ndarray:
        positions: dict[str, float] = {}
        if any(slider.interface == "position" for slider in group.sliders):
            state = self._twin.robot_state(group.robot, with_efforts=False)
            positions = dict(zip(state.joints, state.positions, strict=True))
        return np.array(
            [
                min(max(positions.get(slider.joint, 0.0), slider.lower), slider.upper)
                if slider.interface == "position"
                else min(max(0.0, slider.lower), slider.upper)
                for slider in group.sliders
            ]
        )

    def _grip(self, group: SliderGroup, position: float) -> dict[str, Any]:
        """Return a gripper's goal, with the effort limit of its joint."""
        (slider,) = group.sliders
        if group.type == _PARALLEL_GRIPPER:
            return {"command": {"name": [slider.joint], "position": [position]}}
        effort = self._joint(group, slider).limits.effort
        effort = effort if isfinite(effort) else _WIDEST["effort"]
        return {"command": {"position": position, "max_effort": effort}}

    def _joint(self, group: SliderGroup, slider: Slider) -> Joint:
        plan = next(plan for plan in self._twin.built.plans if plan.name == group.robot)
        return plan.description.joints_by_name[slider.joint]

    def _trajectory(self, group: SliderGroup, values: np.ndarray) -> dict[str, Any]:
        """Return a trajectory of one point, at half of the joints' velocity limits."""
        limits = [self._joint(group, slider).limits.velocity for slider in group.sliders]
        fastest = np.array([limit if isfinite(limit) and limit > 0 else _UNLIMITED_VELOCITY for limit in limits])
        distance = np.abs(values - self._at_rest(group))
        duration = max(_SHORTEST_MOVE, float(np.max(distance / (_PART_OF_VELOCITY_LIMIT * fastest))))
        return {
            "joint_names": [slider.joint for slider in group.sliders],
            "points": [{"positions": values.tolist(), "time_from_start": duration}],
        }


def _slider(plan: RobotPlan, joint: str, interface: str, lower: float, upper: float) -> Slider:
    known = plan.description.joints_by_name.get(joint.rpartition("/")[2])
    return _bounded(known, joint, interface, lower, upper)


def _bounded(joint: Joint | None, name: str, interface: str, lower: float, upper: float) -> Slider:
    slides = joint is not None and joint.type == "prismatic"
    widest = 1.0 if slides and interface == "position" else _WIDEST[interface]
    if not isfinite(lower) or interface != "position":
        lower = max(lower, -widest)
    if not isfinite(upper) or interface != "position":
        upper = min(upper, widest)
    return Slider(name, interface, _UNITS[interface][slides], lower, max(lower, upper))
