"""steering_controllers_library/test/test_steering_odometry.cpp on `SteeringDrive` and `WheelOdometry`.

Upstream's one class of both is driven in its tests by wheel radius, wheelbase and one track width.
"""

from math import pi

from drake_twin.control.drive_kinematics import SteeringDrive
from drake_twin.control.wheel_odometry import WheelOdometry
from upstream.suite import Suite, above, below, near, refuses

ASSERTIONS = 90
SUITE = Suite("steering_controllers_library/test/test_steering_odometry.cpp")


def bicycle(radius, wheelbase, track):
    return SteeringDrive(wheelbase, radius)


def tricycle(radius, wheelbase, track):
    return SteeringDrive(wheelbase, radius, driven=2, driven_track=track)


def ackermann(radius, wheelbase, track):
    return SteeringDrive(wheelbase, radius, driven=2, steered=2, driven_track=track, steered_track=track)


def commands(kind, linear, angular, measured=None, *, slow=False):
    drive = kind(1.0, 2.0, 1.0)
    return drive.wheel_commands(linear, drive.steering_angle(linear, angular), measured, slow_while_steering=slow)


@SUITE.scenario({24: False, 29: 0.0, 30: 0.0, 31: 0.0})
def odometry_begins_at_the_origin():
    yield 24, refuses(WheelOdometry, Exception)
    odometry = WheelOdometry()
    yield 29, odometry.heading
    yield 30, odometry.x
    yield 31, odometry.y


ODOMETRY = (
    (41, ackermann, (1.0, 1.0), (0.1, 0.1)),
    (277, bicycle, (1.0,), (0.1,)),
    (376, tricycle, (1.0, 1.0), (0.1,)),
)


@SUITE.scenario(
    {
        line + more: value
        for line, kind, *_ in ODOMETRY
        for more, value in enumerate(
            (True, near(1.0 if kind is bicycle else 1.002, 1e-3), near(0.1, 1e-3), near(0.1, 1e-3), near(0.01, 1e-3))
        )
    }
)
def odometry_of_measured_wheels():
    for line, kind, speeds, angles in ODOMETRY:
        drive, start = kind(1.0, 1.0, 1.0), WheelOdometry()
        odometry = start.moved(*drive.base_velocity(speeds, drive.mean_steering_angle(angles)), 0.1)
        yield line, odometry is not start
        yield line + 1, odometry.linear_x
        yield line + 2, odometry.angular_z
        yield line + 3, odometry.x
        yield line + 4, odometry.heading


@SUITE.scenario(
    {54: 2.0, 55: 1.0, 56: 0.0}
    | {65: 1.0, 66: 1.0, 68: above(0.0), 69: above(0.0)}
    | {78: 1.0, 79: -1.0, 80: above(0.0), 81: below(0.0)}
)
def odometry_of_commands():
    ahead = WheelOdometry().moved_open_loop(2.0, 0.0, 0.5)
    yield 54, ahead.linear_x
    yield 55, ahead.x
    yield 56, ahead.y
    for turn, lines in ((1.0, (65, 66, 68, 69)), (-1.0, (78, 79, 80, 81))):
        turned = WheelOdometry().moved_open_loop(1.0, turn, 1.0)
        yield from zip(lines, (turned.linear_x, turned.angular_z, turned.x, turned.y), strict=True)


@SUITE.scenario({92: True, 93: above(0.0), 95: True, 96: 0.0, 185: 1.0, 187: 0.0, 294: True, 295: above(0.0), 297: 0.0})
def commands_straight_ahead():
    speeds, angles = commands(ackermann, 1.0, 0.0)
    yield 92, speeds[0] == speeds[1]
    yield 93, speeds[0]
    yield 95, angles[0] == angles[1]
    yield 96, angles[0]
    speeds, angles = commands(bicycle, 1.0, 0.0)
    yield 185, speeds[0]
    yield 187, angles[0]
    speeds, angles = commands(tricycle, 1.0, 0.0)
    yield 294, speeds[0] == speeds[1]
    yield 295, speeds[0]
    yield 297, angles[0]


