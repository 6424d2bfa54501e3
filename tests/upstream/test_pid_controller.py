"""pid_controller/test/test_pid_controller.cpp on the twin's controller; its joint1 is the finger."""

from math import isnan

from upstream.pid import pid, reference
from upstream.suite import Suite, near

ASSERTIONS = 26
SUITE = Suite("pid_controller/test/test_pid_controller.cpp")

STATE = [1.1, 0.0, 0.0, 0.0]
TARGET = 101.101
GAINS = {"p": 1.0, "i": 2.0, "d": 3.0}


def controller(gains=GAINS, state=STATE, joint="finger", **given):
    """Upstream's parameters, without limits."""
    return pid(
        state,
        dof_names=[joint],
        command_interface="effort",
        reference_and_state_interfaces=["position"],
        gains={joint: {"antiwindup_strategy": "none"} | gains},
        **given,
    )


def first_command(run, value=None, chained=None):
    """The command of the first update with a reference, 10 ms after the one of the activation's time."""
    run.advance(0.005)
    if chained is not None:
        run.fix("above", [chained])
    if value is not None:
        run.send("reference", reference(value))
    run.advance(0.015)
    return run.commands()[0]


LIMITED = GAINS | {"u_clamp_max": 5.0, "u_clamp_min": -5.0}


@SUITE.scenario(
    {41: ("finger",), 42: (), 46: 1.0, 47: 2.0, 48: 3.0, 50: 5.0, 51: -5.0, 52: 0.0, 54: "effort", 55: ("position",)}
    | {58: False}
)
def parameters_are_read():
    read = controller(LIMITED).controller.setup.parameters
    gains = read.gains["finger"]
    yield 41, read.dof_names
    yield 42, read.reference_and_state_dof_names
    yield from zip((46, 47, 48), (gains.p, gains.i, gains.d), strict=True)
    yield from zip((50, 51, 52), (gains.u_clamp_max, gains.u_clamp_min, gains.feedforward_gain), strict=True)
    yield 54, read.command_interface
    yield 55, read.reference_and_state_interfaces
    yield 58, read.use_external_measured_states


@SUITE.scenario({347: near(30100.301, 1e-5), 414: near(30100.301, 1e-5)})
def first_update_of_a_topic():
    yield 347, first_command(controller(), TARGET)
    yield 414, first_command(controller(enable_feedforward=True), TARGET)


@SUITE.scenario({473: near(1173.9, 1e-9), 506: near(2678.9, 1e-5), 543: near(787.6612219, 1e-5)})
def first_update_of_a_preceding_controller():
    yield 473, first_command(controller(chained=True), chained=5.0)
    yield 506, first_command(controller(chained=True), chained=10.0)
    wraps = controller(GAINS | {"angle_wraparound": True}, [0.0, 1.1, 0.0, 0.0], "thumb", chained=True)
    yield 543, first_command(wraps, chained=10.0)


@SUITE.scenario({652: 0.5, 653: 1.0, 689: near(6.95, 1e-9), 747: near(1.95, 1e-9)})
def feedforward_with_a_gain():
    gains = {"p": 0.5, "i": 0.0, "d": 0.0, "feedforward_gain": 1.0}
    run = controller(gains, enable_feedforward=True)
    read = run.controller.setup.parameters.gains["finger"]
    yield 652, read.p
    yield 653, read.feedforward_gain
    yield 689, first_command(run, 5.0)
    yield 747, first_command(controller(gains), 5.0)


@SUITE.scenario(
    {785: near(30100.301, 1e-5), 798: near(0.0, 1e-5), 836: near(30100.301, 1e-5), 849: near(2.00002, 1e-5)}
)
def integral_terms_across_a_reactivation():
    for lines, saved in (((785, 798), False), ((836, 849), True)):
        run = controller(GAINS | {"save_i_term": saved})
        yield lines[0], first_command(run, TARGET)
        run.controller.deactivate(run.context)
        run.fix("reference", None)
        run.controller.activate(run.context)
        run.advance(0.025)
        yield lines[1], run.commands()[0]


@SUITE.scenario({872: 0.0, 894: True})
def first_reference():
    """The state is the first reference, so that the first command is zero; without it there is no command."""
    yield 872, first_command(controller(LIMITED))
    yield 894, isnan(first_command(controller(LIMITED, set_current_state_as_first_setpoint=False)))


test_holds_against_upstream = SUITE.test()
