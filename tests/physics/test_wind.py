"""The wind of a world file, as rotors, wings and aircraft feel it."""

from dataclasses import replace

import numpy as np
import pytest
from flyers import RHO, STEPS, flyer, plugin
from multicopters import DRAG, HOVER, MASS, G, quadcopter, speeds

from drake_twin import TwinBuilder
from drake_twin.scenario import World


def windy(folder, velocity, gravity=0.0):
    wind = f"<wind><linear_velocity>{' '.join(map(str, velocity))}</linear_velocity></wind>"
    body = f"<world name='w'><gravity>0 0 {-gravity}</gravity>{wind}</world>"
    (folder / "w.sdf").write_text(f"<sdf version='1.9'>{body}</sdf>")
    return World(file=str(folder / "w.sdf"))


def velocity(twin, robot):
    return np.array(twin.entities.state(robot).linear)


@STEPS
def test_a_hovering_quadcopter_is_blown_by_the_drag_of_its_rotors_until_it_drifts_with_the_wind(tmp_path, time_step):
    wind = (3.0, -1.0, 0.0)
    (tmp_path / "x3.sdf").write_text(quadcopter(rollingMomentCoefficient=0.0))
    builder = TwinBuilder(world=windy(tmp_path, wind, G), time_step=time_step)
    twin = builder.robot("uav", tmp_path / "x3.sdf", xyz=(0, 0, 50)).build()
    twin.publish("/uav/command/motor_speed", speeds(*[HOVER] * 4))
    twin.advance_to(0.4)
    upright = {"orientation": (1.0, 0.0, 0.0, 0.0), "angular": (0.0, 0.0, 0.0)}
    twin.entities.set_state("uav", linear=(0.0, 0.0, 0.0), **upright)
    twin.advance_to(0.4 + time_step)
    # m v' = 4 c ω (w - v), of a whole quadcopter that also begins to tilt; its center of mass is near its origin.
    blown = 4 * DRAG * HOVER * np.array(wind) / MASS
    assert velocity(twin, "uav") / time_step == pytest.approx(blown, rel=0.01, abs=0.01 * blown[0])
    twin.entities.set_state("uav", linear=wind, **upright)
    twin.advance_to(1.4)
    assert velocity(twin, "uav") == pytest.approx(wind, abs=1e-4)


@STEPS
def test_a_wing_at_rest_has_the_lift_and_the_drag_of_its_flow(tmp_path, time_step):
    wing = {"a0": 0.05, "cla": 3.0, "cda": 0.4, "area": 0.6}
    world = windy(tmp_path, (-12.0, 0.0, 0.0))
    twin = flyer(tmp_path, plugin("LiftDrag", wing), world=world, time_step=time_step)
    twin.advance_to(time_step)
    size = 0.5 * RHO * 144 * 0.6 * 0.05 / 2.0
    assert velocity(twin, "flyer") / time_step == pytest.approx((-0.4 * size, 0.0, 3.0 * size), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize(("given", "speed"), [(None, 12.0), ((-6.0, 0.0, 0.0), 6.0), ((0.0, 0.0, 0.0), 0.0)])
def test_a_scenarios_wind_replaces_the_files(tmp_path, given, speed):
    wing = {"a0": 0.05, "cla": 3.0, "cda": 0.0, "area": 0.6}
    world = replace(windy(tmp_path, (-12.0, 0.0, 0.0)), wind=given)
    twin = flyer(tmp_path, plugin("LiftDrag", wing), world=world)
    twin.advance_to(0.01)
    assert velocity(twin, "flyer")[2] == pytest.approx(0.01 * 0.5 * RHO * speed**2 * 0.6 * 0.15 / 2.0)


def test_a_scenario_without_a_file_has_a_wind(tmp_path):
    wing = {"a0": 0.05, "cla": 3.0, "cda": 0.0, "area": 0.6}
    twin = flyer(tmp_path, plugin("LiftDrag", wing), world=World(gravity=(0.0, 0.0, 0.0), wind=(-12.0, 0.0, 0.0)))
    twin.advance_to(0.01)
    assert velocity(twin, "flyer")[2] == pytest.approx(0.01 * 0.5 * RHO * 144 * 0.6 * 0.15 / 2.0)


@STEPS
def test_drag_takes_a_body_along(tmp_path, time_step):
    """The speed u of the flow follows u' = -k u², so that u = w / (1 + k w t)."""
    brake = {"a0": 0.5, "cla": 0.0, "cda": 0.8, "area": 0.5}
    twin = flyer(tmp_path, plugin("LiftDrag", brake), world=windy(tmp_path, (-8.0, 0.0, 0.0)), time_step=time_step)
    k = 0.5 * RHO * 0.5 * 0.8 * 0.5 / 2.0
    for time in (0.5, 2.0):
        twin.advance_to(time)
        flow = 8.0 + velocity(twin, "flyer")[0]
        assert flow == pytest.approx(8.0 / (1 + k * 8.0 * time), rel=0.01)


@STEPS
def test_an_aircraft_at_rest_in_a_wind_from_the_side_has_its_side_force(tmp_path, time_step):
    values = {"AR": 5, "eff": 1, "area": 0.6, "CYb": -0.3}
    world = windy(tmp_path, (-10.0, 2.0, 0.0))  # from the front and from its right
    twin = flyer(tmp_path, plugin("AdvancedLiftDrag", values), world=world, time_step=time_step)
    twin.advance_to(time_step)
    slip = np.arctan2(2.0, 10.0)
    side = 0.5 * RHO * 100 * 0.6 * 0.3 * slip / 2.0  # to the left, which is +y
    assert velocity(twin, "flyer")[1] / time_step == pytest.approx(side, rel=1e-6)
