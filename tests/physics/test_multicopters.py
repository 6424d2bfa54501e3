"""Quadcopters of gz-sim's systems beside mechanics: rotors with a lag, drag, moments, velocities that are followed."""

from math import exp, hypot

import numpy as np
import pytest
from multicopters import DOWN, DRAG, HOVER, INERTIA, MASS, MOMENT, ROTORS, UP, G, quadcopter, speeds

from drake_twin import TwinBuilder
from drake_twin.errors import CommandError
from drake_twin.messages.interface_types import make

STEPS = (0.001, 0.004, 0.01)
SPEEDS = "/uav/command/motor_speed"


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def flying(folder, step, height=50.0, **more):
    file = folder / "x3.sdf"
    file.write_text(quadcopter(**more))
    return TwinBuilder(time_step=step).robot("uav", file, xyz=(0, 0, height)).build()


def place(twin):
    return np.array(twin.robot_state("uav").base_pose[:3])


def velocity(twin, over=0.1):
    """The mean velocity over a span (m/s)."""
    before = place(twin)
    twin.advance_to(round(twin.time + over, 9))
    return (place(twin) - before) / over


def moved(twin, **motion):
    twin.entities.set_state("uav", **motion)


def fallen(time, lag=UP):
    """How far it falls while the thrust rises to its weight, with speeds that follow exp(-t/lag) (m)."""
    e = exp(-time / lag)
    # The missing part of the weight is 1 - (1 - e)² = 2 e - e².
    return G * (lag * (2 * time - time / 2) - lag**2 * (2 * (1 - e) - (1 - e * e) / 4))


def test_it_hovers_at_its_closed_form_speed_once_the_rotors_have_it(tmp_path, step):
    twin = flying(tmp_path, step)
    twin.publish(SPEEDS, speeds(*[HOVER] * 4))
    twin.advance_to(2.0)
    assert 50.0 - place(twin)[2] == pytest.approx(fallen(2.0), rel=0.01)
    assert place(twin)[:2] == pytest.approx((0, 0), abs=1e-9)
    turned = (HOVER / 10, HOVER / 10, -HOVER / 10, -HOVER / 10)
    assert twin.robot_state("uav").velocities == pytest.approx(turned, rel=1e-4)


def test_speeds_fall_with_the_other_lag(tmp_path, step):
    """From full thrust the rotors are stopped: the impulse that is left is K ω² DOWN / 2 of each."""
    twin = flying(tmp_path, step)
    twin.publish(SPEEDS, speeds(*[HOVER] * 4))
    twin.advance_to(1.0)
    before = velocity(twin)[2]
    twin.publish(SPEEDS, speeds(0, 0, 0, 0))
    twin.advance_to(round(twin.time + 0.5, 9))
    after = velocity(twin)[2]
    assert after - before == pytest.approx(G * DOWN / 2 - G * (0.55 + step / 2), rel=0.01)


@pytest.mark.parametrize("factor", [0.0, 0.9, 1.1])
def test_it_climbs_and_falls_with_the_square_of_the_speed(tmp_path, step, factor):
    twin = flying(tmp_path, step)
    twin.publish(SPEEDS, speeds(*[factor * HOVER] * 4))
    twin.advance_to(1.0)
    first = velocity(twin)[2]
    twin.advance_to(2.0)
    assert velocity(twin)[2] - first == pytest.approx((factor**2 - 1) * G, rel=0.01)


def test_a_speed_is_at_most_the_largest_one(tmp_path):
    twin = flying(tmp_path, 0.01, maxRotVelocity=HOVER)
    twin.publish(SPEEDS, speeds(*[5000.0] * 4))
    twin.advance_to(2.0)
    assert 50.0 - place(twin)[2] == pytest.approx(fallen(2.0), rel=0.01)


def test_drag_brakes_a_drift_across_the_axes(tmp_path, step):
    """v' = -4 c ω v / m, and the base's tilt that the drag's lever brings is small for the first half second."""
    twin = flying(tmp_path, step, rollingMomentCoefficient=0.0)
    twin.publish(SPEEDS, speeds(*[HOVER] * 4))
    twin.advance_to(0.5)
    moved(twin, linear=(2.0, -1.0, 0.0))
    begin = place(twin)
    twin.advance_to(0.8)
    rate = 4 * DRAG * HOVER / MASS
    travelled = hypot(*(place(twin) - begin)[:2])
    assert travelled == pytest.approx(hypot(2, 1) * (1 - exp(-0.3 * rate)) / rate, rel=0.01)


def test_opposite_speeds_turn_it_about_its_axis(tmp_path, step):
    """Two rotors turn faster, the two that turn the other way slower, with the same thrust."""
    twin = flying(tmp_path, step, rotorDragCoefficient=0.0)
    twin.publish(SPEEDS, speeds(*[HOVER] * 4))
    twin.advance_to(0.48)
    twin.publish(SPEEDS, speeds(*[HOVER * 0.98**0.5] * 2, *[HOVER * 1.02**0.5] * 2))
    twin.advance_to(0.8)
    before = turn_rate(twin)  # of 0.82 s
    twin.advance_to(1.2)
    moment = 0.04 * MASS * G / 2 * MOMENT  # of the rotors that turn clockwise more, which push it counter-clockwise
    arms = [x * x + y * y for _, x, y in ROTORS]
    about = INERTIA[2] + 4 * 4e-5 + 0.005 * sum(arms)
    assert (turn_rate(twin) - before) / 0.4 == pytest.approx(moment / about, rel=0.01)


