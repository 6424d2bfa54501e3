"""forward_command_controller/test/test_forward_command_controller.cpp on the twin's controller."""

import numpy as np

from drake_twin.errors import CommandError, InputError
from upstream.forwarding import COMMAND, JOINTS, Forwarding, of_three
from upstream.suite import Suite, refuses

ASSERTIONS = 21
SUITE = Suite("forward_command_controller/test/test_forward_command_controller.cpp")


def forwarding(**given):
    given = {"joints": JOINTS, "interface_name": "position"} | given
    return Forwarding("forward_command_controller/ForwardCommandController", **given)


@SUITE.table(
    (
        (85, {"joints": [], "interface_name": ""}, True),
        (96, {"joints": [], "interface_name": "position"}, True),
        (109, {"joints": [], "interface_name": ""}, True),
        (121, {"joints": ["joint1", "joint2"], "interface_name": ""}, True),
    )
)
def parameters_that_are_refused(given):
    return refuses(lambda: forwarding(**given), InputError)


@SUITE.scenario({138: 2, 188: 3, 197: 3})
def claims():
    yield 138, len(forwarding(joints=["joint1", "joint2"]).claims)
    yield 188, len(forwarding().claims)
    yield 197, len(forwarding().claims)


@SUITE.scenario(
    dict(zip(of_three(234, 323, 415), COMMAND * 3, strict=True))
    | dict(zip(of_three(474), [5.5, 6.6, 7.7], strict=True))
    | {431: True}
)
def commands_are_forwarded():
    dut = forwarding()
    dut.send(*COMMAND)
    yield from zip(of_three(234, 323, 415), dut.commands * 3, strict=True)
    dut.deactivate()
    yield 431, bool(np.isnan(dut.commands).all())
    dut.dut.activate(dut.context)
    dut.send(5.5, 6.6, 7.7)
    yield from zip(of_three(474), dut.commands, strict=True)


@SUITE.scenario({367: True})
def a_command_that_is_not_finite_is_dropped():
    dut = forwarding()
    before = dut.commands
    assert refuses(lambda: dut.send(10.0, np.inf, 30.0), CommandError)
    yield 367, np.array_equal(dut.commands, before, equal_nan=True)


test_holds_against_upstream = SUITE.test()
