"""control_toolbox/test/pid_tests.cpp (05de3c6) on the twin's `Pid`."""

from math import inf, isfinite, nan

from drake_twin.control.pid import Pid, PidGains, PidMemory
from drake_twin.errors import InputError
from upstream.suite import Suite, refuses

ASSERTIONS = 132
SUITE = Suite("control_toolbox/test/pid_tests.cpp")


class RunningPid:
    """A PID with its memory."""

    def __init__(self, p, i, d, **more):
        self.pid = Pid(PidGains(p=p, i=i, d=d, **more))
        self.memory = PidMemory()

    def command(self, error, dt=1.0, error_dot=None):
        command, self.memory = self.pid.compute(error, error_dot, dt, self.memory)
        return command

    def reset(self, *, keep_integral=False):
        self.memory = PidMemory(integral=self.memory.integral if keep_integral else 0.0)

    def commands(self, rows):
        """Rows (line of the command, error, …)."""
        for line, error, *_ in rows:
            yield line, self.command(error)

    def integrals_and_commands(self, rows):
        """Rows (line of the integral term, error, integral term, command); the command's line is the next one."""
        for line, error, *_ in rows:
            command = self.command(error)
            yield line, self.memory.integral
            yield line + 1, command


def of_rows(rows):
    return {row[0]: row[-1] for row in rows}


def of_double_rows(rows):
    return {line + more: value for line, _, *values in rows for more, value in enumerate(values)}


def clamps(u_max, u_min):
    return {"u_clamp_max": u_max, "u_clamp_min": u_min}


BOUNDS = (  # line, limits, whether they are refused
    (60, clamps(-1.0, 1.0), True),
    (80, clamps(-1.0, 1.0), False),
    (311, {"i_clamp_max": -1.0, "i_clamp_min": 1.0}, True),
    (326, {"i_clamp_max": -2.0, "i_clamp_min": 2.0}, False),
)
ERRORS = (0.5, 1.0, 2.0, 10.0, 50.0, 100.0, -0.5, -1.0, -2.0, -10.0, -50.0, -100.0)
CLAMPED = tuple(
    zip(
        (104, 107, 110, 113, 116, 119, 124, 127, 130, 133, 136, 139),
        ERRORS,
        (0.5, 1.0, 1.0, 1.0, 1.0, 1.0, -0.5, -1.0, -1.0, -1.0, -1.0, -1.0),
        strict=True,
    )
)
NOT_CLAMPED = tuple(zip((162, 165, 168, 171, 174, 177, 182, 185, 188, 191, 194, 197), ERRORS, ERRORS, strict=True))
ZERO_ERRORS = (-1.0, -1.0, -1.0, 10.0, 10.0, 10.0)
BACK_ZERO_GAIN = tuple((225 + 5 * n, error, 0.0, 0.0) for n, error in enumerate(ZERO_ERRORS))
CONDITIONAL_ZERO_GAIN = tuple((274 + 5 * n, error, 0.0, 0.0) for n, error in enumerate(ZERO_ERRORS))
INTEGRAL_CLAMP = ((345, -10.03, -1.0), (349, 30.0, 1.0))
ANTIWINDUP = ((395, -1.0, -1.0), (398, -1.0, -1.0), (401, 0.5, 0.0), (404, -1.0, -1.0))
NEGATIVE_ANTIWINDUP = ((421, 0.1, -0.2), (424, 0.1, -0.2), (427, -0.05, -0.075), (430, 0.1, -0.2))
PROPORTIONAL = ((602, -0.5, -0.5), (607, -0.5, -0.5), (612, -1.0, -1.0), (617, 0.5, 0.5))
INTEGRAL = (  # line, error, command, what is reset after it
    (634, -0.5, None, -0.5),
    (639, -0.5, None, -1.0),
    (644, 0.0, None, -1.0),
    (648, 0.0, None, -1.0),
    (653, 1.0, None, 0.0),
    (658, -0.5, "all", -0.5),
    (663, 0.0, None, 0.0),
    (668, -0.5, "all", -0.5),
    (673, 0.0, None, 0.0),
    (678, -0.5, "all but the integral", -0.5),
    (683, 0.0, None, -0.5),
)
DERIVATIVE = (  # line, error, dt, command
    (702, -0.5, 1.0, -0.5),
    (707, -0.5, 1.0, 0.0),
    (712, -0.5, 0.1, 0.0),
    (717, -1.0, 1.0, -0.5),
    (722, -0.5, 1.0, 0.5),
)
COMPLETE = ((739, -0.5, -1.5), (744, -0.5, -1.5), (749, -1.0, -3.5))
BACK_CALCULATION = (  # line of the integral term, error, integral term, command
    (801, 1.0, 1.0, 0.0),
    (807, 2.0, 3.0, 1.0),
    (813, 3.0, 6.0, 3.0),
    (819, 1.0, 6.0, 5.0),
    (825, 2.0, 7.0, 5.0),
    (831, -1.0, 4.0, 5.0),
    (837, 1.0, 5.0, 4.0),
)
CONDITIONAL = (
    (862, 1.0, 1.0, 0.0),
    (868, 2.0, 3.0, 1.0),
    (874, 3.0, 6.0, 3.0),
    (880, 1.0, 6.0, 5.0),
    (886, 2.0, 6.0, 5.0),
    (892, -1.0, 5.0, 5.0),
    (898, 0.0, 5.0, 5.0),
)


@SUITE.table(BOUNDS)
def bounds_in_the_wrong_order(limits):
    return refuses(lambda: Pid(PidGains(1.0, 1.0, 1.0, **limits)), InputError)


