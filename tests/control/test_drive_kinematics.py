from math import atan, cos, hypot, pi, sin, tan

import numpy as np
import pytest

from drake_twin.control.drive_kinematics import (
    DifferentialDrive,
    MecanumDrive,
    OmniWheelDrive,
    SteeredDrivenWheel,
    SteeringDrive,
)

# Rigid-body kinematics: the velocity of a point (x, y) of a base with the velocity (vx, vy, w).


def point_velocity(vx, vy, w, x, y):
    return np.array([vx - w * y, vy + w * x])


@pytest.mark.parametrize("velocity", [(1.0, 0.0), (0.0, 1.0), (0.6, -2.0), (-0.3, 0.4)])
def test_the_sides_of_a_differential_drive_roll_as_their_points_of_the_base_move(velocity):
    linear, angular = velocity
    drive = DifferentialDrive(wheel_separation=0.5, left_radius=0.1, right_radius=0.11)
    left, right = drive.wheel_velocities(linear, angular)
    assert left * 0.1 == pytest.approx(point_velocity(linear, 0, angular, 0, 0.25)[0])
    assert right * 0.11 == pytest.approx(point_velocity(linear, 0, angular, 0, -0.25)[0])
    assert drive.base_velocity(left, right) == pytest.approx(velocity)


@pytest.mark.parametrize("offset", [(0.0, 0.0, 0.0), (0.1, -0.05, 0.4)])
def test_mecanum_wheels_roll_along_their_free_direction(offset):
    lx, ly, radius = 0.2, 0.3, 0.05
    drive = MecanumDrive(radius, lx + ly, offset)
    velocity = (0.4, -0.7, 0.9)
    # The velocity of the base frame, moved to the centre and turned into its axes.
    theta = offset[2]
    turn = np.array([[cos(theta), -sin(theta)], [sin(theta), cos(theta)]])
    center = point_velocity(*(turn @ velocity[:2]), velocity[2], -offset[0], -offset[1])
    for speed, (x, y), free in zip(
        drive.wheel_velocities(*velocity),
        [(lx, ly), (lx, -ly), (-lx, -ly), (-lx, ly)],
        [(1, 1), (1, -1), (1, 1), (1, -1)],
        strict=True,
    ):
        # What the roller on the ground leaves free is a motion along 45°; across it nothing may slip.
        slip = point_velocity(*center, velocity[2], x, y) - np.array([speed * radius, 0.0])
        assert slip @ np.array([free[1], -free[0]]) == pytest.approx(0.0, abs=1e-12)
    assert drive.base_velocity(*drive.wheel_velocities(*velocity)) == pytest.approx(velocity)


def test_ackermanns_wheels_all_stand_on_circles_about_one_point():
    base, driven_track, steered_track, radius = 1.7, 1.0, 0.8, 0.3
    drive = SteeringDrive(base, radius, 2, 2, driven_track, steered_track)
    linear, angular = 1.2, 0.5
    measured = drive.steering_angle(linear, angular)
    (right, left), (steer_right, steer_left) = drive.wheel_commands(linear, measured, measured)
    center = linear / angular  # on the driven axle, to the left
    assert measured == pytest.approx(atan(base / center))
    assert right * radius == pytest.approx(angular * (center + driven_track / 2))
    assert left * radius == pytest.approx(angular * (center - driven_track / 2))
    assert tan(steer_right) == pytest.approx(base / (center + steered_track / 2))
    assert tan(steer_left) == pytest.approx(base / (center - steered_track / 2))
    assert drive.mean_steering_angle((steer_right, steer_left)) == pytest.approx(measured)
    assert drive.base_velocity((right, left), measured) == pytest.approx((linear, angular))


def test_a_tricycle_and_a_bicycle_invert_their_commands():
    for drive in (SteeringDrive(0.4, 0.1, driven=2, driven_track=0.3), SteeringDrive(0.4, 0.1)):
        speeds, (angle,) = drive.wheel_commands(-0.8, drive.steering_angle(-0.8, 0.3))
        assert drive.base_velocity(speeds, angle) == pytest.approx((-0.8, 0.3))
        assert drive.mean_steering_angle((angle,)) == angle


