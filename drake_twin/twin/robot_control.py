"""One robot's controllers in a running diagram: switches, commands, failures, emergency stop."""

import functools
import logging
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from typing import Any

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.controllers.base_controller import Controller
from drake_twin.controllers.stateful_controller import StatefulController
from drake_twin.diagram.plant import RobotInPlant
from drake_twin.diagram.robot_diagram import RobotDiagram
from drake_twin.diagram.servo_assignment import assign
from drake_twin.diagram.servo_gains import BRAKE, set_gains
from drake_twin.diagram.topics import CommandTopic
from drake_twin.errors import CommandError, InputError, TwinError, described
from drake_twin.findings import Finding, Kind
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.systems.joint_servo import ServoAssignment
from drake_twin.twin.controller_manager import ControllerManager
from drake_twin.twin.owner import Owner
from drake_twin.twin.physics import Physics
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.servo_modes import (
    CHECK_PERIOD,
    JointMotion,
    check_period,
    driven_joints,
    next_modes,
    released,
    slipping_range,
    without_commands,
)

_log = logging.getLogger(__name__)


class RobotControl:
    """Carry out the decisions of the robot's controller manager.

    Args:
        plan: The robot.
        clear: Called with the robot and a controller whose input ports are to be cleared.
        note: Called with each user's call that changes the controllers.
        owner: The thread that the twin belongs to.

    Attributes:
        owner: The thread that the twin belongs to.
        manager: The controller manager.
        command_delay: How much later commands reach its controllers (s).
        stopped: Whether an emergency stop is active.
        kept: The servo's assignment before the last change; the twin clears it before each advance.
        faults: What made controllers fail, in the order in which it happened.
        check_period: The period at which to call `check_joints` (s); None while no joint needs it.
    """

    _plant: MultibodyPlant
    _plant_context: Context
    _servo_context: Context
    _gpio_context: Context
    _parts: RobotDiagram
    _in_plant: RobotInPlant

    def __init__(self, plan: RobotPlan, clear: Callable[[str, str], None], note: Callable[..., object], owner: Owner):
        self.owner = owner
        self._plan = plan
        self._clear = clear
        self._note = note
        self.controllers: dict[str, Controller] = {}
        self._contexts: dict[str, Context] = {}
        self.manager = ControllerManager(
            plan, self._switch, functools.partial(note, "controller_manager", plan.name), owner
        )
        self.command_delay = plan.robot.command_delay
        self.stopped = False
        self.check_period: float | None = None
        self.kept: ServoAssignment | None = None
        self.faults: list[Finding] = []
        self._elements = {item.name: item.wiring.elements for item in plan.controllers if item.wiring is not None}

    def use(self, physics: Physics) -> None:
        """Switch to a newly built diagram."""
        self._plant = physics.built.plant
        self._plant_context = physics.plant_context
        self._parts = physics.built.parts[self._plan.name]
        self._in_plant = physics.built.robots[self._plan.name]
        self.controllers = self._parts.controllers
        self._contexts = {
            name: controller.GetMyMutableContextFromRoot(physics.context)
            for name, controller in self.controllers.items()
        }
        if self._parts.servo is not None:
            self._servo_context = self._parts.servo.GetMyMutableContextFromRoot(physics.context)
        if self._parts.gpios is not None:
            self._gpio_context = self._parts.gpios.GetMyMutableContextFromRoot(physics.context)
        self._gains = physics.gains[self._plan.name]
        self._islands = physics.islands
        self._joints = driven_joints(self._plan.description, self._parts.joints, self._gains)
        layout = self._in_plant.layout
        names = [
            joint or next(iter(layout.positions)) for joint in self._parts.joints
        ]  # any joint for an actuator that models friction
        self._positions = [layout.positions[name] for name in names]
        self._velocities = [layout.velocities[name] for name in names]
        self._apply_gains()

    @property
    def plan(self) -> RobotPlan:
        """The robot."""
        return self._plan

    def follow(self, plan: RobotPlan) -> None:
        """Follow another plan of the robot, with other parameters of its controllers; `use` is called after it."""
        self._plan = plan
        self._elements = {item.name: item.wiring.elements for item in plan.controllers if item.wiring is not None}
        self.manager.follow(plan)

    def retire(self) -> None:
        """Release the diagram, because the robot has been deleted; its manager has no controllers from now on."""
        self.manager.retire()
        self.controllers, self._contexts = {}, {}
        del self._plant, self._plant_context, self._parts, self._in_plant, self._islands
        self.__dict__.pop("_servo_context", None)

    def start(self) -> None:
        """Activate the controllers that are active at the start, in a context with the default state."""
        self.manager.restart()
        self.stopped = False
        for name in self.manager.active:
            if name in self.controllers:
                self.controllers[name].activate(self.context_of(name))
        self._apply_gains()
        self.follow_commands()  # some begin with one

    def context_of(self, controller: str) -> Context:
        """Return a controller's own context."""
        return self._contexts[controller]

    def read(self, topic: CommandTopic, data: Any) -> Any:
        """Convert a message to the value of a topic's port.

        Raises:
            CommandError: If the data does not fit the topic's type, or the controller refuses it.
        """
        try:
            kind = f"{topic.type}_Goal" if "/action/" in topic.type else topic.type
            message: Any
            if kind == "std_msgs/msg/Float64MultiArray" and isinstance(data, list | tuple | np.ndarray):
                message = messages.Numbers.read(data)
            else:
                message = messages.message(kind, data)
        except (TypeError, ValueError) as error:
            is_list = topic.type == "std_msgs/msg/Float64MultiArray" and not isinstance(data, Mapping)
            text = f"{messages.shortened(data)} is not a list of numbers" if is_list else str(error)
            raise CommandError(text) from None
        controller = self.controllers[topic.controller]
        element = self._elements.get(topic.controller, {}).get(topic.name)
        if element is None and topic.type == "std_msgs/msg/Float64" and controller.subscribed[topic.name] != topic.type:
            element = "data", None
        if element is not None:
            message = messages.Numbers((_element(message, *element),) * len(controller.claims))
        try:
            return controller.read(topic.name, message, self._contexts[topic.controller])
        except TwinError:
            raise
        except Exception as error:  # of a class from outside
            raise CommandError(described(error)) from error

    def cancel(self, controller: str) -> None:
        """Cancel the newest goal of a controller's action.

        Raises:
            InputError: If the robot has no such controller.
        """
        if controller not in self.controllers:
            text = f"robot {self._plan.name!r} has no controller {controller!r}"
            raise InputError(text, value=str(controller), valid=self.controllers)
        self._note("cancel", self._plan.name, controller)
        self.controllers[controller].cancel(self.context_of(controller))

    def deactivate_faulty(self) -> None:
        """Deactivate the controllers whose last update failed."""
        for name in self.manager.active:
            if name in self.controllers:
                fault = self.controllers[name].fault(self.context_of(name))
                if fault is not None:
                    self.deactivate(name, fault)

    def deactivate(self, controller: str, why: str) -> None:
        """Deactivate a controller, activate its fallback controllers, and log the reason."""
        before = self.manager.active
        stopped = self.manager.deactivate_failed(controller)
        what = f"controller {', '.join(stopped)} is deactivated: {why}"
        fallbacks = [name for name in self.manager.active if name not in before or name in stopped]
        if fallbacks:
            what += f"; fallback controllers {', '.join(fallbacks)} are activated"
        self.faults.append(Finding(Kind.FAILED, what, self._plan.name))
        node = f"{self._plan.robot.topic_namespace}/controller_manager"
        _log.error("%s: %s", self._plan.name, what, extra={"node": node})

    def take_back(self) -> None:
        """Restore the assignment in `kept`, because the next step has failed."""
        servo = self._parts.servo
        if servo is not None and self.kept is not None:
            servo.assign(self._servo_context, self.kept)
            self._apply_gains()
            self.kept = None

    def follow_commands(self) -> None:
        """Drive the joints as the present commands require."""
        self._next_modes(is_check=False)

    def check_joints(self) -> None:
        """Hold joints that have come to rest, and let those slip that are pushed away."""
        if self.check_period == CHECK_PERIOD or self._is_pushed_away():
            self._next_modes(is_check=True)

    def release(self, joints: Collection[str]) -> None:
        """Hold joints with a commanded velocity at the positions to which they have been moved."""
        servo = self._parts.servo
        if servo is not None:
            context = self._servo_context
            indices = [index for index, joint in enumerate(self._parts.joints) if joint in joints]
            servo.assign(context, released(servo.assignment(context), indices))
            self._apply_gains()

    def emergency_stop(self) -> None:
        """Brake all joints until they are at rest, and hold them; cancel all goals."""
        if not self.stopped:
            for name in self.manager.active:
                if name in self.controllers:
                    self.controllers[name].cancel(self.context_of(name))
            modes, holds = self._stopped_joints()
            self.stopped = True
            self._assign(modes, holds)

    def clear_emergency_stop(self) -> None:
        """Let the controllers command again; each of them is restarted."""
        if self.stopped:
            self.stopped = False
            self._switch(self.manager.active, self.manager.active)

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps: controllers, their memory, the servo's assignment."""
        servo, gpios = self._parts.servo, self._parts.gpios
        return {
            "robots": {
                self._plan.name: {
                    "controllers": self.manager.states,
                    "samples": {
                        name: to_plain(controller.sample(context)) for name, controller, context in self._stateful()
                    },
                    "servo": None if servo is None else to_plain(servo.assignment(self._servo_context)),
                    "stopped": self.stopped,
                    **({} if gpios is None else {"gpios": to_plain(gpios.values(self._gpio_context).tolist())}),
                }
            }
        }

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned.

        Raises:
            ValueError: If they are those of another robot.
        """
        saved = state["robots"][self._plan.name]
        self.manager.set_states(saved["controllers"])
        self.stopped = bool(saved["stopped"])
        stateful = list(self._stateful())
        if set(saved["samples"]) != {name for name, _, _ in stateful}:
            raise ValueError(f"samples of {', '.join(name for name, _, _ in stateful)} are needed")
        for name, controller, context in stateful:
            sample = from_plain(saved["samples"][name])
            controller.set_sample(context, _like(controller.sample(context), sample))
        servo = self._parts.servo
        if servo is not None:
            assignment = _like(servo.assignment(self._servo_context), from_plain(saved["servo"]))
            servo.check(assignment)
            servo.assign(self._servo_context, assignment)
        if self._parts.gpios is not None and "gpios" in saved:
            self._parts.gpios.set_values(self._gpio_context, from_plain(saved["gpios"]))
        self._apply_gains()

    def _stateful(self) -> Iterator[tuple[str, StatefulController, Context]]:
        for name, controller in self.controllers.items():
            if isinstance(controller, StatefulController):
                yield name, controller, self.context_of(name)

    def _switch(self, started: tuple[str, ...], stopped: tuple[str, ...]) -> None:
        modes, holds = self._stopped_joints()
        for name in stopped:
            if name in self.controllers:
                self.controllers[name].deactivate(
                    self.context_of(name)
                )  # before the clearing, so that it sees a pending goal
                self._clear(self._plan.name, name)
        for name in started:
            if name in self.controllers:
                self._clear(self._plan.name, name)
                self.controllers[name].activate(self.context_of(name))
        self._assign(modes, holds)

    def _stopped_joints(self) -> tuple[tuple[str, ...], tuple[float, ...]]:
        """Return the modes and held positions of the joints once the present controllers stop writing."""
        servo = self._parts.servo
        if servo is None:
            return (), ()
        self.follow_commands()
        return without_commands(servo.assignment(self._servo_context), self._joints, self._motion())

    def _assign(self, modes: Sequence[str], holds: Sequence[float]) -> None:
        """Let the joints follow the active controllers."""
        servo = self._parts.servo
        if servo is None:
            return
        driving = {name: item for name, item in self.controllers.items() if item.claims}
        active = () if self.stopped else self.manager.active
        hold_joints = self._plan.joints.are_held or self.stopped
        assignment = assign(self._parts.joints, driving, active, holds, modes, hold_joints=hold_joints)
        servo.assign(self._servo_context, assignment)
        self._apply_gains()
        self.follow_commands()

    def _next_modes(self, *, is_check: bool) -> None:
        servo = self._parts.servo
        if servo is None:
            return
        context = self._servo_context
        now = servo.assignment(context)
        new = next_modes(
            now, self._joints, self._motion(with_gravity=is_check and BRAKE in now.modes), is_check=is_check
        )
        if new is not now:
            self.kept = self.kept or now
            servo.assign(context, new)
            self._apply_gains()

    def _is_pushed_away(self) -> bool:
        """Return whether a joint slips, which is faster to find than all new modes."""
        q = self._plant.GetPositions(self._plant_context, self._in_plant.instance)
        return not all(lower <= q[self._positions[index]] <= upper for index, lower, upper in self._slipping)

    def _motion(self, *, with_gravity: bool = False) -> JointMotion:
        """Return the joints' motion and commands."""
        servo, plant, instance = self._parts.servo, self._plant, self._in_plant.instance
        assert servo is not None
        context = self._plant_context
        state = plant.GetPositionsAndVelocities(context, instance).tolist()
        gravity = [0.0] * len(state)
        if with_gravity:
            forces = plant.GetVelocitiesFromArray(instance, plant.CalcGravityGeneralizedForces(context)).tolist()
            gravity[-len(forces) :] = forces
        return JointMotion(
            list(map(state.__getitem__, self._positions)),
            list(map(state.__getitem__, self._velocities)),
            list(map(gravity.__getitem__, self._velocities)),
            *servo.commanded(self._servo_context),
        )

    def _apply_gains(self) -> None:
        servo = self._parts.servo
        if servo is not None:
            assignment = servo.assignment(self._servo_context)
            set_gains(self._plant, self._in_plant.instance, self._gains, assignment.modes)
            if self._islands is not None:
                self._islands.archipelago.inputs.moved_motors.add(self._plan.name)
            self.check_period = check_period(assignment)
            self._slipping = slipping_range(assignment, self._joints)


def _element(message: Any, field: str, index: int | None) -> float:
    """Return the number of a message that commands a plugin's joints.

    Raises:
        CommandError: If the message does not have it.
    """
    value = getattr(message, field)
    if index is None:
        return float(value)
    if index >= len(value):
        raise CommandError(f"{field}[{index}] is commanded, but the message has {len(value)} elements of {field}")
    return float(value[index])


def _like(present: Any, saved: Any) -> Any:
    """Return a saved value if it is of the present one's type.

    Raises:
        ValueError: If it is not.
    """
    if type(saved) is not type(present):
        raise ValueError(f"{type(saved).__name__} is not {type(present).__name__}")
    return saved
