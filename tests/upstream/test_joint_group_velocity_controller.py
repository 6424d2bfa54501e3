"""velocity_controllers/test/test_joint_group_velocity_controller.cpp on the twin's controller."""

from drake_twin.errors import InputError
from upstream.forwarding import COMMAND, JOINTS, Forwarding, of_three
from upstream.suite import Suite, refuses

ASSERTIONS = 11
SUITE = Suite("velocity_controllers/test/test_joint_group_velocity_controller.cpp")


def forwarding(**given):
    return Forwarding("velocity_controllers/JointGroupVelocityController", **({"joints": JOINTS} | given))


@SUITE.scenario({63: True, 72: True})
def joints_are_needed():
    yield 63, refuses(lambda: Forwarding("velocity_controllers/JointGroupVelocityController"), InputError)
    yield 72, refuses(lambda: forwarding(joints=[]), InputError)


@SUITE.scenario(dict(zip(of_three(129, 212), COMMAND * 2, strict=True)))
def commands_are_forwarded():
    dut = forwarding()
    dut.send(*COMMAND)
    yield from zip(of_three(129, 212), dut.commands * 2, strict=True)


@SUITE.scenario(dict.fromkeys(of_three(234), 0.0))
def deactivated():
    dut = forwarding()
    dut.send(*COMMAND)
    dut.deactivate()
    yield from zip(of_three(234), dut.commands, strict=True)


test_holds_against_upstream = SUITE.test()
