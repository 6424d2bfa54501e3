"""mecanum_drive_controller/test/test_mecanum_drive_controller.cpp on the twin's controller."""

from math import isnan, pi

import numpy as np
from drive_harness import Driven

from drake_twin.controllers.base_controller import Upstream
from drake_twin.errors import CommandError
from upstream.suite import Suite, above, below, near, refuses

ASSERTIONS = 99
SUITE = Suite("mecanum_drive_controller/test/test_mecanum_drive_controller.cpp")

KIND = "mecanum_drive_controller/MecanumDriveController"
JOINTS = ["front_left_wheel_joint", "front_right_wheel_joint", "back_right_wheel_joint", "back_left_wheel_joint"]
WHEELS = ("front_left", "front_right", "rear_right", "rear_left")
PARAMETERS = {
    "reference_timeout": 0.9,
    **{f"{wheel}_wheel_command_joint_name": joint for wheel, joint in zip(WHEELS, JOINTS, strict=True)},
    "kinematics": {
        "base_frame_offset": {"x": 0.0, "y": 0.0, "theta": 0.0},
        "wheels_radius": 0.5,
        "sum_of_robot_center_projection_on_X_Y_axis": 1.0,
    },
    "twist_covariance_diagonal": [0.0, 7.0, 14.0, 21.0, 28.0, 35.0],
    "pose_covariance_diagonal": [0.0, 6.0, 12.0, 18.0, 24.0, 30.0],
}
LIMITS = {
    "max_acceleration": 2.0,
    "max_deceleration": -4.0,
    "max_acceleration_reverse": -8.0,
    "max_deceleration_reverse": 10.0,
}
WITH_LIMITS = {"linear": {"x": LIMITS, "y": LIMITS}, "angular": {"z": LIMITS}}
PERIOD = 0.001  # s, of the ramps


def drive(parameters=None, **setup):
    return Driven(KIND, PARAMETERS | (parameters or {}), **setup)


class Chained:
    """A drive whose references come from another controller."""

    def __init__(self, parameters=None, period=PERIOD):
        self.dut = drive(parameters, period=period, upstream={"above": Upstream(3, (0, 1, 2))})
        self.period = period
        self.updates = 0

    def commands(self, reference, updates=1):
        """The wheels' velocities after each update with a reference."""
        self.dut.controller.GetInputPort("above").FixValue(self.dut.context, reference)
        written = []
        for _ in range(updates):
            self.dut.advance((self.updates + 0.5) * self.period)
            self.updates += 1
            written.append(self.dut.commands)
        return np.array(written)


def pairs(lines, values):
    return zip(lines, values, strict=True)


@SUITE.scenario(
    {62: 0.9, 63: 0.5, 64: 1.0, 66: 0.0, 67: 0.0, 68: 0.0}
    | {70: (0.0, 6.0, 12.0, 18.0, 24.0, 30.0), 73: (0.0, 7.0, 14.0, 21.0, 28.0, 35.0)}
    | dict(pairs((77, 79, 81, 83), JOINTS))
    | {84: JOINTS, 87: "", 88: "", 89: "", 90: "", 91: JOINTS}
)
def parameters_are_read():
    dut = drive()
    read = dut.controller.setup.parameters
    yield 62, read.reference_timeout
    yield 63, read.kinematics.wheels_radius
    yield 64, read.kinematics.sum_of_robot_center_projection_on_X_Y_axis
    offset = read.kinematics.base_frame_offset
    yield from pairs((66, 67, 68), (offset.x, offset.y, offset.theta))
    yield 70, read.pose_covariance_diagonal
    yield 73, read.twist_covariance_diagonal
    yield from pairs((77, 79, 81, 83), [getattr(read, f"{wheel}_wheel_command_joint_name") for wheel in WHEELS])
    yield 84, list(read.command_joints)
    yield from pairs((87, 88, 89, 90), [getattr(read, f"{wheel}_wheel_state_joint_name") for wheel in WHEELS])
    yield 91, list(read.state_joints(dut.controller.setup.layout.velocities))


REFERENCES = ["linear/x/velocity", "linear/y/velocity", "angular/z/velocity"]


@SUITE.scenario({102: 4, 105: [f"{joint}/velocity" for joint in JOINTS], 119: 3, 126: REFERENCES, 129: {"velocity"}})
def interfaces():
    controller = drive().controller
    yield 102, len(controller.claims)
    yield 105, [str(claim) for claim in controller.claims]
    references = controller.reference_interfaces(controller.setup.parameters, controller.setup.description)
    yield 119, len(references)
    yield 126, [str(reference) for reference in references]
    yield 129, {reference.name for reference in references}


