"""The calculation of a joint trajectory controller's update from time, memory and measurements."""

from dataclasses import replace

from drake_twin.control.pid import Pid, PidMemory
from drake_twin.control.stop_trajectory import hold_trajectory, stop_trajectory
from drake_twin.control.tolerances import StateTolerance, Tolerances, violation
from drake_twin.control.trajectory import (
    SAME_TIME,
    Trajectory,
    TrajectoryPoint,
    TrajectorySample,
    position_error,
    take_up,
)
from drake_twin.controllers.goal_state import GoalState
from drake_twin.controllers.joint_trajectory_memory import JointTrajectoryMemory, TrajectoryCommand
from drake_twin.controllers.joint_trajectory_parameters import (
    JointConstraints,
    JointTrajectoryGains,
    JointTrajectoryParameters,
)

# Error codes of control_msgs/action/FollowJointTrajectory.
SUCCESSFUL = 0
INVALID_GOAL = -1
PATH_TOLERANCE_VIOLATED = -4
GOAL_TOLERANCE_VIOLATED = -5

# A joint that is farther from the last command than when that was written has been moved since (rad or m).
_STILL_THERE = 1e-3


class JointTrajectoryFollower:
    """Follow a trajectory: judge errors, end goals and calculate commands. A follower has no state of its own.

    Args:
        parameters: The controller's parameters.
        wraparound: Whether each joint is continuous.
        has_feedforward: Whether the commands include the velocity of each commanded joint, for the servo's damping.
        update_period: The time between two updates (s).
        physics_step: The time between two physics steps (s); 0 for one much shorter than ``update_period``.

    Attributes:
        tolerances: The tolerances of a trajectory without its own.
    """

    def __init__(
        self,
        parameters: JointTrajectoryParameters,
        wraparound: tuple[bool, ...],
        *,
        has_feedforward: bool,
        update_period: float,
        physics_step: float,
    ):
        self._parameters = parameters
        self._wraparound = wraparound
        self._has_feedforward = has_feedforward
        self._period, self._physics_step = update_period, physics_step
        self._joints, self._indices = parameters.joints, parameters.commanded_indices
        self._names = parameters.written_interfaces
        self._gains = [parameters.gains.get(self._joints[i], JointTrajectoryGains()) for i in self._indices]
        self._pids = [Pid(gains.pid_gains) for gains in self._gains] if parameters.has_pid else []
        constraints = parameters.constraints
        limits = [constraints.joints.get(joint, JointConstraints()) for joint in self._joints]
        self._decelerations = tuple(limit.max_deceleration_on_cancel for limit in limits)
        self.tolerances = Tolerances(
            tuple(StateTolerance(position=limit.trajectory) for limit in limits),
            tuple(StateTolerance(limit.goal, constraints.stopped_velocity_tolerance) for limit in limits),
            constraints.goal_time,
        )

    def start(
        self, time: float, last: JointTrajectoryMemory | None, measured: TrajectoryPoint, last_id: int
    ) -> JointTrajectoryMemory:
        """Return the memory at an activation: the joints are held at their positions, or at the last commanded ones.

        Args:
            time: The present time (s).
            last: The memory at the last deactivation; None before the first activation.
            measured: The measured state.
            last_id: The highest id of the commands so far.
        """
        zeros = (0.0,) * len(self._joints)
        at = replace(measured, positions=self._held_positions(last, measured))
        running = take_up(hold_trajectory(at.positions), time, at)
        return JointTrajectoryMemory(
            running=running,
            tolerances=self.tolerances,
            is_holding=True,
            delay=0.0,
            last_id=last_id,
            goal=None if last is None else last.goal,
            reference=running.sample(time).point,
            feedback=measured,
            error=TrajectoryPoint(zeros, zeros if measured.velocities else ()),
            output=TrajectoryPoint(),
            speed_scaling_factor=1.0,
            pids=(PidMemory(),) * len(self._pids),
        )

    def update(
        self,
        time: float,
        period: float,
        memory: JointTrajectoryMemory,
        measured: TrajectoryPoint,
        speed_scaling_factor: float,
        goal: TrajectoryCommand | None,
        message: TrajectoryCommand | None,
    ) -> JointTrajectoryMemory:
        """Return the memory after an update: accept a new command, judge the errors, calculate the output.

        Args:
            time: The present time (s).
            period: The time since the last update or the activation (s).
            memory: The memory after the last update.
            measured: The measured state.
            speed_scaling_factor: The factor of the trajectory's speed.
            goal: The pending goal.
            message: The pending message of the topic.
        """
        accepted = self._with_new_command(time, memory, measured, goal, message)
        is_first = accepted is not memory
        memory = replace(
            accepted,
            delay=0.0 if is_first else memory.delay + (1.0 - speed_scaling_factor) * period,
            speed_scaling_factor=speed_scaling_factor,
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
                memory = self._with_reference(time, self.stopped(time, memory, measured))
        return self._with_output(time, period or self._period, memory)

    def stopped(self, time: float, memory: JointTrajectoryMemory, measured: TrajectoryPoint) -> JointTrajectoryMemory:
        """Return the memory with a trajectory that brings the joints to rest."""
        trajectory: Trajectory = hold_trajectory(measured.positions)
        if self._parameters.can_decelerate:
            trajectory = stop_trajectory(measured.positions, measured.velocities, self._decelerations)
        return replace(memory, running=take_up(trajectory, time, measured), is_holding=True, delay=0.0)

    def commands(self, time: float, memory: JointTrajectoryMemory) -> list[float]:
        """Return the interfaces of each commanded joint, then the feedforward (rad, rad/s, N·m, or m, m/s, N)."""
        output = memory.output
        values = {"position": output.positions, "velocity": output.velocities, "effort": output.effort}
        commands = [values[name][i] for i in self._indices for name in self._names]
        if self._has_feedforward:
            begin, end = (self._sampled(time, memory, ahead).point.positions for ahead in (0.0, self._period))
            jumps = self._parameters.interpolation_method == "none"
            commands += [0.0 if jumps else (end[i] - begin[i]) / self._period for i in self._indices]
        return commands

    def _with_new_command(
        self,
        time: float,
        memory: JointTrajectoryMemory,
        measured: TrajectoryPoint,
        goal: TrajectoryCommand | None,
        message: TrajectoryCommand | None,
    ) -> JointTrajectoryMemory:
        """Return the memory with the newest command; the same memory without one."""
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
        if self._parameters.interpolate_from_desired_state or self._parameters.open_loop_control:
            begin = _turned(memory.running.sample(time - memory.delay).point, memory.running.turns)
        held = memory.output.positions or measured.positions
        running = take_up(
            command.trajectory.with_missing_positions(held),
            time,
            begin,
            self._wraparound,
            self._parameters.interpolation_method,
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
        """Return status, error code and text if the trajectory ends at this update; None if it does not."""
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
        late = sample.time_since_point - SAME_TIME  # a sum of periods that is too large by rounding is not late
        if text is None:
            if has_goal:
                return "succeeded", SUCCESSFUL, "Goal successfully reached!"
        elif 0.0 < memory.tolerances.goal_time < late:
            text = f"Aborted due to goal_time_tolerance exceeding by {sample.time_since_point:f} seconds: {text}."
            return "aborted", GOAL_TOLERANCE_VIOLATED, text
        if 0.0 < self._parameters.effective_cmd_timeout < late:
            return "aborted", GOAL_TOLERANCE_VIOLATED, f"Aborted due to command timeout: {text or 'no new command'}."
        return None

    def _with_reference(self, time: float, memory: JointTrajectoryMemory) -> JointTrajectoryMemory:
        """Return the memory with the trajectory's present state and the error."""
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
        """Return the memory with the commands of all joints until the next update."""
        hold, step = self._period, self._physics_step
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
        """Return the PIDs' commands with their feedforward, zero for joints that are not commanded, and memories."""
        commands, pids = [0.0] * len(self._joints), []
        for i, pid, gains, past in zip(self._indices, self._pids, self._gains, memory.pids, strict=True):
            command, present = pid.compute(memory.error.positions[i], memory.error.velocities[i], period, past)
            command += gains.ff_velocity_scale * middle.velocities[i]
            commands[i] = command + middle.effort[i] if "effort" in self._names else command
            pids.append(present)
        return tuple(commands), tuple(pids)

    def _sampled(self, time: float, memory: JointTrajectoryMemory, ahead: float = 0.0) -> TrajectorySample:
        """Return the trajectory now, or a time ahead (s) at its present speed."""
        return memory.running.sample(time - memory.delay + memory.speed_scaling_factor * ahead)

    def _held_positions(self, last: JointTrajectoryMemory | None, measured: TrajectoryPoint) -> tuple[float, ...]:
        """Return the positions commanded last if the joints have not been moved since; else the measured ones."""
        if (
            last is None
            or not self._parameters.set_last_command_interface_value_as_state_on_activation
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


def _turned(point: TrajectoryPoint, turns: tuple[float, ...]) -> TrajectoryPoint:
    """Return a trajectory's state with the joints' own whole turns added."""
    return replace(point, positions=tuple(q + turn for q, turn in zip(point.positions, turns, strict=True)))
