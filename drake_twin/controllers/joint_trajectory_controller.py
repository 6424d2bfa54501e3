"""Joint trajectories from a topic and an action, as ros2_controllers' joint_trajectory_controller follows them."""

from dataclasses import replace
from math import isfinite
from typing import Any, ClassVar

from pydrake.common.value import AbstractValue
from pydrake.systems.framework import Context, InputPort

from drake_twin.control.pid import Pid, PidMemory
from drake_twin.control.stop_trajectory import hold_trajectory, stop_trajectory
from drake_twin.control.tolerances import StateTolerance, Tolerances, goal_tolerances, violation
from drake_twin.control.trajectory import (
    SAME_TIME,
    Trajectory,
    TrajectoryPoint,
    TrajectorySample,
    position_error,
    take_up,
)
from drake_twin.control.trajectory_check import TrajectoryRules, checked_trajectory
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.goal_state import GoalState
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.joint_trajectory_memory import JointTrajectoryMemory, TrajectoryCommand
from drake_twin.controllers.joint_trajectory_messages import (
    feedback_message,
    joint_tolerances_of,
    points_of,
    seconds_of,
    state_message,
)
from drake_twin.controllers.joint_trajectory_parameters import (
    JointConstraints,
    JointTrajectoryGains,
    JointTrajectoryParameters,
    check_interfaces,
    without_effect,
)
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.registry import controller
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError

TOPIC = "joint_trajectory"
ACTION = "follow_joint_trajectory"
SPEED_SCALING = "speed_scaling_input"

# Error codes of control_msgs/action/FollowJointTrajectory.
SUCCESSFUL = 0
INVALID_GOAL = -1
PATH_TOLERANCE_VIOLATED = -4
GOAL_TOLERANCE_VIOLATED = -5

# A joint that is further from the last command than when it was last commanded has been moved by somebody (rad or m).
_STILL_THERE = 1e-3


