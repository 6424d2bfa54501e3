"""The PID law of control_toolbox, with its limits and its strategies against integral wind-up."""

from dataclasses import field, replace
from math import inf, isfinite, isnan, nan, sqrt

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.saved import saved

ANTIWINDUP_STRATEGIES = ("back_calculation", "conditional_integration", "legacy", "none")

_EPSILON = 2.0**-52


@dataclass(frozen=True)
class PidGains:
    """Gains and limits, named as in the parameters of joint_trajectory_controller and pid_controller.

    The deprecated ``antiwindup`` of pid_controller has no counterpart here: upstream clamps the integral term either
    way, so that it changes no command.

    Attributes:
        p: Proportional gain (unit of the command per unit of the error).
        i: Integral gain (per second).
        d: Derivative gain (times second).
        u_clamp_max: The highest command.
        u_clamp_min: The lowest command.
        i_clamp_max: The highest integral term, not below 0; in the unit of the command.
        i_clamp_min: The lowest integral term, not above 0.
        antiwindup_strategy: One of `ANTIWINDUP_STRATEGIES`. ``legacy`` integrates before the command is formed, the
            others after it.
        tracking_time_constant: Of ``back_calculation`` (s); 0 for √(d/i), or p/i without d.
        error_deadband: The largest error that is not integrated.
    """

    p: float = 0.0
    i: float = 0.0
    d: float = 0.0
    u_clamp_max: float = inf
    u_clamp_min: float = -inf
    i_clamp_max: float = inf
    i_clamp_min: float = -inf
    antiwindup_strategy: str = field(default="legacy", metadata={"choices": ANTIWINDUP_STRATEGIES})
    tracking_time_constant: float = 0.0
    error_deadband: float = _EPSILON


@saved("PidMemory")
@dataclass(frozen=True)
class PidMemory:
    """What a PID keeps from one call to the next.

    Attributes:
        integral: The integral term, in the unit of the command.
        error: The last error that was differentiated.
        command: The last command.
    """

    integral: float = 0.0
    error: float = 0.0
    command: float = 0.0


class Pid:
    """``command = p·error + integral + d·error_dot``, as control_toolbox's ``Pid`` computes it (Jazzy).

    Args:
        gains: Gains and limits.

    Raises:
        InputError: If the limits exclude each other, or the strategy is unknown or lacks its time constant.
    """

    def __init__(self, gains: PidGains):
        if isnan(gains.u_clamp_min) or isnan(gains.u_clamp_max) or gains.u_clamp_min >= gains.u_clamp_max:
            raise InputError(f"u_clamp_min {gains.u_clamp_min:g} is not below u_clamp_max {gains.u_clamp_max:g}")
        if not gains.i_clamp_min <= 0.0 <= gains.i_clamp_max:
            raise InputError(
                f"i_clamp_min {gains.i_clamp_min:g} and i_clamp_max {gains.i_clamp_max:g} do not have zero between them"
            )
        strategy = gains.antiwindup_strategy
        if strategy not in ANTIWINDUP_STRATEGIES:
            raise InputError(f"unknown antiwindup_strategy {strategy!r}", valid=ANTIWINDUP_STRATEGIES, value=strategy)
        if strategy == "back_calculation" and gains.i != 0.0:
            gains = replace(gains, tracking_time_constant=_tracking_time_constant(gains))
        self.gains = gains

    def compute(self, error: float, error_dot: float | None, dt: float, memory: PidMemory) -> tuple[float, PidMemory]:
        """Compute one step.

        Args:
            error: Desired minus measured.
            error_dot: Its derivative (per second); None to take the difference to the last error.
            dt: Time since the last step (s); zero repeats the last command.
            memory: The memory after the last step; ``PidMemory()`` at first.

        Returns:
            The command, which is NaN when the error is not finite, and the new memory.

        Raises:
            ValueError: If ``dt`` is negative.
        """
        if dt < 0.0:
            raise ValueError(f"time runs backwards by {-dt:g} s")
        if dt <= _EPSILON:
            return memory.command, memory
        if error_dot is None and isfinite(error):
            error_dot = (error - memory.error) / dt
            memory = replace(memory, error=error)
        if error_dot is None or not (isfinite(error) and isfinite(error_dot)):
            return nan, replace(memory, command=nan)
        gains = self.gains
        is_integrated = abs(error) > gains.error_deadband
        integral = memory.integral
        if is_integrated and gains.antiwindup_strategy == "legacy":
            integral += gains.i * dt * error
            integral = min(max(integral, gains.i_clamp_min), gains.i_clamp_max)
        wanted = gains.p * error + integral + gains.d * error_dot
        command = min(max(wanted, gains.u_clamp_min), gains.u_clamp_max)
        if is_integrated:
            integral += dt * self._integrand(error, wanted, command)
        integral = min(max(integral, gains.i_clamp_min), gains.i_clamp_max)
        return command, replace(memory, integral=integral, command=command)

    def _integrand(self, error: float, wanted: float, command: float) -> float:
        """Return what the strategies that integrate after the command add per second."""
        gains = self.gains
        if gains.antiwindup_strategy == "legacy" or gains.i == 0.0:
            return 0.0
        if gains.antiwindup_strategy == "back_calculation":
            return gains.i * error + (command - wanted) / gains.tracking_time_constant
        is_winding_up = abs(wanted - command) > _EPSILON and error * wanted > 0.0
        return 0.0 if gains.antiwindup_strategy == "conditional_integration" and is_winding_up else gains.i * error


def _tracking_time_constant(gains: PidGains) -> float:
    constant = gains.tracking_time_constant
    if constant == 0.0:
        constant = sqrt(max(gains.d / gains.i, 0.0)) if gains.d != 0.0 else gains.p / gains.i
    if not (constant > 0.0 and isfinite(constant)):
        raise InputError(f"back_calculation needs a tracking_time_constant above zero, not {constant:g}")
    return constant
