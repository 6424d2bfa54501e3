"""gz-sim's Thruster beside mechanics: thrust, speeds of the propeller, and the vehicle's speed in water."""

from math import exp, sqrt, tanh

import numpy as np
import pytest
from waters import WATER, hydrodynamics, propelled, thruster, twin_of

from drake_twin.messages.interface_types import make
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay

STEPS = (0.001, 0.01)
SIZE = (1.0, 0.4, 0.3)
MASS = 0.12 * WATER + 0.1
SCALE = 1000.0 * 0.02 * 0.1**4  # N·s², of a propeller without other values
CMD = "/auv/joint/shaft/cmd_thrust"


@pytest.fixture(params=STEPS, ids="{:g} s".format)
def step(request):
    return request.param


def vehicle(folder, step, *plugins, **more):
    """A box with a propeller where nothing falls."""
    text = propelled(SIZE, *plugins, **more)
    return twin_of(folder, "<gravity>0 0 0</gravity>", step, {"auv": (text, (0, 0, 0))})


def number(value):
    return make("std_msgs/msg/Float64", {"data": value})


def velocity(twin):
    return np.array(twin.entities.state("auv").linear)


def shaft(twin):
    """The speed of the propeller."""
    return twin.robot_state("auv").velocities[0]


@pytest.mark.parametrize("thrust", [12.0, -7.0])
def test_a_thrust_moves_the_vehicle_and_turns_the_propeller_as_it_needs(tmp_path, step, thrust):
    twin = vehicle(tmp_path, step, thruster(velocity_control="true"))
    twin.publish(CMD, number(thrust))
    twin.advance_to(1.0)
    assert velocity(twin) == pytest.approx((thrust / MASS, 0, 0), rel=1e-3, abs=1e-6)
    assert shaft(twin) == pytest.approx(np.sign(thrust) * sqrt(abs(thrust) / SCALE), rel=1e-3)


def test_a_speed_of_the_propeller_has_its_thrust(tmp_path, step):
    twin = vehicle(tmp_path, step, thruster(use_angvel_cmd=1, velocity_control=1))
    twin.publish("/auv/joint/shaft/cmd_vel", number(-70.0))
    twin.advance_to(1.0)
    assert velocity(twin)[0] == pytest.approx(-SCALE * 70.0**2 / MASS, rel=1e-3)
    assert shaft(twin) == pytest.approx(-70.0, rel=1e-3)


def test_a_propeller_of_the_other_hand_turns_the_other_way(tmp_path):
    twin = vehicle(tmp_path, 0.001, thruster(thrust_coefficient=-0.02, velocity_control=1))
    twin.publish(CMD, number(5.0))
    twin.advance_to(0.2)
    assert velocity(twin)[0] == pytest.approx(0.2 * 5.0 / MASS, rel=1e-3)
    assert shaft(twin) == pytest.approx(-sqrt(5.0 / SCALE), rel=1e-3)


@pytest.mark.parametrize(("damping", "thrust"), [(20.0, 80.0), (20e3, 1000.0)])
def test_it_comes_to_the_speed_at_which_damping_is_as_large(tmp_path, step, damping, thrust):
    """(m + mₐ) v' = T - D v²: v = s tanh(D s t / (m + mₐ)), s² = T / D."""
    twin = vehicle(tmp_path, step, hydrodynamics(xUabsU=-damping, xDotU=-50), thruster(velocity_control=1))
    twin.publish(CMD, number(thrust))
    twin.advance_to(1.5)
    steady = sqrt(thrust / damping)
    assert velocity(twin)[0] == pytest.approx(steady * tanh(damping * steady * 1.5 / (MASS + 50)), rel=2e-3)


