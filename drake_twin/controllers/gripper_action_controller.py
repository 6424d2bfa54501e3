"""Grippers with one joint, as ros2_controllers' gripper action controllers command them."""

from dataclasses import dataclass, field, replace
from math import isfinite
from typing import Any, ClassVar

from pydrake.systems.framework import Context, InputPort

from drake_twin import messages
from drake_twin.control.gripper import GripperGoal, GripperRun, StallRule, judged
from drake_twin.control.pid import PidMemory
from drake_twin.controllers.action_controller import ActionController
from drake_twin.controllers.controller import ControllerSetup
from drake_twin.controllers.goal_state import ACTION_MONITOR_RATE, GoalState
from drake_twin.controllers.periodic_controller import Update
from drake_twin.errors import CommandError
from drake_twin.saved import saved


@dataclass(frozen=True)
class GripperActionParameters:
    """Parameters of ``position_controllers/GripperActionController``.

    Attributes:
        joint: the gripper's joint.
        action_monitor_rate: how often the action's state is looked at (Hz).
        goal_tolerance: how near the goal is near enough (rad or m).
        max_effort: the largest effort until a goal brings its own (N·m or N). A position interface makes no use of it.
        allow_stalling: whether a goal succeeds when the gripper stalls on the way.
        stall_velocity_threshold: what is no faster stands still (rad/s or m/s).
        stall_timeout: how long it stands still before it has stalled (s).
    """

    joint: str
    action_monitor_rate: float = field(default=20.0, metadata=ACTION_MONITOR_RATE)
    goal_tolerance: float = field(default=0.01, metadata={"lower": 0.0})
    max_effort: float = field(default=0.0, metadata={"lower": 0.0})
    allow_stalling: bool = False
    stall_velocity_threshold: float = 0.001
    stall_timeout: float = 1.0


@saved("GripperMemory")
@dataclass(frozen=True)
class GripperMemory:
    """What a gripper controller keeps: what it was told last, how that is getting on, and its PID."""

    goal: GripperGoal
    run: GripperRun
    pid: PidMemory


class GripperActionController(ActionController):
    """Moves a gripper to the position of an action's goal; the base of the three controllers of this file.

    Behaves as gripper_controllers and parallel_gripper_controller in ROS 2 Jazzy: on activation and when a goal is
    cancelled it holds where it is, a newer goal takes the place of an older one, a goal ends within the tolerance or
    with a stall, and its position stays commanded afterwards. Here a goal that is not a finite number is refused, one
    that runs when the controller is deactivated ends as cancelled, and the feedback, which upstream never sends, is
    the present state.

    .. pydrake_system::

        name: GripperActionController
        input_ports:
        - state
        - gripper_cmd
        output_ports:
        - command_interfaces

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``gripper_cmd``: the goal as `GripperGoal`, ``None`` before the first; action ``~/gripper_cmd``.
    - ``command_interfaces``: what the claims say (rad or m, N·m or N).
    """

    Parameters: ClassVar[type] = GripperActionParameters
    action = "control_msgs/action/GripperCommand"

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters = setup.parameters
        self._rule = StallRule(
            goal_tolerance=parameters.goal_tolerance,
            stall_velocity_threshold=parameters.stall_velocity_threshold,
            stall_timeout=parameters.stall_timeout,
            allow_stalling=parameters.allow_stalling,
        )
        self._goal_port = self.declare_action_input("gripper_cmd", self.action)

    def get_gripper_cmd_input_port(self) -> InputPort:
        """The port ``gripper_cmd``."""
        return self._goal_port

    def read(self, topic: str, message: Any, context: Context) -> GripperGoal:
        """The goal as plain numbers, with the next number.

        Raises:
            CommandError: a position, effort or velocity that is not finite, or not one position.
        """
        position, effort, velocity = self._wanted(message)
        for what, value in (("position", position), ("effort", effort), ("velocity", velocity)):
            if not isfinite(value):
                raise CommandError(f"the {what} of the goal is {value}, which is not a finite number")
        id = self.newest_id(context, self._goal_port) + 1
        return GripperGoal(id, position, effort, velocity, context.get_time())

    def start(self, context: Context) -> GripperMemory:
        """Holds where it is; goals are counted on."""
        memory = self.sample(context).memory
        run = GripperRun() if memory is None else memory.run
        return GripperMemory(self._hold(context, run.id), run, PidMemory())

    def update(self, context: Context, time: float, memory: GripperMemory) -> Update:
        """Takes a new goal, judges how the present one is getting on, and commands it."""
        goal: GripperGoal | None = self.pending(context, self._goal_port)
        if goal is not None:
            run = GripperRun(goal.id, "executing", last_movement=goal.time)
            memory = replace(memory, goal=goal, run=run)
        (position,) = self.positions(context, [self.setup.parameters.joint]).tolist()
        (velocity,) = self.velocities(context, [self.setup.parameters.joint]).tolist()
        was_executing = memory.run.is_executing
        effort = self._effort(context, memory.goal)
        run = judged(memory.run, self._rule, time, memory.goal.position, position, velocity, effort)
        commands, pid = self._commands(memory.goal, memory.pid, position, velocity, time - self.sample(context).time)
        return Update(GripperMemory(memory.goal, run, pid), commands, was_executing and not run.is_executing)

    def used_id(self, memory: GripperMemory) -> int:
        """Return the id of the last executed goal."""
        return memory.run.id

    def last_goal(self, memory: GripperMemory) -> GoalState | None:
        """Return the state of the last executed goal; None before the first."""
        return GoalState(memory.run.id, memory.run.status) if memory.run.id else None

    def with_canceled_goal(self, context: Context, goal: GoalState) -> GripperMemory:
        """Return the memory with the goal canceled and the gripper held where it is."""
        return replace(self.with_interrupted_goal(context, goal), goal=self._hold(context, goal.id))

    def with_interrupted_goal(self, context: Context, goal: GoalState) -> GripperMemory:
        """Return the memory with the goal canceled."""
        memory: GripperMemory = self.sample(context).memory
        return replace(memory, run=GripperRun(goal.id, "canceled"))

    def feedback(self, context: Context) -> Any:
        """The present goal's feedback message."""
        run = self._run(context)
        return messages.GripperCommand_Feedback(
            position=run.position, effort=run.effort, stalled=run.stalled, reached_goal=run.reached_goal
        )

    def result(self, context: Context) -> Any:
        """The last goal's result message; all zero for one that was cancelled."""
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
        """The largest effort and velocity while no goal gives its own."""
        return self.setup.parameters.max_effort, 0.0

    def _wanted(self, message: Any) -> tuple[float, float, float]:
        """Position, effort and velocity of a goal message."""
        return float(message.command.position), float(message.command.max_effort), 0.0

    def _effort(self, context: Context, goal: GripperGoal) -> float:
        """The effort that a result reports."""
        return goal.effort

    def _commands(
        self, goal: GripperGoal, pid: PidMemory, position: float, velocity: float, dt: float
    ) -> tuple[list[float], PidMemory]:
        """Return the command of each claim and the PID's memory; here the goal's position."""
        return [goal.position], pid
