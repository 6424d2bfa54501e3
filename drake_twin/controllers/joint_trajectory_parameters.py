"""Parameters of joint_trajectory_controller (Jazzy) and their valid combinations."""

from collections.abc import Mapping
from dataclasses import field, replace
from math import inf, isfinite
from typing import ClassVar

from drake_twin.control.pid import PidGains
from drake_twin.control.trajectory import INTERPOLATION_METHODS
from drake_twin.controllers.goal_state import ACTION_MONITOR_RATE
from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError


@dataclass(frozen=True)
class SpeedScaling:
    """The speed of trajectories relative to real time.

    Attributes:
        initial_scaling_factor: The factor before the first on ``~/speed_scaling_input``; only with the position
            interface alone.
        state_interface: The interface on which hardware reports its factor.
        command_interface: The interface on which hardware receives the factor.
    """

    initial_scaling_factor: float = field(default=1.0, metadata={"lower": 0.0})
    state_interface: str = field(default="", metadata={"unsupported": "the twin's hardware does not scale its speed"})
    command_interface: str = field(default="", metadata={"unsupported": "the twin's hardware does not scale its speed"})


@dataclass(frozen=True)
class JointTrajectoryGains(PidGains):
    """The PID of one joint, used with the interface ``velocity`` or ``effort`` alone.

    Attributes:
        p: Proportional gain.
        i: Integral gain.
        d: Derivative gain.
        i_clamp: The bound of the integral term in both directions; ``i_clamp_max`` and ``i_clamp_min``
            override it.
        i_clamp_max: The highest integral term.
        i_clamp_min: The lowest integral term.
        ff_velocity_scale: The factor with which the trajectory's velocity is added to the command.
        u_clamp_max: The highest command of the PID.
        u_clamp_min: The lowest command of the PID.
        antiwindup_strategy: See `PidGains`.
        tracking_time_constant: See `PidGains` (s).
        error_deadband: An error of at most this is not integrated.
    """

    i_clamp: float = inf
    ff_velocity_scale: float = 0.0
    error_deadband: float = 0.0

    @property
    def pid_gains(self) -> PidGains:
        """The gains with the bounds of the integral term that hold."""
        return replace(
            self,
            i_clamp_max=self.i_clamp_max if isfinite(self.i_clamp_max) else self.i_clamp,
            i_clamp_min=self.i_clamp_min if isfinite(self.i_clamp_min) else -self.i_clamp,
        )


@dataclass(frozen=True)
class JointConstraints:
    """The tolerances of one joint.

    Attributes:
        trajectory: The largest position error before the end (rad or m); 0 for any.
        goal: The largest position error at the end (rad or m); 0 for any.
        max_deceleration_on_cancel: The deceleration with which the joint is brought to rest (rad/s² or m/s²).
    """

    trajectory: float = 0.0
    goal: float = 0.0
    max_deceleration_on_cancel: float = field(default=0.0, metadata={"lower": 0.0})


@dataclass(frozen=True)
class TrajectoryConstraints:
    """The conditions under which a trajectory ends.

    Attributes:
        stopped_velocity_tolerance: The largest velocity error at the end (rad/s or m/s); as upstream, it has no effect
            without a velocity or effort command interface.
        goal_time: The time after the end in which a trajectory may reach its goal tolerances (s); 0 for any.
        decelerate_on_cancel: Whether a cancelation brakes the joints instead of holding them at once.
        joints: The tolerances of each joint, by its name.
    """

    stopped_velocity_tolerance: float = 0.01
    goal_time: float = field(default=0.0, metadata={"lower": 0.0})
    decelerate_on_cancel: bool = False
    joints: Mapping[str, JointConstraints] = field(default_factory=dict, metadata={"of_joints": True, "keys": "joints"})


