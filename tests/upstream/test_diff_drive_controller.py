"""diff_drive_controller/test/test_diff_drive_controller.cpp on the twin's controller."""

from drive_harness import Driven

from drake_twin.controllers.base_controller import Upstream
from drake_twin.errors import InputError
from upstream.suite import Suite, above, below, near, refuses

ASSERTIONS = 97
SUITE = Suite("diff_drive_controller/test/test_diff_drive_controller.cpp")

KIND = "diff_drive_controller/DiffDriveController"
LEFT, RIGHT = ["left_wheel_joint"], ["right_wheel_joint"]
WHEELS = {"left_wheel_names": LEFT, "right_wheel_names": RIGHT, "wheel_separation": 1.0, "wheel_radius": 0.1}
UNIT = {"wheel_separation": 0.4, "wheel_radius": 1.0}  # a wheel's velocity is the base's


def drive(parameters=None, **setup):
    return Driven(KIND, WHEELS | (parameters or {}), **setup)


def pairs(lines, values):
    return zip(lines, values, strict=True)


@SUITE.table(
    (
        (283, {"left_wheel_names": [], "right_wheel_names": []}, True),
        (288, {"right_wheel_names": []}, True),
        (290, {"left_wheel_names": []}, True),
        (299, {"right_wheel_names": [*RIGHT, "extra_wheel"]}, True),
        (308, {}, False),
        (328, {"open_loop": True}, False),
    )
)
def wheels_that_are_refused(parameters):
    return refuses(lambda: drive(parameters), InputError)


@SUITE.table(((314, {}, 2), (334, {"open_loop": True}, 2)))
def number_of_claims(parameters):
    return len(drive(parameters).controller.claims)


PREFIX = "test_prefix"
FRAMES = (  # line, tf_frame_prefix_enable, tf_frame_prefix, namespace, the prefix of both frames
    (356, False, PREFIX, "", ""),
    (379, True, PREFIX, "", "test_prefix/"),
    (402, True, "", "", ""),
    (427, False, PREFIX, "/test_namespace", ""),
    (453, True, PREFIX, "/test_namespace", "test_prefix/"),
    (479, True, "", "/test_namespace", "test_namespace/"),
)


@SUITE.scenario(
    {line: f"{prefix}odom" for line, *_, prefix in FRAMES}
    | {line + 1: f"{prefix}base_link" for line, *_, prefix in FRAMES}
)
def frames_of_the_odometry():
    for line, enable, prefix, namespace, _ in FRAMES:
        dut = drive({"tf_frame_prefix_enable": enable, "tf_frame_prefix": prefix}, namespace=namespace)
        dut.advance(0.005)
        message = dut.message("odom")
        yield line, message.header.frame_id
        yield line + 1, message.child_frame_id


# Rows of the commanded velocity, the time until it is reached (s), then the lines of both wheels on the way, when it
# is reached, and after it, and what holds on the way.
RAMPS = (
    (1.0, 0.5, (602, 605), (612, 613), (621, 622), below(10.0)),
    (0.0, 0.25, (639, 642), (649, 650), (658, 659), above(0.0)),
    (-1.0, 0.125, (676, 679), (686, 687), (695, 696), above(-10.0)),
    (0.0, 0.1, (713, 716), (723, 724), (732, 733), below(0.0)),
)


@SUITE.scenario(
    dict.fromkeys((581, 582), near(0.0, 1e-3))
    | {line: on_the_way for *_, lines, _, _, on_the_way in RAMPS for line in lines}
    | {line: near(10.0 * goal, 1e-3) for goal, _, _, there, after, _ in RAMPS for line in (*there, *after)}
)
def four_ramps_within_the_limits():
    period = 0.001
    limits = {
        "max_acceleration": 2.0,
        "max_deceleration": -4.0,
        "max_acceleration_reverse": -8.0,
        "max_deceleration_reverse": 10.0,
    }
    dut = drive({"linear": {"x": limits}}, period=period)
    time = 0.01
    yield from pairs((581, 582), dut.commands_while(time, period, x=0.0)[-1])
    for goal, duration, on_the_way, there, after, _ in RAMPS:
        wheels = dut.commands_while(time + duration, period, x=goal)
        before = wheels[:-1]
        yield from pairs(on_the_way, before[abs(before[:, 0] - 10.0 * goal).argmin()])  # the nearest to the goal
        yield from pairs(there, wheels[-1])
        time += duration + 0.003
        yield from pairs(after, dut.commands_while(time, period, x=goal)[-1])


@SUITE.scenario({826: above(0.0), 827: above(0.0)} | dict.fromkeys((832, 834, 840, 841), 0.0))
def stopped_by_a_deactivation():
    dut = drive({"wheel_separation": 0.4})
    dut.send(x=1.0, z=1.0)
    dut.advance(0.005)
    yield from pairs((826, 827), dut.commands)
    dut.controller.deactivate(dut.context)
    yield from pairs((832, 834), dut.commands)
    dut.advance(0.105)
    yield from pairs((840, 841), dut.commands)


