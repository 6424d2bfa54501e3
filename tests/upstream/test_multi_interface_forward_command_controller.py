"""forward_command_controller/test/test_multi_interface_forward_command_controller.cpp on the twin's controller."""

import numpy as np

from drake_twin.errors import InputError
from upstream.forwarding import COMMAND, Forwarding, of_three
from upstream.suite import Suite, refuses

ASSERTIONS = 20
SUITE = Suite("forward_command_controller/test/test_multi_interface_forward_command_controller.cpp")

INTERFACES = ["position", "velocity", "effort"]


def forwarding(**given):
    given = {"joint": "joint1", "interface_names": INTERFACES} | given
    return Forwarding("forward_command_controller/MultiInterfaceForwardCommandController", **given)


@SUITE.table(
    (
        (102, {"interface_names": []}, True),
        (113, {"joint": ""}, True),
        (126, {"joint": "", "interface_names": []}, True),
        (138, {"interface_names": []}, True),
    )
)
def parameters_that_are_refused(given):
    return refuses(lambda: forwarding(**given), InputError)


@SUITE.scenario({155: 3, 298: 3, 323: 3})
def claims():
    dut = forwarding()
    yield 155, len(dut.claims)
    yield 298, len(dut.claims)
    dut.deactivate()
    yield 323, len(dut.claims)


@SUITE.scenario(
    dict(zip(of_three(220, 287, 315), COMMAND * 3, strict=True))
    | dict(zip(of_three(374), [5.5, 6.6, 7.7], strict=True))
    | {331: True}
)
def commands_are_forwarded():
    dut = forwarding()
    dut.send(*COMMAND)
    yield from zip(of_three(220, 287, 315), dut.commands * 3, strict=True)
    dut.deactivate()
    yield 331, bool(np.isnan(dut.commands).all())
    dut.dut.activate(dut.context)
    dut.send(5.5, 6.6, 7.7)
    yield from zip(of_three(374), dut.commands, strict=True)


test_holds_against_upstream = SUITE.test()
