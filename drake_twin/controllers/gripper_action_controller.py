"""Grippers with one joint, as ros2_controllers' gripper action controllers command them."""

from dataclasses import field, replace
from math import isfinite
from typing import Any, ClassVar

from pydrake.systems.framework import Context

from drake_twin import messages
from drake_twin.control.gripper import GripperGoal, GripperRun, StallRule, judged
from drake_twin.control.pid import PidMemory
from drake_twin.controllers.action_controller import ActionController
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.goal_state import ACTION_MONITOR_RATE, GoalState
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import Update
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError
from drake_twin.saved import saved


@dataclass(frozen=True)
class GripperActionParameters(StallRule):
    """Parameters of ``position_controllers/GripperActionController``.

    Attributes:
        joint: The gripper's joint.
        action_monitor_rate: The rate at which the goal's state is checked (Hz).
        max_effort: The largest effort before the first goal, which has its own (N·m or N). Unused with a position
            interface.
    """

    joint: str = field(metadata={"not_empty": True})
    action_monitor_rate: float = field(default=20.0, metadata=ACTION_MONITOR_RATE)
    max_effort: float = field(default=0.0, metadata={"lower": 0.0})


@saved("GripperMemory")
@dataclass(frozen=True)
class GripperMemory:
    """The memory of a gripper controller: the goal or hold position, the goal's progress, and the PID."""

    goal: GripperGoal
    run: GripperRun
    pid: PidMemory


class GripperActionController(ActionController):
    """Move a gripper to the position of an action's goal; the base of the gripper controllers.

    Behaves as gripper_controllers and parallel_gripper_controller in ROS 2 Jazzy: the gripper is held at its position
    on activation and when a goal is canceled, a newer goal replaces an older one, a goal ends within the tolerance or
    with a stall, and its position stays commanded afterwards. A goal that is not finite is refused, a goal that is
    executed at a deactivation ends as canceled, and the feedback is the present state.

    .. pydrake_system::

        name: GripperActionController
        input_ports:
        - state
        - gripper_cmd
        output_ports:
        - command_interfaces

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``gripper_cmd``: the goal as `GripperGoal`, None before the first; action ``~/gripper_cmd``.
    - ``command_interfaces``: the command of each claim (rad or m, N·m or N).
    """

    Parameters: ClassVar[type] = GripperActionParameters
    action = "control_msgs/action/GripperCommand"
    interface = "position"

    @classmethod
    def claimed_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the interface of the joint."""
        return (Interface(parameters.joint, cls.interface),)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._goal_port = self.declare_action_input("gripper_cmd", self.action)

    def read(self, topic: str, message: Any, context: Context) -> GripperGoal:
        """Convert a goal to plain numbers and assign it the next id.

        Raises:
            CommandError: If there is not one position, or a position, effort or velocity is not finite.
        """
        position, effort, velocity = self._wanted(message)
        for what, value in (("position", position), ("effort", effort), ("velocity", velocity)):
            if not isfinite(value):
                raise CommandError(f"the {what} of the goal is {value}, which is not a finite number")
        id = self.newest_id(context, self._goal_port) + 1
        return GripperGoal(id, position, effort, velocity, context.get_time())

    def start(self, context: Context) -> GripperMemory:
        """Hold the gripper at its position, and keep the count of goals."""
        memory = self.sample(context).memory
        run = GripperRun() if memory is None else memory.run
        return GripperMemory(self._hold(context, run.id), run, PidMemory())

    def update(self, context: Context, time: float, memory: GripperMemory) -> Update:
        """Execute a new goal, judge its progress, and command it."""
        goal: GripperGoal | None = self.pending(context, self._goal_port)
        if goal is not None:
            run = GripperRun(goal.id, "executing", last_movement=goal.time)
            memory = replace(memory, goal=goal, run=run)
        (position,) = self.positions(context, [self.setup.parameters.joint]).tolist()
        (velocity,) = self.velocities(context, [self.setup.parameters.joint]).tolist()
        was_executing = memory.run.is_executing
        effort = self._effort(context, memory.goal)
        rule: StallRule = self.setup.parameters
        run = judged(memory.run, rule, time, memory.goal.position, position, velocity, effort)
        commands, pid = self._commands(memory.goal, memory.pid, position, velocity, time - self.sample(context).time)
        return Update(GripperMemory(memory.goal, run, pid), commands, was_executing and not run.is_executing)

    def used_id(self, memory: GripperMemory) -> int:
        """Return the id of the last executed goal."""
        return memory.run.id

    def last_goal(self, memory: GripperMemory) -> GoalState | None:
        """Return the state of the last executed goal; None before the first."""
        return GoalState(memory.run.id, memory.run.status) if memory.run.id else None

    def with_canceled_goal(self, context: Context, goal: GoalState) -> GripperMemory:
        """Return the memory with the goal canceled and the gripper held at its position."""
        return replace(self.with_interrupted_goal(context, goal), goal=self._hold(context, goal.id))

    def with_interrupted_goal(self, context: Context, goal: GoalState) -> GripperMemory:
        """Return the memory with the goal canceled."""
        memory: GripperMemory = self.sample(context).memory
        return replace(memory, run=GripperRun(goal.id, "canceled"))

    def feedback(self, context: Context) -> Any:
        """Return the present goal's feedback message."""
        run = self._run(context)
        return messages.GripperCommand_Feedback(
            position=run.position, effort=run.effort, stalled=run.stalled, reached_goal=run.reached_goal
        )

    def result(self, context: Context) -> Any:
        """Return the last goal's result message; all zero for one that was canceled."""
        run = self._run(context)
        return messages.GripperCommand_Result(
            position=run.position, effort=run.effort, stalled=run.stalled, reached_goal=run.reached_goal
        )

    def _run(self, context: Context) -> GripperRun:
        memory = self.sample(context).memory
        return GripperRun() if memory is None else memory.run

    def _hold(self, context: Context, last: int) -> GripperGoal:
        (position,) = self.positions(context, [self.setup.parameters.joint]).tolist()
        effort, velocity = self._default_limits()
        return GripperGoal(last, position, effort, velocity, context.get_time())

    def _default_limits(self) -> tuple[float, float]:
        """Return the largest effort and velocity before the first goal."""
        return self.setup.parameters.max_effort, 0.0

    def _wanted(self, message: Any) -> tuple[float, float, float]:
        """Return position, effort and velocity of a goal message."""
        return float(message.command.position), float(message.command.max_effort), 0.0

    def _effort(self, context: Context, goal: GripperGoal) -> float:
        """Return the effort that a result reports."""
        return goal.effort

    def _commands(
        self, goal: GripperGoal, pid: PidMemory, position: float, velocity: float, dt: float
    ) -> tuple[list[float], PidMemory]:
        """Return the command of each claim and the PID's memory; here the goal's position."""
        return [goal.position], pid
