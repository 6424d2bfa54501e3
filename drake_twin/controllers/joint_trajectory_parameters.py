"""Parameters of joint_trajectory_controller (Jazzy), and which of them go together."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import inf, isfinite

from drake_twin.control.pid import ANTIWINDUP_STRATEGIES, PidGains
from drake_twin.control.trajectory import INTERPOLATION_METHODS
from drake_twin.controllers.goal_state import ACTION_MONITOR_RATE
from drake_twin.errors import InputError


@dataclass(frozen=True)
class SpeedScaling:
    """How much slower or faster than real time a trajectory runs.

    Attributes:
        initial_scaling_factor: the factor until one comes on ``~/speed_scaling_input``; with the position interface
            alone.
        state_interface: where hardware would tell its factor.
        command_interface: where hardware would be told the factor.
    """

    initial_scaling_factor: float = field(default=1.0, metadata={"lower": 0.0})
    state_interface: str = field(default="", metadata={"unsupported": "no hardware of the twin scales its speed"})
    command_interface: str = field(default="", metadata={"unsupported": "no hardware of the twin scales its speed"})


@dataclass(frozen=True)
class JointTrajectoryGains:
    """The PID of one joint, used with the interface ``velocity`` or ``effort`` alone.

    Attributes:
        p: proportional gain.
        i: integral gain.
        d: derivative gain.
        i_clamp: the bound of the integral term in both directions; the next two come before it.
        i_clamp_max: the highest integral term.
        i_clamp_min: the lowest integral term.
        ff_velocity_scale: how much of the trajectory's velocity is added to the command.
        u_clamp_max: the highest command of the PID.
        u_clamp_min: the lowest command of the PID.
        antiwindup_strategy: see `PidGains`.
        tracking_time_constant: see `PidGains` (s).
        error_deadband: an error of at most this is not integrated.
    """

    p: float = 0.0
    i: float = 0.0
    d: float = 0.0
    i_clamp: float = inf
    i_clamp_max: float = inf
    i_clamp_min: float = -inf
    ff_velocity_scale: float = 0.0
    u_clamp_max: float = inf
    u_clamp_min: float = -inf
    antiwindup_strategy: str = field(default="legacy", metadata={"choices": ANTIWINDUP_STRATEGIES})
    tracking_time_constant: float = 0.0
    error_deadband: float = 0.0

    @property
    def pid_gains(self) -> PidGains:
        """The gains of the PID law."""
        return PidGains(
            p=self.p,
            i=self.i,
            d=self.d,
            u_clamp_max=self.u_clamp_max,
            u_clamp_min=self.u_clamp_min,
            i_clamp_max=self.i_clamp_max if isfinite(self.i_clamp_max) else self.i_clamp,
            i_clamp_min=self.i_clamp_min if isfinite(self.i_clamp_min) else -self.i_clamp,
            antiwindup_strategy=self.antiwindup_strategy,
            tracking_time_constant=self.tracking_time_constant,
            error_deadband=self.error_deadband,
        )


@dataclass(frozen=True)
class JointConstraints:
    """The tolerances of one joint.

    Attributes:
        trajectory: the largest position error on the way (rad or m); 0 for any.
        goal: the largest position error at the end (rad or m); 0 for any.
        max_deceleration_on_cancel: with which it is brought to rest (rad/s² or m/s²).
    """

    trajectory: float = 0.0
    goal: float = 0.0
    max_deceleration_on_cancel: float = field(default=0.0, metadata={"lower": 0.0})


@dataclass(frozen=True)
class TrajectoryConstraints:
    """What ends a trajectory, and how.

    Attributes:
        stopped_velocity_tolerance: the largest velocity error at the end (rad/s or m/s); like upstream's it is of no
            meaning without a velocity or effort command interface.
        goal_time: how long after its end a trajectory may still reach its goal tolerances (s); 0 for ever.
        decelerate_on_cancel: whether the joints are braked instead of being held where they are.
        joints: the tolerances of each joint, below its name.
    """

    stopped_velocity_tolerance: float = 0.01
    goal_time: float = field(default=0.0, metadata={"lower": 0.0})
    decelerate_on_cancel: bool = False
    joints: Mapping[str, JointConstraints] = field(default_factory=dict, metadata={"of_joints": True})


@dataclass(frozen=True)
class JointTrajectoryParameters:
    """Parameters of ``joint_trajectory_controller/JointTrajectoryController``.

    Attributes:
        joints: the joints, in the order of its messages.
        command_joints: the joints or references that are commanded, when they are not ``joints``: fewer of them, or
            as many of another name.
        command_interfaces: of each joint: ``position``, with ``velocity``, with ``acceleration``; ``velocity`` or
            ``effort`` alone; or ``position`` and ``effort``.
        state_interfaces: of each joint: ``position``, with ``velocity``, with ``acceleration``.
        speed_scaling: how fast trajectories run.
        allow_partial_joints_goal: whether a trajectory may leave joints out; they stay where they are.
        open_loop_control: deprecated upstream: like the next, and without PID at the velocity interface.
        interpolate_from_desired_state: whether a new trajectory begins at the present set-point, not at the measured
            state.
        allow_integration_in_goal_trajectories: whether points may come without positions.
        set_last_command_interface_value_as_state_on_activation: whether a controller that is activated again holds
            what it commanded last, provided that the joints are still there.
        action_monitor_rate: how often action clients would be told (Hz).
        interpolation_method: ``splines`` or ``none``.
        allow_nonzero_velocity_at_trajectory_end: whether the last point may have a velocity.
        cmd_timeout: how long after its end a trajectory that has not succeeded is held on to (s); 0 for ever.
        gains: the PID of each joint.
        constraints: tolerances.
    """

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
    gains: Mapping[str, JointTrajectoryGains] = field(default_factory=dict)
    constraints: TrajectoryConstraints = TrajectoryConstraints()

    @property
    def commanded(self) -> tuple[str, ...]:
        """The joints or references that are commanded."""
        return self.command_joints or self.joints

    @property
    def commanded_indices(self) -> tuple[int, ...]:
        """For each of `commanded` its index in ``joints``."""
        if len(self.commanded) == len(self.joints):
            return tuple(range(len(self.joints)))
        return tuple(self.joints.index(joint) for joint in self.commanded)

    @property
    def written_interfaces(self) -> tuple[str, ...]:
        """The command interfaces of each joint that the twin has: all but ``acceleration``."""
        return tuple(name for name in self.command_interfaces if name != "acceleration")

    @property
    def has_pid(self) -> bool:
        """Whether commands come from a PID, because they are of velocity or effort alone."""
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
        """``cmd_timeout`` (s), or 0 where it would come before ``goal_time``."""
        return self.cmd_timeout if self.cmd_timeout > self.constraints.goal_time else 0.0


def without_effect(parameters: JointTrajectoryParameters) -> list[str]:
    """What of the parameters has no effect, and why."""
    constraints = parameters.constraints
    texts = []
    if "acceleration" in (*parameters.command_interfaces, *parameters.state_interfaces):
        texts.append("nothing in the twin measures or takes accelerations: the interfaces are left out")
    unknown = sorted({*parameters.gains, *constraints.joints} - {*parameters.joints})
    if unknown:
        texts.append(f"there are gains or constraints for {', '.join(unknown)}, which are none of its joints")
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
    """Whether joints and interfaces go together as upstream demands.

    Raises:
        InputError: they do not.
    """
    for name in ("joints", "command_joints", "command_interfaces", "state_interfaces"):
        values = getattr(parameters, name)
        if not values and name != "command_joints":
            raise InputError(f"the parameter {name!r} is empty")
        if len(set(values)) < len(values):
            raise InputError(f"the parameter {name!r} has the same name twice: {', '.join(values)}")
    if len(parameters.command_joints) > len(parameters.joints):
        raise InputError("the parameter 'command_joints' has more joints than 'joints'")
    if len(parameters.commanded) < len(parameters.joints):
        for joint in parameters.command_joints:
            if joint not in parameters.joints:
                raise InputError(
                    f"the command joint {joint!r} is none of 'joints'", valid=parameters.joints, value=joint
                )
    commands, states = set(parameters.command_interfaces), set(parameters.state_interfaces)
    if "velocity" in commands and "position" not in commands and len(commands) > 1:
        raise InputError("the command interface 'velocity' stands alone or with 'position'")
    if "acceleration" in commands and not {"position", "velocity"} & commands:
        raise InputError("the command interface 'acceleration' needs 'position' and 'velocity' beside it")
    if "effort" in commands and not commands <= {"effort", "position"}:
        raise InputError("the command interface 'effort' stands alone or with 'position'")
    if "position" not in states:
        raise InputError("the state interface 'position' is missing")
    if "acceleration" in states and "velocity" not in states:
        raise InputError("the state interface 'acceleration' needs 'velocity' beside it")
    if (commands == {"velocity"} or "effort" in commands) and "velocity" not in states:
        raise InputError(
            f"the command interfaces {', '.join(parameters.command_interfaces)} need the state interface 'velocity'"
        )