def turn_rate(twin):
    """The mean angular velocity over 0.04 s (rad/s)."""
    before = yaw(twin)
    twin.advance_to(round(twin.time + 0.04, 9))
    return (yaw(twin) - before) / 0.04


def yaw(twin):
    w, x, y, z = twin.robot_state("uav").base_pose[3:]
    return np.arctan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def twist(x=0.0, y=0.0, z=0.0, yaw_rate=0.0):
    return make("geometry_msgs/msg/Twist", {"linear": {"x": x, "y": y, "z": z}, "angular": {"z": yaw_rate}})


def test_a_velocity_of_the_climb_is_followed_with_the_time_constant_of_the_gain(tmp_path, step):
    """m v' = gain (wanted - v): what is missing of the way is the time constant times the change of the velocity.

    Thrust that rises faster than it falls saves the difference of the two lags, and the way of a step is that of the
    velocity at its end.
    """
    twin = flying(tmp_path, step, controlled=True)
    twin.publish("/uav/command/twist", twist(z=0.4))
    twin.advance_to(6.0)
    assert velocity(twin)[2] == pytest.approx(0.4, rel=0.01)
    twin.publish("/uav/command/twist", twist(z=0.8))
    begin = place(twin)[2]
    twin.advance_to(12.1)
    missing = 0.8 * 6.0 - (place(twin)[2] - begin)
    assert velocity(twin)[2] == pytest.approx(0.8, rel=0.01)
    assert missing / 0.4 == pytest.approx(MASS / 2.7 - (DOWN - UP) - step / 2, rel=0.01)


def test_a_turn_is_followed_but_for_what_the_drag_of_the_rotors_takes(tmp_path, step):
    """The gain's moment for the error is that of the drag at the rotors' arms."""
    twin = flying(tmp_path, step, controlled=True)
    twin.publish("/uav/command/twist", twist(yaw_rate=0.3))
    twin.advance_to(4.0)
    drag = DRAG * HOVER * sum(x * x + y * y for _, x, y in ROTORS)
    assert turn_rate(twin) == pytest.approx(0.3 * 0.18 / (0.18 + drag), rel=0.01)


def test_rotors_that_turn_the_body_as_they_speed_up_do_so_with_their_lag(tmp_path, step):
    """Were a joint at once at its target, the body would answer by more than what the control wants to correct."""
    twin = flying(tmp_path, step, controlled=True, spin_inertia=1.5e-4, rotorVelocitySlowdownSim=1)
    twin.publish("/uav/command/twist", twist(yaw_rate=0.3))
    twin.advance_to(10.0)
    drag = DRAG * HOVER * sum(x * x + y * y for _, x, y in ROTORS)
    rates = [turn_rate(twin) for _ in range(5)]
    assert rates == pytest.approx([0.3 * 0.18 / (0.18 + drag)] * 5, rel=0.015)


def test_nothing_flies_before_a_command_and_after_it_is_switched_off(tmp_path):
    twin = flying(tmp_path, 0.01, controlled=True)
    twin.advance_to(0.5)
    assert 50 - place(twin)[2] == pytest.approx(G * 0.5 * 0.51 / 2, rel=1e-6)
    twin.publish("/uav/command/twist", twist())
    twin.advance_to(4.0)
    assert abs(velocity(twin)[2]) < 0.1
    twin.publish("/uav/enable", make("std_msgs/msg/Bool", {"data": False}))
    twin.advance_to(4.5)
    falling = velocity(twin)[2]
    twin.publish("/uav/enable", make("std_msgs/msg/Bool", {"data": True}))  # it waits for the next velocity
    twin.advance_to(5.5)
    assert velocity(twin)[2] - falling == pytest.approx(-G, rel=0.1)
    twin.publish("/uav/command/twist", twist())
    twin.advance_to(14.0)
    assert abs(velocity(twin)[2]) < 0.1


def test_rotors_turn_as_fast_as_the_control_of_the_velocity_asks_and_stop_when_it_ends(tmp_path, step):
    twin = flying(tmp_path, step, controlled=True, rotorVelocitySlowdownSim=1)
    twin.publish("/uav/command/twist", twist())
    twin.advance_to(1.0)
    assert np.abs(twin.robot_state("uav").velocities) == pytest.approx(HOVER, rel=0.01)
    twin.publish("/uav/enable", make("std_msgs/msg/Bool", {"data": False}))
    twin.advance_to(2.0)
    assert twin.robot_state("uav").velocities == pytest.approx((0.0,) * 4, abs=1e-3)


def test_a_flight_repeats_to_the_bit_and_goes_on_from_a_snapshot(tmp_path):
    def flown(twin, until):
        twin.publish("/uav/command/twist", twist(1.0, 0.5, 0.2, 0.3))
        twin.advance_to(until)
        return twin.state_sha256()

    twin = flying(tmp_path, 0.01, controlled=True)
    flown(twin, 1.003)
    saved = twin.snapshot()
    end = flown(twin, 2.0)
    twin.restore(saved)
    assert flown(twin, 2.0) == end
    other = flying(tmp_path, 0.01, controlled=True)
    flown(other, 1.003)
    assert flown(other, 2.0) == end


def test_a_message_with_too_few_speeds_is_refused(tmp_path):
    twin = flying(tmp_path, 0.01)
    with pytest.raises(CommandError, match="velocity has 3 numbers, and a rotor reads number 3"):
        twin.publish(SPEEDS, speeds(1, 2, 3))