@SUITE.scenario({876: 1.0, 877: 1.0} | dict.fromkeys((887, 889, 894, 895), 0.0))
def a_command_and_a_deactivation():
    dut = drive(UNIT)
    dut.send(x=1.0)
    dut.advance(0.005)
    yield from pairs((876, 877), dut.commands)
    dut.controller.deactivate(dut.context)
    dut.advance(0.015)
    yield from pairs((887, 889), dut.commands)
    dut.advance(0.105)
    yield from pairs((894, 895), dut.commands)


@SUITE.scenario({954: 0.0, 956: 0.0, 968: 1.0, 969: 1.0} | dict.fromkeys((979, 981, 986, 988), 0.0))
def late_and_timely_commands():
    dut = drive(UNIT)
    dut.send(x=1.0)
    dut.advance(0.515)
    yield from pairs((954, 956), dut.commands)
    dut.send(x=1.0)
    dut.advance(0.525)
    yield from pairs((968, 969), dut.commands)
    dut.controller.deactivate(dut.context)
    dut.advance(0.535)
    yield from pairs((979, 981), dut.commands)
    dut.advance(0.6)
    yield from pairs((986, 988), dut.commands)


@SUITE.scenario({1044: 3.0, 1045: 3.0} | dict.fromkeys((1055, 1057, 1062, 1064), 0.0))
def references_of_a_preceding_controller():
    dut = drive(UNIT, upstream={"above": Upstream(2, (0, 1))})
    dut.controller.GetInputPort("above").FixValue(dut.context, [3.0, 0.0])
    dut.advance(0.005)
    yield from pairs((1044, 1045), dut.commands)
    dut.controller.deactivate(dut.context)
    dut.advance(0.015)
    yield from pairs((1055, 1057), dut.commands)
    dut.advance(0.1)
    yield from pairs((1062, 1064), dut.commands)


@SUITE.scenario({1080: 2, 1092: "linear/velocity", 1093: "angular/velocity", 1096: "velocity", 1098: "velocity"})
def references():
    controller = drive().controller
    linear, angular = controller.reference_interfaces(controller.setup.parameters, controller.setup.description)
    yield 1080, len((linear, angular))
    yield 1092, str(linear)
    yield 1093, str(angular)
    yield 1096, linear.name
    yield 1098, angular.name


@SUITE.scenario(dict.fromkeys((1146, 1147, 1186, 1187), 1.0) | dict.fromkeys((1157, 1159, 1174, 1176), 0.0))
def deactivated_and_activated():
    dut = drive(UNIT)
    dut.send(x=1.0)
    dut.advance(0.005)
    yield from pairs((1146, 1147), dut.commands)
    dut.controller.deactivate(dut.context)
    dut.advance(0.015)
    yield from pairs((1157, 1159), dut.commands)
    dut.activate()
    yield from pairs((1174, 1176), dut.commands)
    dut.send(x=1.0)
    dut.advance(0.025)
    yield from pairs((1186, 1187), dut.commands)


@SUITE.scenario(dict.fromkeys((1227, 1228, 1281, 1283), 1.0))
def stamps():
    dut = drive(UNIT)
    dut.send(x=1.0, stamp=0.0)
    dut.advance(0.005)
    yield from pairs((1227, 1228), dut.commands)
    dut = drive(UNIT | {"cmd_vel_timeout": 0.0})
    dut.advance(11.0)
    dut.send(x=1.0, stamp=1.0)
    dut.advance(11.015)
    yield from pairs((1281, 1283), dut.commands)


OPEN_LOOP = (  # lines of the velocity and position, then of the angular velocity and heading; limit; velocities
    ((1335, 1338), (1350, 1351), {"max_velocity": 0.5}, 0.5),
    ((1398, 1401), (1413, 1414), {}, 5.0),
)


@SUITE.scenario(
    {
        line: near(value, 1e-3)
        for linear, angular, _, velocity in OPEN_LOOP
        for lines in (linear, angular)
        for line, value in pairs(lines, (velocity, 0.1 * velocity))
    }
)
def open_loop_odometry():
    for of_x, of_heading, limits, _ in OPEN_LOOP:
        dut = drive({"open_loop": True, "linear": {"x": limits}, "angular": {"z": limits}}, period=0.1)
        dut.advance(0.05)
        dut.send(x=5.0)
        dut.advance(0.15)
        x, _, _, linear, _, _ = dut.odometry
        yield from pairs(of_x, (linear, x))
        dut.send(z=5.0)
        dut.advance(0.25)
        _, _, heading, _, _, angular = dut.odometry
        yield from pairs(of_heading, (angular, heading))


test_holds_against_upstream = SUITE.test()