PREFIX = "test_prefix"
FRAMES = (  # line, tf_frame_prefix_enable, tf_frame_prefix, namespace, the prefix of both frames
    (153, False, PREFIX, "", ""),
    (191, True, PREFIX, "", "test_prefix/"),
    (217, True, "", "", ""),
    (243, False, PREFIX, "/test_namespace", ""),
    (272, True, PREFIX, "/test_namespace", "test_prefix/"),
    (300, True, "", "/test_namespace", "test_namespace/"),
)


@SUITE.scenario(
    {line: f"{prefix}odom" for line, *_, prefix in FRAMES}
    | {line + 1: f"{prefix}base_link" for line, *_, prefix in FRAMES}
    | {164: list(PARAMETERS["pose_covariance_diagonal"]), 165: list(PARAMETERS["twist_covariance_diagonal"])}
)
def frames_and_covariances_of_the_odometry():
    for line, enable, prefix, namespace, _ in FRAMES:
        dut = drive({"tf_frame_prefix_enable": enable, "tf_frame_prefix": prefix}, namespace=namespace)
        dut.advance(0.005)
        message = dut.message("odometry")
        yield line, message.header.frame_id
        yield line + 1, message.child_frame_id
    for line, part in ((164, message.pose), (165, message.twist)):
        covariance = part.covariance.reshape(6, 6)
        diagonal = np.diag(covariance)
        assert not (covariance - np.diag(diagonal)).any()
        yield line, diagonal.tolist()


def is_unset(dut):
    return dut.controller.received(dut.controller.get_command_input_port(), dut.context) is None


@SUITE.scenario(dict.fromkeys((313, 314, 348, 350), True))
def activation_and_deactivation():
    dut = drive()
    yield 313, is_unset(dut)
    yield 314, is_unset(dut)
    dut.controller.deactivate(dut.context)
    yield 348, isnan(dut.commands[0])
    dut.activate()
    yield 350, isnan(dut.commands[0])


@SUITE.scenario({371: 1.5, 395: True, 421: 1.5})
def references_in_the_state_message():
    chained = Chained()
    chained.commands([1.5, 0.0, 0.0])
    yield 371, chained.dut.message("controller_state").reference_velocity.linear.x
    dut = drive()
    dut.advance(0.005)
    yield 395, isnan(dut.message("controller_state").reference_velocity.linear.x)
    dut.send(x=1.5)
    dut.advance(0.015)
    yield 421, dut.message("controller_state").reference_velocity.linear.x


@SUITE.scenario(dict.fromkeys((438, 450), True) | {481: above(0.0), 484: 1.5, 485: 0.0, 486: 0.0})
def stamps_that_are_too_old_and_zero():
    dut = drive()
    dut.advance(5.0)
    yield 438, is_unset(dut)
    assert refuses(lambda: dut.send(x=1.5, stamp=4.0), CommandError)
    yield 450, is_unset(dut)
    dut.send(x=1.5, stamp=0.0)
    command = dut.controller.received(dut.controller.get_command_input_port(), dut.context)
    yield 481, command.time
    yield from pairs((484, 485, 486), (command.linear_x, command.linear_y, command.angular_z))


@SUITE.scenario({503: True, 515: 1.5, 516: 0.0, 517: 0.0, 781: True, 797: 1.5, 798: 0.0, 799: 0.0})
def stamps_of_the_present():
    for first, lines, timeout in ((503, (515, 516, 517), 0.9), (781, (797, 798, 799), 0.0)):
        dut = drive({"reference_timeout": timeout})
        dut.advance(5.0)
        yield first, is_unset(dut)
        dut.send(x=1.5, stamp=5.0)
        command = dut.controller.received(dut.controller.get_command_input_port(), dut.context)
        yield from pairs(lines, (command.linear_x, command.linear_y, command.angular_z))


@SUITE.scenario({574: 0.0, 587: [0.0] * 4, 621: 3.0, 636: [3.0] * 4})
def late_and_timely_commands():
    dut = drive()
    dut.send(x=1.5)
    dut.advance(1.015)
    yield 574, dut.commands[3]
    yield 587, dut.commands
    dut.send(x=1.5, stamp=1.005)
    dut.advance(1.025)
    yield 621, dut.commands[3]
    yield 636, dut.commands