@SUITE.scenario(of_rows(CLAMPED))
def output_is_clamped():
    return RunningPid(1.0, 0.0, 0.0, **clamps(1.0, -1.0), antiwindup_strategy="back_calculation").commands(CLAMPED)


@SUITE.scenario(of_rows(NOT_CLAMPED))
def output_is_not_clamped():
    return RunningPid(1.0, 0.0, 0.0, **clamps(inf, -inf), antiwindup_strategy="back_calculation").commands(NOT_CLAMPED)


@SUITE.scenario({219: 0.0} | of_double_rows(BACK_ZERO_GAIN))
def back_calculation_without_integral_gain():
    pid = RunningPid(0.0, 0.0, 0.0, **clamps(20.0, -20.0), antiwindup_strategy="back_calculation")
    yield 219, pid.pid.gains.tracking_time_constant
    yield from pid.integrals_and_commands(BACK_ZERO_GAIN)


@SUITE.scenario(of_double_rows(CONDITIONAL_ZERO_GAIN))
def conditional_integration_without_integral_gain():
    pid = RunningPid(0.0, 0.0, 0.0, **clamps(20.0, -20.0), antiwindup_strategy="conditional_integration")
    return pid.integrals_and_commands(CONDITIONAL_ZERO_GAIN)


def legacy(p, i, d, i_max, i_min):
    return RunningPid(p, i, d, i_clamp_max=i_max, i_clamp_min=i_min)


@SUITE.scenario(of_rows(INTEGRAL_CLAMP))
def integral_is_clamped():
    return legacy(0.0, 1.0, 0.0, 1.0, -1.0).commands(INTEGRAL_CLAMP)


@SUITE.scenario({370: True, 371: True, 372: 0.0, 375: True, 376: True, 377: 0.0})
def integral_without_gain_is_clamped():
    pid = legacy(0.0, 0.0, 0.0, 1.0, -1.0)
    for line in (370, 375):
        command = pid.command(-1.0)
        yield line, command >= -1.0
        yield line + 1, command <= 1.0
        yield line + 2, command


@SUITE.scenario(of_rows(ANTIWINDUP))
def integral_does_not_wind_up():
    return legacy(0.0, 2.0, 0.0, 1.0, -1.0).commands(ANTIWINDUP)


@SUITE.scenario(of_rows(NEGATIVE_ANTIWINDUP))
def integral_of_a_negative_gain_does_not_wind_up():
    return legacy(0.0, -2.5, 0.0, 0.5, -0.2).commands(NEGATIVE_ANTIWINDUP)


@SUITE.scenario(of_rows(PROPORTIONAL))
def proportional_only():
    return RunningPid(1.0, 0.0, 0.0).commands(PROPORTIONAL)


@SUITE.scenario(of_rows(INTEGRAL))
def integral_only():
    pid = legacy(0.0, 1.0, 0.0, 5.0, -5.0)
    for line, error, reset, _ in INTEGRAL:
        yield line, pid.command(error)
        if reset:
            pid.reset(keep_integral=reset == "all but the integral")


@SUITE.scenario(of_rows(DERIVATIVE))
def derivative_only():
    pid = RunningPid(0.0, 0.0, 1.0)
    for line, error, dt, _ in DERIVATIVE:
        yield line, pid.command(error, dt)


@SUITE.scenario(of_rows(COMPLETE))
def all_three_terms():
    return legacy(1.0, 1.0, 1.0, 5.0, -5.0).commands(COMPLETE)


@SUITE.scenario(of_double_rows(BACK_CALCULATION))
def back_calculation():
    return RunningPid(
        0.0, 1.0, 0.0, **clamps(5.0, -5.0), antiwindup_strategy="back_calculation", tracking_time_constant=1.0
    ).integrals_and_commands(BACK_CALCULATION)


@SUITE.scenario(of_double_rows(CONDITIONAL))
def conditional_integration():
    return RunningPid(
        0.0, 1.0, 0.0, **clamps(5.0, -5.0), antiwindup_strategy="conditional_integration", tracking_time_constant=1.0
    ).integrals_and_commands(CONDITIONAL)


@SUITE.scenario(
    {920: -1.5, 930: -1.5, 938: -2.0, 948: -2.0, 949: True, 951: True}
    | {955: False, 956: False, 958: True, 961: False, 962: False, 964: True}
)
def time_steps_and_errors_that_are_not_numbers():
    pid, other = legacy(1.0, 1.0, 1.0, 5.0, -5.0), legacy(1.0, 1.0, 1.0, 5.0, -5.0)
    yield 920, pid.command(-0.5)
    yield 930, pid.command(-0.5, 1.0, 0.0)
    yield 938, pid.command(-0.5, 1.0, 0.0)
    integral = pid.memory.integral
    yield 948, pid.command(-0.5, 0.0, 0.0)
    yield 949, pid.memory.integral == integral
    yield 951, refuses(lambda: pid.command(-0.5, -1.0, 0.0), ValueError)
    yield 955, isfinite(pid.command(nan, 1.0, 0.0))
    yield 956, isfinite(pid.memory.command)
    yield 958, pid.memory.integral == integral
    for _ in range(3):
        other.command(-0.5, 1.0, 0.0)
    before = other.memory.integral
    yield 961, isfinite(other.command(-0.5, 1.0, nan))
    yield 962, isfinite(other.memory.command)
    yield 964, other.memory.integral == before


test_holds_against_upstream = SUITE.test()
