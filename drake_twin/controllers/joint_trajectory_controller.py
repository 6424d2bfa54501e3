"""Joint trajectories from a topic and an action, as ros2_controllers' joint_trajectory_controller follows them."""

import logging
from dataclasses import replace
from math import isfinite
from typing import Any, ClassVar

from pydrake.systems.framework import Context, InputPort

from drake_twin.control.tolerances import Tolerances, goal_tolerances
from drake_twin.control.trajectory import TrajectoryPoint
from drake_twin.control.trajectory_check import TrajectoryRules, checked_trajectory
from drake_twin.controllers.action_controller import ActionController
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.goal_state import GoalState
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.joint_trajectory_follower import INVALID_GOAL, JointTrajectoryFollower
from drake_twin.controllers.joint_trajectory_memory import JointTrajectoryMemory, TrajectoryCommand
from drake_twin.controllers.joint_trajectory_messages import (
    feedback_message,
    joint_tolerances_of,
    points_of,
    seconds_of,
    state_message,
)
from drake_twin.controllers.joint_trajectory_parameters import (
    JointTrajectoryParameters,
    check_interfaces,
    without_effect,
)
from drake_twin.controllers.periodic_controller import Update
from drake_twin.controllers.registry import controller
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError

_log = logging.getLogger(__name__)

TOPIC = "joint_trajectory"
ACTION = "follow_joint_trajectory"
SPEED_SCALING = "speed_scaling_input"