@SUITE.scenario({694: 6.0, 707: [6.0] * 4, 943: 4.0, 944: 36.0, 945: 16.0, 946: 24.0})
def references_of_a_preceding_controller():
    commands = Chained().commands([3.0, 0.0, 0.0])[0]
    yield 694, commands[3]
    yield 707, commands.tolist()
    chained = Chained()
    chained.commands([0.0, 0.0, 0.0], 3)
    yield from pairs((943, 944, 945, 946), chained.commands([10.0, 5.0, 3.0])[0])


@SUITE.scenario({747: False, 761: 3.0, 767: [0.0] * 4})
def a_command_without_a_timeout_is_used_once():
    """Upstream's reference is NaN after an update; here the next update shows that it is used up."""
    dut = drive({"reference_timeout": 0.0})
    dut.send(x=1.5)
    dut.advance(0.005)
    yield 747, isnan(dut.commands[1])
    yield 761, dut.commands[3]
    dut.advance(0.015)
    yield 767, dut.commands


@SUITE.scenario({811: 1.0, 812: 2.0, 813: 3.0, 897: below(1.0), 898: below(1.0), 899: below(pi)})
def odometry_from_side_to_side_and_in_turns():
    kinematics = {
        "base_frame_offset": {"x": 1.0, "y": 2.0, "theta": 3.0},
        "wheels_radius": 0.05,
        "sum_of_robot_center_projection_on_X_Y_axis": 0.2925,
    }
    chained = Chained({"kinematics": kinematics}, period=0.02)
    offset = chained.dut.controller.setup.parameters.kinematics.base_frame_offset
    yield from pairs((811, 812, 813), (offset.x, offset.y, offset.theta))
    for n in range(50):
        chained.commands(([0.0, 2.0, 0.0], [0.0, 0.0, -0.5], [0.0, -2.0, 0.0], [0.0, 0.0, 0.5])[n % 4])
    yield from pairs((897, 898, 899), map(abs, chained.dut.odometry[:3]))


# Rows of the reference, the updates until it is reached, the lines on the way, there and afterwards, and what holds
# on the way for the first wheel.
RAMPS = (
    (1.0, 500, 991, 1003, 1015, below(2.0)),
    (0.0, 250, 1034, 1045, 1056, above(0.0)),
    (-1.0, 125, 1075, 1086, 1097, above(-2.0)),
    (0.0, 100, 1116, 1127, 1138, below(0.0)),
)


@SUITE.scenario(
    {971: near(0.0, 1e-3)}
    | {on_the_way: holds for _, _, on_the_way, _, _, holds in RAMPS}
    | {line: near(2.0 * goal, 1e-3) for goal, _, _, there, after, _ in RAMPS for line in (there, after)}
)
def four_ramps_forwards_and_backwards():
    chained = Chained(WITH_LIMITS)
    yield 971, chained.commands([0.0, 0.0, 0.0], 3)[-1, 0]
    for goal, updates, on_the_way, there, after, _ in RAMPS:
        wheel = chained.commands([goal, 0.0, 0.0], updates)[:, 0]
        yield on_the_way, wheel[abs(wheel[:-1] - 2.0 * goal).argmin()]  # the nearest to the goal
        yield there, wheel[-1]
        yield after, chained.commands([goal, 0.0, 0.0], 3)[-1, 0]


@SUITE.scenario({1184: below(2.0), 1196: near(2.0, 1e-3), 1242: below(2.0), 1255: near(2.0, 1e-3)})
def ramps_sideways_and_in_turns():
    for on_the_way, there, reference in ((1184, 1196, [0.0, 1.0, 0.0]), (1242, 1255, [0.0, 0.0, 1.0])):
        chained = Chained(WITH_LIMITS)
        chained.commands([0.0, 0.0, 0.0], 3)
        front_right = chained.commands(reference, 500)[:, 1]
        yield on_the_way, front_right[:-1].max()
        yield there, front_right[-1]


@SUITE.scenario(
    {1330: near(2.0, 1e-3), 1332: near(1.0, 1e-3), 1340: (0.0, 0.0, 0.0), 1341: (0.0, 0.0, 0.0), 1351: below(2.0)}
)
def limits_begin_at_rest_after_a_reactivation():
    chained = Chained(WITH_LIMITS)
    dut = chained.dut
    yield 1330, chained.commands([1.0, 0.0, 0.0], 505)[-1, 0]
    yield 1332, dut.controller.sample(dut.context).memory.last[0]
    dut.controller.deactivate(dut.context)
    dut.activate()
    memory = dut.controller.sample(dut.context).memory
    yield 1340, memory.second_to_last
    yield 1341, memory.last
    yield 1351, chained.commands([1.0, 0.0, 0.0])[-1, 0]


test_holds_against_upstream = SUITE.test()
