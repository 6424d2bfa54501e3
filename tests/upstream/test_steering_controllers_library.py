"""steering_controllers_library/test/test_steering_controllers_library.cpp on the twin's Ackermann controller.

Upstream's joints do not move, so that each command comes from an update at which they still rest: updates are 0.2 s
apart here, further than ``reference_timeout``.
"""

from math import nan

from drive_harness import Driven

from upstream.suite import Suite, above, near

ASSERTIONS = 32
SUITE = Suite("steering_controllers_library/test/test_steering_controllers_library.cpp")

DRIVEN, STEERED = (
    ["rear_right_wheel_joint", "rear_left_wheel_joint"],
    ["front_right_steering_joint", "front_left_steering_joint"],
)
PARAMETERS = {
    "reference_timeout": 0.1,
    "traction_joints_names": DRIVEN,
    "steering_joints_names": STEERED,
    "wheelbase": 3.24644,
    "traction_track_width": 2.12321,
    "traction_wheels_radius": 0.45,
}
SPEED, ANGLE = near(3.333333, 1e-6), near(0.575875, 1e-6)


def drive(period=0.2, **parameters):
    return Driven("ackermann_steering_controller/AckermannSteeringController", PARAMETERS | parameters, period=period)


def pairs(lines, values):
    return zip(lines, values, strict=True)


@SUITE.scenario(
    {36: 4, 37: f"{DRIVEN[0]}/velocity", 40: f"{DRIVEN[1]}/velocity"}
    | {43: f"{STEERED[0]}/position", 46: f"{STEERED[1]}/position"}
    | {69: 2, 75: {"linear/velocity", "angular/velocity"}, 78: {"velocity"}}
)
def interfaces():
    controller = drive().controller
    yield 36, len(controller.claims)
    yield from pairs((37, 40, 43, 46), map(str, controller.claims))
    references = controller.reference_interfaces(controller.setup.parameters, controller.setup.description)
    yield 69, len(references)
    yield 75, {str(reference) for reference in references}
    yield 78, {reference.name for reference in references}


# Of each kind of feedback: the lines of a command's four values, of the wheels before it expires, and after it.
FEEDBACK = (
    (True, (137, 138, 139, 140), (166, 167), (184, 185, 188, 189)),
    (False, (249, 250, 251, 252), (267, 268), (285, 286, 289, 290)),
)


@SUITE.scenario(
    {line: value for _, lines, _, _ in FEEDBACK for line, value in pairs(lines, (SPEED, SPEED, ANGLE, ANGLE))}
    | {line: above(0.0) for _, _, lines, _ in FEEDBACK for line in lines}
    | {line: value for *_, lines in FEEDBACK for line, value in pairs(lines, (0.0, 0.0, ANGLE, ANGLE))}
)
def an_expired_command_stops_the_wheels_and_keeps_the_angles():
    for position_feedback, present, before, expired in FEEDBACK:
        dut = drive(position_feedback=position_feedback)
        dut.send(x=1.5, z=0.3)
        dut.advance(0.1)
        yield from pairs(present, dut.commands)
        yield from pairs(before, dut.commands[:2])
        dut.advance(0.3)
        yield from pairs(expired, dut.commands)


@SUITE.scenario({320: above(0.1), 335: 0.0})
def a_command_that_is_nan_stops_the_wheels():
    dut = drive(period=0.01, open_loop=True)
    dut.send(x=1.5)
    dut.advance(0.005)
    yield 320, dut.commands[0]
    dut.send(x=nan, z=nan)
    dut.advance(0.015)
    yield 335, dut.commands[0]


@SUITE.scenario({369: above(0.0), 376: 0.0})
def open_loop_odometry_stops_with_an_expired_command():
    dut = drive(period=0.1, open_loop=True, reference_timeout=1.0)
    dut.send(x=5.0)
    dut.advance(0.15)
    yield 369, dut.odometry[3]
    dut.advance(2.15)
    yield 376, dut.odometry[3]


test_holds_against_upstream = SUITE.test()