@dataclass(frozen=True)
class JointTrajectoryParameters:
    """Parameters of ``joint_trajectory_controller/JointTrajectoryController``.

    Attributes:
        joints: The joints, in the order of the controller's messages.
        command_joints: The joints or references to command, if they are not ``joints``: fewer of them, or as many with
            other names.
        command_interfaces: The interfaces of each joint: ``position``, with ``velocity``, with ``acceleration``;
            ``velocity`` or ``effort`` alone; or ``position`` and ``effort``.
        state_interfaces: The interfaces of each joint: ``position``, with ``velocity``, with ``acceleration``.
        speed_scaling: The speed of trajectories.
        allow_partial_joints_goal: Whether a trajectory may omit joints, which stay at their positions.
        open_loop_control: Deprecated upstream: like the next parameter, and without PID on the velocity interface.
        interpolate_from_desired_state: Whether a new trajectory begins at the present set-point instead of the measured
            state.
        allow_integration_in_goal_trajectories: Whether points may lack positions.
        set_last_command_interface_value_as_state_on_activation: Whether a controller that is activated again holds its
            last commanded positions if the joints are still there.
        action_monitor_rate: The rate at which the goal's state is checked (Hz).
        interpolation_method: ``splines`` or ``none``.
        allow_nonzero_velocity_at_trajectory_end: Whether the last point may have a velocity.
        cmd_timeout: The time after the end at which a trajectory that has not succeeded is aborted (s); 0 for never.
        gains: The PID of each joint.
        constraints: The tolerances.
    """

    read_only: ClassVar[tuple[str, ...]] = (
        *("joints", "command_joints", "command_interfaces", "state_interfaces", "speed_scaling.*", "open_loop_control"),
        *("interpolate_from_desired_state", "action_monitor_rate", "interpolation_method"),
        *("gains.<joint>.antiwindup_strategy", "constraints.decelerate_on_cancel"),
        "constraints.<joint>.max_deceleration_on_cancel",
    )
    live: ClassVar[tuple[str, ...]] = ("gains.*", "constraints.*", "allow_*")

    joints: tuple[str, ...]
    command_interfaces: tuple[str, ...] = field(
        metadata={"choices": ("position", "velocity", "acceleration", "effort")}
    )
    state_interfaces: tuple[str, ...] = field(metadata={"choices": ("position", "velocity", "acceleration")})
    command_joints: tuple[str, ...] = ()
    speed_scaling: SpeedScaling = SpeedScaling()
    allow_partial_joints_goal: bool = False
    open_loop_control: bool = False
    interpolate_from_desired_state: bool = False
    allow_integration_in_goal_trajectories: bool = False
    set_last_command_interface_value_as_state_on_activation: bool = True
    action_monitor_rate: float = field(default=20.0, metadata=ACTION_MONITOR_RATE)
    interpolation_method: str = field(default="splines", metadata={"choices": INTERPOLATION_METHODS})
    allow_nonzero_velocity_at_trajectory_end: bool = False
    cmd_timeout: float = 0.0
    gains: Mapping[str, JointTrajectoryGains] = field(default_factory=dict, metadata={"keys": "joints"})
    constraints: TrajectoryConstraints = TrajectoryConstraints()

    @property
    def commanded(self) -> tuple[str, ...]:
        """The joints or references to command."""
        return self.command_joints or self.joints

    @property
    def commanded_indices(self) -> tuple[int, ...]:
        """The index in ``joints`` of each of `commanded`."""
        if len(self.commanded) == len(self.joints):
            return tuple(range(len(self.joints)))
        return tuple(self.joints.index(joint) for joint in self.commanded)

    @property
    def written_interfaces(self) -> tuple[str, ...]:
        """The command interfaces of each joint that the twin has: all but ``acceleration``."""
        return tuple(name for name in self.command_interfaces if name != "acceleration")

    @property
    def has_pid(self) -> bool:
        """Whether a PID calculates the commands, because they are velocities or efforts alone."""
        return self.command_interfaces == ("effort",) or (
            self.command_interfaces == ("velocity",) and not self.open_loop_control
        )

    @property
    def can_decelerate(self) -> bool:
        """Whether the joints are braked when a goal is canceled or aborted."""
        limits = (self.constraints.joints.get(joint, JointConstraints()) for joint in self.joints)
        return (
            self.constraints.decelerate_on_cancel
            and "velocity" in self.state_interfaces
            and all(limit.max_deceleration_on_cancel > 0.0 for limit in limits)
        )

    @property
    def effective_cmd_timeout(self) -> float:
        """``cmd_timeout`` (s), or 0 if it is not longer than ``goal_time``."""
        return self.cmd_timeout if self.cmd_timeout > self.constraints.goal_time else 0.0


def without_effect(parameters: JointTrajectoryParameters) -> list[str]:
    """Return the parameters without effect, each with the reason."""
    constraints = parameters.constraints
    texts = []
    if "acceleration" in (*parameters.command_interfaces, *parameters.state_interfaces):
        texts.append("the twin neither measures nor commands accelerations: these interfaces are left out")
    unknown = sorted({*parameters.gains, *constraints.joints} - {*parameters.joints})
    if unknown:
        texts.append(f"gains or constraints are given for {', '.join(unknown)}, which are not joints of the controller")
    if parameters.cmd_timeout > 0.0 and not parameters.effective_cmd_timeout:
        texts.append(
            f"cmd_timeout {parameters.cmd_timeout:g} is ignored: it is not above constraints.goal_time"
            f" {constraints.goal_time:g}"
        )
    if constraints.decelerate_on_cancel and not parameters.can_decelerate:
        texts.append(
            "decelerate_on_cancel is ignored: it needs the state interface velocity and a max_deceleration_on_cancel"
            " above zero for each joint"
        )
    if parameters.speed_scaling.initial_scaling_factor != 1.0 and parameters.command_interfaces != ("position",):
        texts.append("speed_scaling is ignored: it needs the command interface position alone")
    return texts


def check_interfaces(parameters: JointTrajectoryParameters) -> None:
    """Check that joints and interfaces match, as upstream does.

    Raises:
        InputError: If they do not.
    """
    for name in ("joints", "command_joints", "command_interfaces", "state_interfaces"):
        values = getattr(parameters, name)
        if not values and name != "command_joints":
            raise InputError(f"the parameter {name!r} is empty")
        if len(set(values)) < len(values):
            raise InputError(f"the parameter {name!r} has a duplicate name: {', '.join(values)}")
    if len(parameters.command_joints) > len(parameters.joints):
        raise InputError("the parameter 'command_joints' has more joints than 'joints'")
    if len(parameters.commanded) < len(parameters.joints):
        for joint in parameters.command_joints:
            if joint not in parameters.joints:
                raise InputError(
                    f"the command joint {joint!r} is not in 'joints'", valid=parameters.joints, value=joint
                )
    commands, states = set(parameters.command_interfaces), set(parameters.state_interfaces)
    if "velocity" in commands and "position" not in commands and len(commands) > 1:
        raise InputError("the command interface 'velocity' must be alone or with 'position'")
    if "acceleration" in commands and not {"position", "velocity"} & commands:
        raise InputError("the command interface 'acceleration' needs 'position' and 'velocity'")
    if "effort" in commands and not commands <= {"effort", "position"}:
        raise InputError("the command interface 'effort' must be alone or with 'position'")
    if "position" not in states:
        raise InputError("the state interface 'position' is missing")
    if "acceleration" in states and "velocity" not in states:
        raise InputError("the state interface 'acceleration' needs 'velocity'")
    if (commands == {"velocity"} or "effort" in commands) and "velocity" not in states:
        raise InputError(
            f"the command interfaces {', '.join(parameters.command_interfaces)} need the state interface 'velocity'"
        )
