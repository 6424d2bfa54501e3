"""Wheels roll without slip and turn a base at the rate of its kinematics, however their cylinders are written."""

from math import atan, atan2, cos, radians, sin

import numpy as np
import pytest
from bases import BASE, RADIUS, TRACK, four_wheels, two_wheels
from scenes import G, Scene, every_engine, on_slope, plane, position, static_box, static_mesh

COMMANDS = "/base/forward_velocity_controller/commands"
SPEED = 3.0  # rad/s


def yaw(twin, name="base"):
    w, x, y, z = twin.entities.state(name).orientation
    return atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def drive(folder, engine, urdf, command, floor=None):
    twin = Scene(folder, engine, floor).add("base", urdf, (0, 0, RADIUS)).build()
    twin.advance_to(0.5)
    twin.publish(COMMANDS, command)
    twin.advance_to(1.0)
    return twin


def turning_rate(twin, seconds=2.0):
    turned, last, start = 0.0, yaw(twin), twin.time
    while twin.time < start + seconds - 1e-9:
        twin.advance_to(twin.time + 0.1)
        now = yaw(twin)
        turned += (now - last + np.pi) % (2 * np.pi) - np.pi
        last = now
    return turned / (twin.time - start)


def forward(sign):
    """Wheels rolled by +90° turn forwards with a negative command, those rolled by -90° with a positive one."""
    return -SPEED if sign == "+" else SPEED


@every_engine
@pytest.mark.parametrize("roll", ["1.57", "1.5708", "-1.57", "-1.5708", "1.5707963267948966"])
@pytest.mark.parametrize("width", [0.02, 0.05, 0.08, 0.1])
def test_a_base_turns_in_place_at_the_rate_of_its_kinematics(figure, tmp_path, engine, roll, width):
    twin = drive(tmp_path, engine, two_wheels(roll=roll, width=width), [SPEED, -SPEED])
    rate = abs(turning_rate(twin)) / (SPEED * RADIUS / (TRACK / 2))
    assert figure("turns in place: rate ÷ kinematic", rate) == pytest.approx(0.99, abs=0.02)


@every_engine
@pytest.mark.parametrize("ground", ["plane", "box", "mesh"])
def test_a_base_turns_alike_on_any_ground(figure, tmp_path, engine, ground):
    floor = {"plane": plane, "box": static_box, "mesh": lambda: static_mesh(tmp_path / "terrain.obj")}[ground]()
    twin = drive(tmp_path, engine, two_wheels(), [SPEED, -SPEED], floor)
    rate = abs(turning_rate(twin)) / (SPEED * RADIUS / (TRACK / 2))
    assert figure("turns in place: rate ÷ kinematic", rate) == pytest.approx(0.99, abs=0.02)


@every_engine
@pytest.mark.parametrize("roll", ["1.57", "-1.5708", "1.5707963267948966"])
def test_wheels_roll_without_slip(figure, tmp_path, engine, roll):
    twin = drive(tmp_path, engine, two_wheels(roll=roll), [SPEED, SPEED])
    x, start = position(twin, "base"), twin.time
    twin.advance_to(start + 3.0)
    way = np.linalg.norm(position(twin, "base") - x)
    rolled = figure("rolls: way ÷ angle r", way / (SPEED * RADIUS * 3.0))
    assert rolled == pytest.approx(1.0, abs=1e-3)


@every_engine
def test_four_wheels_that_do_not_steer_skid_as_coulomb_friction_has_it(figure, tmp_path, engine):
    left, right = SPEED, -SPEED
    twin = drive(tmp_path, engine, four_wheels(), [left, right, left, right])
    rate = abs(turning_rate(twin)) / (SPEED * RADIUS / (TRACK / 2))
    # Each wheel slides along the force that brakes it; the torques about the centre balance: b² / (a² + b²).
    skid = figure("skid steer: rate ÷ b²/(a² + b²)", rate / (TRACK**2 / (BASE**2 + TRACK**2)))
    assert skid == pytest.approx(1.0, abs=0.02)


@pytest.mark.parametrize("engine", ["1ms", "cenic"])
@pytest.mark.parametrize(("degrees", "friction"), [(0, 0.05), (0, 0.1), (0, 0.2), (41.5, 0.9), (42.5, 0.9)])
def test_wheels_that_spin_push_with_friction_times_weight(figure, tmp_path, engine, degrees, friction):
    """On level ground and up a slope, on either side of the angle of friction, which is 41.99° for 0.9."""
    tilt = radians(degrees)
    scene = Scene(tmp_path, engine, plane(tilt, friction))
    twin = scene.add("base", four_wheels(), on_slope(tilt, z=RADIUS), (0, tilt, 0)).build()
    twin.publish(COMMANDS, [45.0] * 4)  # backwards, which is up
    twin.advance_to(0.4)
    speeds = [twin.entities.state("base").linear @ np.array([-cos(tilt), 0.0, sin(tilt)])]
    twin.advance_to(1.4)
    speeds.append(twin.entities.state("base").linear @ np.array([-cos(tilt), 0.0, sin(tilt)]))
    expected = G * (friction * cos(tilt) - sin(tilt))
    found = figure(f"spinning wheels at {degrees}°, µ {friction}: acceleration (m/s²)", speeds[1] - speeds[0])
    assert found == pytest.approx(expected, abs=0.01 * G * friction)
    assert (found > 0) == (tilt < atan(friction))