# line of the first assertion, steering, measured angle, angular velocity, slower while steering; the speeds' lines
# come first, with a blank line before those of the angles. The right wheels come before the left ones.
OUTER_AND_INNER = (
    (107, ackermann, 0.2, 0.1, False),
    (122, ackermann, -0.2, -0.1, False),
    (139, ackermann, -0.785, -0.5, True),
    (151, ackermann, -0.1, -0.5, False),
    (162, ackermann, -0.1, -0.5, True),
    (308, tricycle, 0.2, 0.1, False),
    (322, tricycle, -0.2, -0.1, False),
    (338, tricycle, -0.785, -0.5, True),
    (349, tricycle, -0.1, -0.5, False),
    (359, tricycle, -0.1, -0.5, True),
)
AFTER_A_LOOP = 5  # lines from a speed's assertion to the steering's where a loop over the wheels stands between


def lines_of_angles(line):
    return line + 3 + (AFTER_A_LOOP if line in (162, 359) else 0)


@SUITE.scenario(
    {line: True for line, *_ in OUTER_AND_INNER}
    | {line + 1: above(0.0) for line, *_ in OUTER_AND_INNER}
    | {lines_of_angles(line): True for line, kind, *_ in OUTER_AND_INNER if kind is ackermann}
    | {
        lines_of_angles(line) + (kind is ackermann): above(0.0) if turn > 0.0 else below(0.0)
        for line, kind, _, turn, _ in OUTER_AND_INNER
    }
)
def the_outer_wheel_drives_faster_and_steers_less():
    for line, kind, measured, turn, slow in OUTER_AND_INNER:
        speeds, angles = commands(kind, 1.0, turn, measured, slow=slow)
        yield line, speeds[0] > speeds[1] if turn > 0.0 else speeds[0] < speeds[1]
        yield line + 1, speeds[0]
        steering = lines_of_angles(line)
        if kind is ackermann:
            yield steering, abs(angles[0]) < abs(angles[1]) if turn > 0.0 else abs(angles[0]) > abs(angles[1])
            steering += 1
        yield steering, angles[0]


@SUITE.scenario({167: True, 364: True, 250: True, 265: True})
def the_wheels_drive_slower_until_the_steering_is_reached():
    for line, kind in ((167, ackermann), (364, tricycle), (250, bicycle)):
        free, _ = commands(kind, 1.0, -0.5, -0.1)
        slowed, _ = commands(kind, 1.0, -0.5, -0.1, slow=True)
        yield line, all(a < b for a, b in zip(slowed, free, strict=True))
    further, _ = commands(bicycle, 1.0, -0.5, pi, slow=True)
    yield 265, further[0] < slowed[0]


BICYCLE = (  # line of the speed, line of the angle, measured angle, angular velocity, slower while steering, speed
    (198, 200, 0.2, 0.1, False, 1.0),
    (211, 213, -0.2, -0.1, False, 1.0),
    (226, 228, -0.785, -0.5, True, 1.0),
    (236, 238, -0.1, -0.5, False, 1.0),
    (246, 253, -0.1, -0.5, True, above(0.0)),
    (261, 268, pi, -0.5, True, above(0.0)),
)


@SUITE.scenario(
    {line: speed for line, *_, speed in BICYCLE}
    | {line: above(0.0) if turn > 0.0 else below(0.0) for _, line, _, turn, *_ in BICYCLE}
)
def a_bicycle_steers_to_the_side_of_its_command():
    for speed_line, angle_line, measured, turn, slow, _ in BICYCLE:
        (speed,), (angle,) = commands(bicycle, 1.0, turn, measured, slow=slow)
        yield speed_line, speed
        yield angle_line, angle


test_holds_against_upstream = SUITE.test()