def test_a_thruster_beside_the_middle_turns_the_vehicle_and_its_water(tmp_path, step):
    """Without linear motion of the water: α = T y / (I + Iₐ) about the center of mass of both bodies."""
    side, added = 0.15, 20.0
    twin = vehicle(tmp_path, step, hydrodynamics(nDotR=-added), thruster(velocity_control=1), side=side)
    twin.publish(CMD, number(3.0))
    twin.advance_to(0.5)
    inertia = 120.0 / 12 * (SIZE[0] ** 2 + SIZE[1] ** 2) + 0.1 * (0.5**2 + side**2)
    assert twin.entities.state("auv").angular[2] == pytest.approx(-0.5 * 3.0 * side / (inertia + added), rel=0.01)
    assert velocity(twin)[0] == pytest.approx(0.5 * 3.0 / MASS, rel=0.01)


def test_without_velocity_control_a_proportional_controller_turns_the_propeller(tmp_path, step):
    twin = vehicle(tmp_path, step, thruster(p_gain=0.1), inertia=0.02)
    twin.publish(CMD, number(12.0))
    twin.advance_to(0.3)
    assert velocity(twin)[0] == pytest.approx(0.3 * 12.0 / MASS, rel=1e-3)  # the thrust is there at once
    hull = 120.0 / 12 * (SIZE[1] ** 2 + SIZE[2] ** 2)
    lag = 1 / (1 / 0.02 + 1 / hull) / 0.1
    # The implicit servo of a step of 10 ms is late by half a step.
    assert shaft(twin) == pytest.approx(sqrt(12.0 / SCALE) * (1 - exp(-0.3 / lag)), rel=0.01 if step < 0.01 else 0.03)


def test_the_coefficient_follows_the_velocity(tmp_path):
    """T = ρ D⁴ (α₁ ω² + α₂ (1 - w) V ω / D)."""
    own = thruster(thrust_coefficient=None, alpha_1=0.02, alpha_2=0.01, wake_fraction=0.4, velocity_control=1)
    twin = vehicle(tmp_path, 0.001, own)
    twin.publish(CMD, number(10.0))
    twin.entities.set_state("auv", linear=(0.0, 2.0, 0.0))
    twin.advance_to(0.3)
    speed, (x, y, _) = shaft(twin), velocity(twin)
    assert y == pytest.approx(2.0, rel=1e-3)
    thrust = 1000.0 * 0.1**4 * (0.02 * speed**2 + 0.01 * 0.6 * np.hypot(x, y) * speed / 0.1)
    assert thrust == pytest.approx(10.0, rel=1e-3)


def test_topics_tell_the_speed_or_the_thrust(tmp_path):
    heard = []
    speed = sqrt(4.5 / SCALE)
    for of_speed, topic, asked, told in ((0, "ang_vel", 4.5, speed), (1, "force", speed, 4.5)):
        twin = vehicle(tmp_path, 0.001, thruster(use_angvel_cmd=of_speed, velocity_control=1, topic="left"))
        twin.subscribe(f"/auv/left/{topic}", lambda message: heard.append(message.data))
        twin.publish("/auv/left", number(asked))
        twin.advance_to(0.1)
        assert heard[-1] == pytest.approx(told)


def test_a_replay_and_a_restored_twin_repeat_the_motion_to_the_last_bit(tmp_path):
    twin = vehicle(tmp_path, 0.01, hydrodynamics(xUabsU=-20, yDotV=-60, nR=-3), thruster(deadband=1.0), side=0.1)
    twin.recorder.begin()
    twin.publish(CMD, number(8.0))
    twin.advance_to(0.5)
    snapshot = twin.snapshot()
    twin.publish(CMD, number(-3.0))
    twin.publish("/auv/joint/shaft/enable_deadband", make("std_msgs/msg/Bool", {"data": False}))
    twin.advance_to(1.0)
    end = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == end
    twin.restore(snapshot)
    twin.advance_to(1.0)
    first = twin.state_sha256()
    twin.restore(snapshot)
    twin.advance_to(1.0)
    assert twin.state_sha256() == first != end
