"""tricycle_controller/test/test_tricycle_controller.cpp on the twin's controller."""

from drive_harness import Driven

from drake_twin.errors import InputError
from upstream.suite import Suite, refuses

ASSERTIONS = 15
SUITE = Suite("tricycle_controller/test/test_tricycle_controller.cpp")

KIND = "tricycle_controller/TricycleController"
PARAMETERS = {
    "traction_joint_name": "traction_joint",
    "steering_joint_name": "steering_joint",
    "wheelbase": 1.2,
    "wheel_radius": 0.12,
}


def drive(parameters=None):
    return Driven(KIND, PARAMETERS | (parameters or {}))


@SUITE.table(
    (
        (224, {"traction_joint_name": "", "steering_joint_name": ""}, True),
        (229, {"steering_joint_name": ""}, True),
        (232, {"traction_joint_name": ""}, True),
    )
)
def joints_that_are_refused(parameters):
    return refuses(lambda: drive(parameters), InputError)


@SUITE.scenario({244: 2, 245: {"traction_joint/velocity", "steering_joint/position"}})
def claims():
    names = {str(claim) for claim in drive().controller.claims}
    yield 244, len(names)
    yield 245, names


def stopped(dut, lines):
    """The steering's position, then the wheel's velocity."""
    yield from zip(lines, reversed(dut.commands), strict=True)


@SUITE.scenario(dict.fromkeys((310, 311, 317, 318), 0.0))
def stopped_by_a_deactivation():
    dut = drive()
    dut.send(x=1.0, z=1.0)
    dut.advance(0.005)
    dut.controller.deactivate(dut.context)
    yield from stopped(dut, (310, 311))
    dut.advance(0.015)
    yield from stopped(dut, (317, 318))


@SUITE.scenario({354: 0.0, 355: 1.0} | dict.fromkeys((366, 368, 374, 375), 0.0))
def a_command_and_a_deactivation():
    dut = drive({"wheelbase": 0.4, "wheel_radius": 1.0})
    dut.send(x=1.0)
    dut.advance(0.005)
    yield from stopped(dut, (354, 355))
    dut.controller.deactivate(dut.context)
    yield from stopped(dut, (366, 368))
    dut.advance(0.015)
    yield from stopped(dut, (374, 375))


test_holds_against_upstream = SUITE.test()