def test_the_driven_wheels_follow_the_measured_angle_until_it_is_the_commanded_one():
    drive = SteeringDrive(0.4, 0.1, driven=2, driven_track=0.3)
    (right, left), (angle,) = drive.wheel_commands(1.0, 0.4, measured=0.0)
    assert right == left == pytest.approx(10.0)
    assert angle == 0.4


def test_steering_without_driving_turns_the_wheels_to_the_side():
    drive = SteeringDrive(0.4, 0.1)
    assert drive.steering_angle(0.0, 0.0) == 0.0
    assert drive.steering_angle(0.0, 0.7) == pytest.approx(pi / 2)
    assert drive.steering_angle(0.0, -0.7) == pytest.approx(-pi / 2)


def test_the_steering_angle_has_a_limit():
    drive = SteeringDrive(0.4, 0.1, largest_angle=0.3)
    assert drive.steering_angle(1.0, 0.1) == pytest.approx(atan(0.04))
    assert (drive.steering_angle(1.0, 9.0), drive.steering_angle(0.0, -1.0)) == (0.3, -0.3)


def test_wheels_turn_slower_while_the_angle_is_far_off():
    drive = SteeringDrive(0.4, 0.1)
    near = drive.wheel_commands(1.0, 0.4, -0.1, slow_while_steering=True)
    far = drive.wheel_commands(1.0, 0.4, -0.6, slow_while_steering=True)
    assert near[0][0] == pytest.approx(10.0)
    assert far[0][0] == pytest.approx(10.0 * cos(1.0) / cos(pi / 6))


def test_a_steered_driven_wheel_rolls_as_its_point_of_the_base_moves():
    drive = SteeredDrivenWheel(wheelbase=1.7, wheel_radius=0.3)
    speed, angle = drive.wheel_command(0.8, 0.5)
    along, across = point_velocity(0.8, 0.0, 0.5, 1.7, 0.0)
    assert speed * 0.3 == pytest.approx(hypot(along, across))
    assert tan(angle) == pytest.approx(across / along)
    assert drive.base_velocity(speed, angle) == pytest.approx((0.8, 0.5))


def test_a_steered_driven_wheel_turns_the_base_on_the_spot():
    drive = SteeredDrivenWheel(wheelbase=1.7, wheel_radius=0.3)
    for angular, angle in ((-0.6, -pi / 2), (0.6, pi / 2)):
        assert drive.wheel_command(0.0, angular) == pytest.approx((0.6 * 1.7 / 0.3, angle))
    assert drive.base_velocity(*drive.wheel_command(0.0, -0.6)) == pytest.approx((0.0, -0.6))


@pytest.mark.parametrize(("count", "offset"), [(3, 0.0), (3, 1.0), (4, 0.7), (7, -2.0)])
def test_omni_wheels_roll_along_their_driven_direction(count, offset):
    radius, distance = 0.05, 0.3
    drive = OmniWheelDrive(radius, distance, count, offset)
    velocity = (0.4, -0.7, 0.9)
    for index, speed in enumerate(drive.wheel_velocities(*velocity)):
        angle = offset + 2 * pi * index / count
        rolls = np.array([sin(angle), -cos(angle)])  # clockwise about the base for a positive velocity
        at_wheel = point_velocity(*velocity, distance * cos(angle), distance * sin(angle))
        assert speed * radius == pytest.approx(at_wheel @ rolls)
    assert drive.base_velocity(*drive.wheel_velocities(*velocity)) == pytest.approx(velocity)


def test_omni_wheels_that_slip_give_the_least_squares_solution():
    """As odometry.cpp:98 of omni_wheel_drive_controller, which solves it by a singular value decomposition."""
    drive, wheels = OmniWheelDrive(0.05, 0.3, 5, 0.2), np.array([1.0, -2.0, 0.5, 3.0, 4.0])
    angles = 0.2 + 2 * pi * np.arange(5) / 5
    matrix = np.column_stack([np.sin(angles), -np.cos(angles), np.full(5, -0.3)])
    assert drive.base_velocity(*wheels) == pytest.approx(np.linalg.lstsq(matrix, 0.05 * wheels, rcond=None)[0])