@controller("joint_trajectory_controller/JointTrajectoryController")
class JointTrajectoryController(PeriodicController):
    """Follows trajectories of several joints.

    Behaves as ``joint_trajectory_controller/JointTrajectoryController`` does in ROS 2 Jazzy, read from its sources;
    where it differs, a reason is given here:

    - What is written at ``t`` acts for an update period ``P``, and the implicit servo aims at the end of each physics
      step ``h``. So the position is that of ``t + (P + h) / 2``: with it the joint is on its trajectory in the mean.
      Upstream writes that of ``t + P``, which leads by half a period. With it goes a hint for the servo's damping: the
      trajectory's mean velocity while it acts. Velocities and efforts are those in the middle of that time.
    - A joint that wraps around is commanded the turns that it has made, so that it goes the short way; upstream leaves
      that to the hardware.
    - A goal ends at the update at which it is so, upstream's up to a period of ``action_monitor_rate`` later; after an
      abort the hold begins at that update, too, and not at the next.
    - A goal is aborted by a trajectory on the topic. Upstream reports the goal a success when that other one ends.
    - A goal that runs into ``cmd_timeout`` is aborted. Upstream reports success.
    - Numbers that are not finite, joints named twice and tolerances that have no meaning are refused.

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
      or m, m/s, N); then, with ``position`` and without ``velocity``, the velocity of each joint as a hint. From the
      first update on it holds the position at the activation.
    - ``controller_state``: ``control_msgs/msg/JointTrajectoryControllerState`` of the last update; None before it.

    Attributes:
        warnings: what of the parameters has no effect here.
    """

    Parameters: ClassVar[type] = JointTrajectoryParameters

    @classmethod
    def claimed_interfaces(
        cls, parameters: JointTrajectoryParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """The interfaces of each joint, but for ``acceleration``, which nothing in the twin takes.

        Raises:
            InputError: joints and interfaces do not go together.
        """
        check_interfaces(parameters)
        return tuple(
            Interface(joint, name)
            for joint in parameters.commanded
            for name in parameters.command_interfaces
            if name != "acceleration"
        )

    def __init__(self, setup: ControllerSetup):
        parameters: JointTrajectoryParameters = setup.parameters
        commands = parameters.command_interfaces
        is_joint = all(joint in setup.layout.velocities for joint in parameters.commanded)  # no other one's reference
        self._has_hint = is_joint and "position" in commands and "velocity" not in commands
        super().__init__(
            setup, [Interface(joint, "velocity") for joint in parameters.commanded] if self._has_hint else ()
        )
        self._joints = parameters.joints
        self._indices = parameters.commanded_indices
        self._names = tuple(name for name in commands if name != "acceleration")
        self._measures_velocity = "velocity" in parameters.state_interfaces
        known = setup.description.joints_by_name
        self._wraparound = tuple(joint in known and known[joint].type == "continuous" for joint in self._joints)
        self._rules = TrajectoryRules(
            self._joints,
            allow_partial_joints_goal=parameters.allow_partial_joints_goal,
            allow_integration=parameters.allow_integration_in_goal_trajectories,
            allow_nonzero_velocity_at_end=parameters.allow_nonzero_velocity_at_trajectory_end,
            has_effort="effort" in commands,
        )
        self._gains = [parameters.gains.get(self._joints[i], JointTrajectoryGains()) for i in self._indices]
        self._pids = [Pid(gains.pid_gains) for gains in self._gains] if parameters.has_pid else []
        constraints = parameters.constraints
        limits = [constraints.joints.get(joint, JointConstraints()) for joint in self._joints]
        self._tolerances = Tolerances(
            tuple(StateTolerance(position=limit.trajectory) for limit in limits),
            tuple(StateTolerance(limit.goal, constraints.stopped_velocity_tolerance) for limit in limits),
            constraints.goal_time,
        )
        self._decelerations = tuple(limit.max_deceleration_on_cancel for limit in limits)
        self.warnings = tuple(without_effect(parameters))
        self._topic_port = self.declare_topic_input(TOPIC, "trajectory_msgs/msg/JointTrajectory")
        self._action_port = self.declare_action_input(ACTION, "control_msgs/action/FollowJointTrajectory")
        self._scaling_port = (
            self.declare_topic_input(SPEED_SCALING, "control_msgs/msg/SpeedScalingFactor")
            if commands == ("position",)
            else None
        )
        self.declare_topic_output(
            "controller_state",
            "control_msgs/msg/JointTrajectoryControllerState",
            self._calc_controller_state,
            {self.sample_ticket()},
        )

    def get_joint_trajectory_input_port(self) -> InputPort:
        """The port ``joint_trajectory``."""
        return self._topic_port

    def get_follow_joint_trajectory_input_port(self) -> InputPort:
        """The port ``follow_joint_trajectory``."""
        return self._action_port

    def read(self, topic: str, message: Any, context: Context) -> Any:
        """The trajectory of a message or goal, in the controller's order of joints; or the speed's factor.

        Raises:
            CommandError: the message is refused.
        """
        if topic == SPEED_SCALING:
            if not (isfinite(message.factor) and message.factor >= 0.0):
                raise CommandError(f"the speed scaling factor {message.factor:g} is not a number from zero up")
            return message
        tolerances = self._tolerances
        trajectory = message
        if topic == ACTION:
            if not self.sample(context).active:
                raise CommandError("the controller is not active, so it takes no goal")
            trajectory = message.trajectory
            tolerances = goal_tolerances(
                tolerances,
                self._joints,
                joint_tolerances_of(message.path_tolerance),
                joint_tolerances_of(message.goal_tolerance),
                seconds_of(message.goal_time_tolerance),
            )
        points, times, start = points_of(trajectory)
        checked = checked_trajectory(
            self._rules, tuple(trajectory.joint_names), points, times, start, context.get_time()
        )
        return TrajectoryCommand(self._last_id(context) + 1, checked, tolerances)

    def goal_state(self, context: Context, id: int | None = None) -> GoalState | None:
        """The state of a goal.

        Args:
            context: the controller's own context.
            id: the goal's number; None for the last one. A goal that had not ended when a newer one came is aborted.

        Returns:
            None when there has been no goal.
        """
        memory: JointTrajectoryMemory | None = self.sample(context).memory
        newest = memory.goal if memory is not None else None
        waiting = self._waiting(context, self._action_port)
        if waiting is not None:
            newest = GoalState(waiting.id, "accepted")
        if newest is None or id is None or id == newest.id:
            return newest
        if memory is not None and memory.goal is not None and memory.goal.id == id and memory.goal.is_done:
            return memory.goal
        return _preempted(id)

    def feedback(self, context: Context) -> Any:
        """The present goal's ``control_msgs/action/FollowJointTrajectory_Feedback``; None before the first update."""
        sample = self.sample(context)
        return None if sample.memory is None else feedback_message(self._joints, sample.time, sample.memory)

    def cancel(self, context: Context) -> None:
        """Cancels the running goal: the joints are held where they are, or braked with ``decelerate_on_cancel``."""
        sample = self.sample(context)
        state = self.goal_state(context)
        if not sample.active or state is None or state.is_done:
            return
        memory = self._stopped(context.get_time(), sample.memory, self._measured(context, sample.memory))
        memory = replace(memory, last_id=self._last_id(context), goal=GoalState(state.id, "canceled"))
        self.set_sample(context, replace(sample, memory=memory))

    def deactivate(self, context: Context) -> None:
        """Writes nothing from now on; a goal that has not ended is aborted."""
        sample = self.sample(context)
        state = self.goal_state(context)
        if sample.active and state is not None and not state.is_done:
            goal = GoalState(state.id, "aborted", INVALID_GOAL, "Current goal cancelled during deactivate transition.")
            memory = replace(sample.memory, goal=goal, last_id=self._last_id(context))
            self.set_sample(context, replace(sample, memory=memory))
        super().deactivate(context)

    def start(self, context: Context) -> JointTrajectoryMemory:
        """Holds the joints where they are, or where the last command holds them."""
        time = context.get_time()
        last: JointTrajectoryMemory | None = self.sample(context).memory
        measured = self._measured(context, last)
        size = len(self._joints)
        zeros = (0.0,) * size
        at = replace(measured, positions=self._held_positions(last, measured))
        running = take_up(hold_trajectory(at.positions), time, at)
        return JointTrajectoryMemory(
            running=running,
            tolerances=self._tolerances,
            is_holding=True,
            delay=0.0,
            last_id=self._last_id(context),
            goal=None if last is None else last.goal,
            reference=running.sample(time).point,
            feedback=measured,
            error=TrajectoryPoint(zeros, zeros if self._measures_velocity else ()),
            output=TrajectoryPoint(),
            speed_scaling_factor=1.0,
            pids=(PidMemory(),) * len(self._pids),
        )

    def update(self, context: Context, time: float, memory: JointTrajectoryMemory) -> Update:
        """One update: takes up what is new, judges the errors, and commands the next period."""
        period = time - self.sample(context).time
        before = memory.goal
        measured = self._measured(context, memory)
        factor = self._speed_scaling_factor(context)
        taken_up = self._with_new_command(context, time, memory, measured)
        is_first = taken_up is not memory
        memory = replace(
            taken_up,
            delay=0.0 if is_first else memory.delay + (1.0 - factor) * period,
            speed_scaling_factor=factor,
            feedback=measured,
        )
        memory = self._with_reference(time, memory)
        end = self._end(time, memory, is_first)
        if end is not None:
            status, code, text = end
            if memory.goal is not None and not memory.goal.is_done:
                memory = replace(memory, goal=GoalState(memory.goal.id, status, code, text))
            if code == SUCCESSFUL:
                memory = replace(memory, is_holding=True)
            else:
                memory = self._with_reference(time, self._stopped(time, memory, measured))
        memory = self._with_output(time, period or self.setup.update_period, memory)
        notice = memory.goal is not None and memory.goal.is_done and memory.goal != before
        return Update(memory, self._commands(time, memory), notice)

    def _with_new_command(
        self, context: Context, time: float, memory: JointTrajectoryMemory, measured: TrajectoryPoint
    ) -> JointTrajectoryMemory:
        """The memory with the newest command taken up; the same when there is none."""
        goal = self._waiting(context, self._action_port)
        message = self._waiting(context, self._topic_port)
        command = max((each for each in (goal, message) if each is not None), key=lambda each: each.id, default=None)
        if command is None:
            return memory
        state = memory.goal
        if goal is not None:
            state = GoalState(goal.id, "executing")
        if command is message and state is not None and not state.is_done:
            text = "Current goal preempted by a trajectory on the topic."
            state = GoalState(state.id, "aborted", INVALID_GOAL, text)
        begin = measured
        if self.setup.parameters.interpolate_from_desired_state or self.setup.parameters.open_loop_control:
            begin = _turned(memory.running.sample(time - memory.delay).point, memory.running.turns)
        held = memory.output.positions or measured.positions
        running = take_up(
            command.trajectory.with_missing_positions(held),
            time,
            begin,
            self._wraparound,
            self.setup.parameters.interpolation_method,
        )
        return replace(
            memory,
            running=running,
            tolerances=command.tolerances,
            is_holding=False,
            last_id=command.id,
            goal=state,
        )

    def _end(self, time: float, memory: JointTrajectoryMemory, is_first: bool) -> tuple[str, int, str] | None:
        """How the trajectory ends at this update: status, error code and text; None when it goes on."""
        if memory.is_holding:
            return None
        sample = self._sampled(time, memory)
        if is_first or not sample.is_over:
            text = violation(self._joints, memory.error, memory.tolerances.path)
            if text is not None:
                return "aborted", PATH_TOLERANCE_VIOLATED, f"Aborted due to path tolerance violation: {text}."
        if not sample.is_over:
            return None
        has_goal = memory.goal is not None and not memory.goal.is_done
        text = violation(self._joints, memory.error, memory.tolerances.goal)
        late = sample.time_since_point - SAME_TIME  # that a period's sum exceeds by rounding is not late
        if text is None:
            if has_goal:
                return "succeeded", SUCCESSFUL, "Goal successfully reached!"
        elif 0.0 < memory.tolerances.goal_time < late:
            text = f"Aborted due to goal_time_tolerance exceeding by {sample.time_since_point:f} seconds: {text}."
            return "aborted", GOAL_TOLERANCE_VIOLATED, text
        if 0.0 < self.setup.parameters.effective_cmd_timeout < late:
            return "aborted", GOAL_TOLERANCE_VIOLATED, f"Aborted due to command timeout: {text or 'no new command'}."
        return None

    def _stopped(self, time: float, memory: JointTrajectoryMemory, measured: TrajectoryPoint) -> JointTrajectoryMemory:
        """The memory with a trajectory that brings the joints to rest."""
        trajectory: Trajectory = hold_trajectory(measured.positions)
        if self.setup.parameters.can_decelerate:
            trajectory = stop_trajectory(measured.positions, measured.velocities, self._decelerations)
        return replace(memory, running=take_up(trajectory, time, measured), is_holding=True, delay=0.0)

    def _with_reference(self, time: float, memory: JointTrajectoryMemory) -> JointTrajectoryMemory:
        """The memory with the trajectory's state now, and the error."""
        reference = self._sampled(time, memory).point
        measured = memory.feedback
        velocities = (0.0,) * len(measured.velocities)
        if velocities and ("velocity" in self._names or "effort" in self._names):
            velocities = tuple(
                desired - actual for desired, actual in zip(reference.velocities, measured.velocities, strict=True)
            )
        error = TrajectoryPoint(position_error(reference.positions, measured.positions, self._wraparound), velocities)
        return replace(memory, reference=reference, error=error)

    def _with_output(self, time: float, period: float, memory: JointTrajectoryMemory) -> JointTrajectoryMemory:
        """The memory with what is commanded of each joint until the next update."""
        hold, step = self.setup.update_period, self.setup.physics_step
        middle = self._sampled(time, memory, 0.5 * hold).point
        positions: tuple[float, ...] = ()
        if "position" in self._names:
            point = self._sampled(time, memory, 0.5 * (hold + step)).point if step else middle
            positions = _turned(point, memory.running.turns).positions
        velocities, effort, pids = middle.velocities, middle.effort, memory.pids
        if self._pids:
            commands, pids = self._computed(period, middle, memory)
            velocities = effort = commands
        output = TrajectoryPoint(
            positions,
            velocities if "velocity" in self._names else (),
            (),
            effort if "effort" in self._names else (),
        )
        return replace(memory, output=output, pids=pids)

    def _computed(
        self, period: float, middle: TrajectoryPoint, memory: JointTrajectoryMemory
    ) -> tuple[tuple[float, ...], tuple[PidMemory, ...]]:
        """The PIDs' commands with their feed-forward; zero for joints that are not commanded."""
        commands, pids = [0.0] * len(self._joints), []
        for i, pid, gains, past in zip(self._indices, self._pids, self._gains, memory.pids, strict=True):
            command, present = pid.compute(memory.error.positions[i], memory.error.velocities[i], period, past)
            command += gains.ff_velocity_scale * middle.velocities[i]
            commands[i] = command + middle.effort[i] if "effort" in self._names else command
            pids.append(present)
        return tuple(commands), tuple(pids)

    def _commands(self, time: float, memory: JointTrajectoryMemory) -> list[float]:
        output = memory.output
        values = {"position": output.positions, "velocity": output.velocities, "effort": output.effort}
        commands = [values[name][i] for i in self._indices for name in self._names]
        if self._has_hint:
            hold = self.setup.update_period
            begin, end = (self._sampled(time, memory, ahead).point.positions for ahead in (0.0, hold))
            no_hint = self.setup.parameters.interpolation_method == "none"
            commands += [0.0 if no_hint else (end[i] - begin[i]) / hold for i in self._indices]
        return commands

    def _sampled(self, time: float, memory: JointTrajectoryMemory, ahead: float = 0.0) -> TrajectorySample:
        """The trajectory now, or a time (s) ahead at its present speed."""
        return memory.running.sample(time - memory.delay + memory.speed_scaling_factor * ahead)

    def _measured(self, context: Context, memory: JointTrajectoryMemory | None) -> TrajectoryPoint:
        """What the state interfaces tell; for efforts, which have none, the last command."""
        velocities = self.velocities(context, self._joints).tolist() if self._measures_velocity else ()
        positions = self.positions(context, self._joints).tolist()
        effort = memory.output.effort if memory is not None else ()
        return TrajectoryPoint(tuple(positions), tuple(velocities), effort=effort)

    def _held_positions(self, last: JointTrajectoryMemory | None, measured: TrajectoryPoint) -> tuple[float, ...]:
        """What was commanded last, when nobody has moved the joints since; else where they are."""
        parameters: JointTrajectoryParameters = self.setup.parameters
        if (
            last is None
            or not parameters.set_last_command_interface_value_as_state_on_activation
            or not last.output.positions
            or len(self._indices) < len(self._joints)
        ):
            return measured.positions
        is_there = all(
            abs(now - commanded) <= max(abs(then - commanded), _STILL_THERE)
            for now, then, commanded in zip(
                measured.positions, last.feedback.positions, last.output.positions, strict=True
            )
        )
        return last.output.positions if is_there else measured.positions

    def _speed_scaling_factor(self, context: Context) -> float:
        if self._scaling_port is None:
            return 1.0
        message = self._scaling_port.Eval(context) if self._scaling_port.HasValue(context) else None
        initial: float = self.setup.parameters.speed_scaling.initial_scaling_factor
        return initial if message is None else float(message.factor)

    def _waiting(self, context: Context, port: InputPort) -> Any:
        """The command on a port, unless it has been taken up already."""
        command = port.Eval(context) if port.HasValue(context) else None
        memory: JointTrajectoryMemory | None = self.sample(context).memory
        return command if command is not None and (memory is None or command.id > memory.last_id) else None

    def _last_id(self, context: Context) -> int:
        """The highest number of all commands so far, those included that wait on a port."""
        memory: JointTrajectoryMemory | None = self.sample(context).memory
        waiting = (self._waiting(context, port) for port in (self._topic_port, self._action_port))
        return max(0 if memory is None else memory.last_id, *(0 if each is None else each.id for each in waiting))

    def _calc_controller_state(self, context: Context, output: AbstractValue) -> None:
        sample = self.sample(context)
        has_commanded = sample.active and sample.memory.output != TrajectoryPoint()
        output.set_value(state_message(self._joints, sample.time, sample.memory) if has_commanded else None)


def _preempted(id: int) -> GoalState:
    return GoalState(id, "aborted", INVALID_GOAL, "Current goal preempted by new incoming action.")


def _turned(point: TrajectoryPoint, turns: tuple[float, ...]) -> TrajectoryPoint:
    """A trajectory's state with the joints' own whole turns added."""
    return replace(point, positions=tuple(q + turn for q, turn in zip(point.positions, turns, strict=True)))
