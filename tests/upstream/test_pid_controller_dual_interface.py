"""pid_controller/test/test_pid_controller_dual_interface.cpp on the twin's controller."""

from upstream.pid import pid
from upstream.suite import Suite, near

ASSERTIONS = 6
SUITE = Suite("pid_controller/test/test_pid_controller_dual_interface.cpp")

GAINS = {"p": 0.5, "i": 0.3, "d": 0.4, "feedforward_gain": 1.0, "antiwindup_strategy": "none"}


@SUITE.scenario({66: 0.5, 67: 0.3, 68: 0.4, 69: 1.0, 104: near(8.9, 1e-9), 105: near(9.9, 1e-9)})
def feedforward_of_the_derivative():
    run = pid(
        [10.0, 11.0, 5.0, 6.0],
        chained=True,
        dof_names=["finger", "thumb"],
        command_interface="velocity",
        reference_and_state_interfaces=["position", "velocity"],
        enable_feedforward=True,
        gains={"finger": GAINS, "thumb": GAINS},
    )
    gains = run.controller.setup.parameters.gains["finger"]
    yield from zip((66, 67, 68, 69), (gains.p, gains.i, gains.d, gains.feedforward_gain), strict=True)
    run.advance(0.005)
    run.fix("above", [15.0, 16.0, 6.0, 7.0])
    run.advance(0.015)
    yield from zip((104, 105), run.commands(), strict=True)


test_holds_against_upstream = SUITE.test()