@controller("joint_trajectory_controller/JointTrajectoryController")
class JointTrajectoryController(ActionController):
    """Follow trajectories of several joints.

    Behaves as ``joint_trajectory_controller/JointTrajectoryController`` does in ROS 2 Jazzy (from its sources);
    ``docs/controllers.md`` has the differences. A command of time ``t`` acts for an update period ``P``, and the
    implicit servo aims at the end of each physics step ``h``. The commanded position is that of ``t + (P + h) / 2``,
    with which the joint is on its trajectory on average. A feedforward for the servo's damping goes with it: the
    trajectory's mean velocity in the period. Velocities and efforts are those of ``t + P / 2``.

    .. pydrake_system::

        name: JointTrajectoryController
        input_ports:
        - state
        - joint_trajectory
        - follow_joint_trajectory
        - speed_scaling_input
        output_ports:
        - command_interfaces
        - controller_state

    - ``state``: vector ``[q; v]`` of the robot (rad, rad/s, or m, m/s).
    - ``joint_trajectory``: a `TrajectoryCommand` from ``trajectory_msgs/msg/JointTrajectory``, or None; topic
      ``~/joint_trajectory``.
    - ``follow_joint_trajectory``: the same from a goal of ``control_msgs/action/FollowJointTrajectory``; action
      ``~/follow_joint_trajectory``.
    - ``speed_scaling_input``: ``control_msgs/msg/SpeedScalingFactor``, how fast trajectories run, or None; topic
      ``~/speed_scaling_input``. Only with the interface ``position`` alone.
    - ``command_interfaces``: for each commanded joint its interfaces, in the order of the parameters (rad, rad/s, N·m,
      or m, m/s, N); then, with ``position`` and without ``velocity``, the velocity of each joint as feedforward. From
      the first update it holds the position at the activation.
    - ``controller_state``: ``control_msgs/msg/JointTrajectoryControllerState`` of the last update; None before it.

    Attributes:
        warnings: The parameters without effect.
    """

    Parameters: ClassVar[type] = JointTrajectoryParameters

    @classmethod
    def claimed_interfaces(
        cls, parameters: JointTrajectoryParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the interfaces of each joint, without ``acceleration``, which the twin does not have.

        Raises:
            InputError: If joints and interfaces do not match.
        """
        check_interfaces(parameters)
        return tuple(Interface(joint, name) for joint in parameters.commanded for name in parameters.written_interfaces)

    def __init__(self, setup: ControllerSetup):
        parameters: JointTrajectoryParameters = setup.parameters
        commands = parameters.command_interfaces
        is_joint = all(joint in setup.layout.velocities for joint in parameters.commanded)  # otherwise a reference
        has_feedforward = is_joint and "position" in commands and "velocity" not in commands
        super().__init__(
            setup, [Interface(joint, "velocity") for joint in parameters.commanded] if has_feedforward else ()
        )
        self._joints = parameters.joints
        self._measures_velocity = "velocity" in parameters.state_interfaces
        known = setup.description.joints_by_name
        self._follower = JointTrajectoryFollower(
            parameters,
            tuple(joint in known and known[joint].type == "continuous" for joint in self._joints),
            has_feedforward=has_feedforward,
            update_period=setup.update_period,
            physics_step=setup.physics_step,
        )
        self._rules = TrajectoryRules(
            self._joints,
            allow_partial_joints_goal=parameters.allow_partial_joints_goal,
            allow_integration=parameters.allow_integration_in_goal_trajectories,
            allow_nonzero_velocity_at_end=parameters.allow_nonzero_velocity_at_trajectory_end,
            has_effort="effort" in commands,
        )
        self.warnings = tuple(without_effect(parameters))
        self._topic_port = self.declare_topic_input(TOPIC, "trajectory_msgs/msg/JointTrajectory")
        self._goal_port = self.declare_action_input(ACTION, "control_msgs/action/FollowJointTrajectory")
        self._scaling_port = (
            self.declare_topic_input(SPEED_SCALING, "control_msgs/msg/SpeedScalingFactor")
            if commands == ("position",)
            else None
        )
        self.declare_message_output(
            "controller_state", "control_msgs/msg/JointTrajectoryControllerState", self._controller_state
        )

    def get_joint_trajectory_input_port(self) -> InputPort:
        """Return the port ``joint_trajectory``."""
        return self._topic_port

    def read(self, topic: str, message: Any, context: Context) -> Any:
        """Convert a message or goal to a trajectory in the controller's order of joints; check a speed scaling factor.

        Raises:
            CommandError: If the message is refused.
        """
        if topic == SPEED_SCALING:
            if not (isfinite(message.factor) and message.factor >= 0.0):
                raise CommandError(f"the speed scaling factor {message.factor:g} is not zero or a positive number")
            return message
        tolerances = self._follower.tolerances
        trajectory = message
        if topic == ACTION:
            if not self.sample(context).active:
                raise CommandError("the controller is not active and accepts no goal")
            trajectory = message.trajectory
            tolerances = self._tolerances_of(message)
        points, times, start = points_of(trajectory)
        checked = checked_trajectory(
            self._rules, tuple(trajectory.joint_names), points, times, start, context.get_time()
        )
        return TrajectoryCommand(self._newest_id(context) + 1, checked, tolerances)

    def _tolerances_of(self, goal: Any) -> Tolerances:
        """Return a goal's tolerances; the controller's own, with an error in the log, if one of them is invalid."""
        try:
            return goal_tolerances(
                self._follower.tolerances,
                self._joints,
                joint_tolerances_of(goal.path_tolerance),
                joint_tolerances_of(goal.goal_tolerance),
                seconds_of(goal.goal_time_tolerance),
            )
        except CommandError as error:
            node = f"{self.setup.namespace}/{self.setup.name}"
            _log.error("%s: the default tolerances are used: %s", self.setup.name, error, extra={"node": node})
            return self._follower.tolerances

    def used_id(self, memory: JointTrajectoryMemory) -> int:
        """Return the id of the last executed command, of the topic or of the action."""
        return memory.last_id

    def last_goal(self, memory: JointTrajectoryMemory) -> GoalState | None:
        """Return the state of the last executed goal; None before the first."""
        return memory.goal

    def with_canceled_goal(self, context: Context, goal: GoalState) -> JointTrajectoryMemory:
        """Return the memory with the goal canceled; the joints brake with ``decelerate_on_cancel``, else they hold."""
        memory: JointTrajectoryMemory = self.sample(context).memory
        memory = self._follower.stopped(context.get_time(), memory, self._measured(context, memory))
        return replace(memory, last_id=self._newest_id(context), goal=GoalState(goal.id, "canceled"))

    def with_interrupted_goal(self, context: Context, goal: GoalState) -> JointTrajectoryMemory:
        """Return the memory with the goal aborted."""
        memory: JointTrajectoryMemory = self.sample(context).memory
        ended = GoalState(goal.id, "aborted", INVALID_GOAL, "Current goal cancelled during deactivate transition.")
        return replace(memory, goal=ended, last_id=self._newest_id(context))

    def feedback(self, context: Context) -> Any:
        """Return ``control_msgs/action/FollowJointTrajectory_Feedback``; None before the first update."""
        sample = self.sample(context)
        return None if sample.memory is None else feedback_message(self._joints, sample.time, sample.memory)

    def goal_positions(self, context: Context) -> dict[str, float]:
        """Return where the trajectory ends (rad or m)."""
        memory: JointTrajectoryMemory | None = self.sample(context).memory
        if memory is None:
            return {}
        last, turns = memory.running.lasts[-1].positions, memory.running.turns
        return {name: q + turn for name, q, turn in zip(self._joints, last, turns, strict=True)}

    def start(self, context: Context) -> JointTrajectoryMemory:
        """Hold the joints where they are, or where the last command held them."""
        last: JointTrajectoryMemory | None = self.sample(context).memory
        measured = self._measured(context, last)
        return self._follower.start(context.get_time(), last, measured, self._newest_id(context))

    def update(self, context: Context, time: float, memory: JointTrajectoryMemory) -> Update:
        """Follow the trajectory until the next update."""
        before = memory.goal
        memory = self._follower.update(
            time,
            time - self.sample(context).time,
            memory,
            self._measured(context, memory),
            self._speed_scaling_factor(context),
            goal=self.pending(context, self._goal_port),
            message=self.pending(context, self._topic_port),
        )
        notice = memory.goal is not None and memory.goal.is_done and memory.goal != before
        return Update(memory, self._follower.commands(time, memory), notice)

    def _measured(self, context: Context, memory: JointTrajectoryMemory | None) -> TrajectoryPoint:
        """Return the values of the state interfaces; for efforts, which have none, the last command."""
        velocities = self.velocities(context, self._joints).tolist() if self._measures_velocity else ()
        positions = self.positions(context, self._joints).tolist()
        effort = memory.output.effort if memory is not None else ()
        return TrajectoryPoint(tuple(positions), tuple(velocities), effort=effort)

    def _speed_scaling_factor(self, context: Context) -> float:
        if self._scaling_port is None:
            return 1.0
        message = self.received(self._scaling_port, context)
        initial: float = self.setup.parameters.speed_scaling.initial_scaling_factor
        return initial if message is None else float(message.factor)

    def _newest_id(self, context: Context) -> int:
        return self.newest_id(context, self._topic_port, self._goal_port)

    def _controller_state(self, context: Context) -> Any:
        sample = self.sample(context)
        has_commanded = sample.memory is not None and sample.memory.output != TrajectoryPoint()
        return state_message(self._joints, sample.time, sample.memory) if has_commanded else None
