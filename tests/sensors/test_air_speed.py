"""Air speed sensors against Bernoulli's ½ ρ v² in the standard atmosphere, and in a wind."""

import numpy as np
import pytest
from rig import on_box, twin_with
from winds import effects

TOPIC = "/box/s/air_speed"
SEA = 1.225  # kg/m³


def pressure(twin):
    return twin.latest(TOPIC).fluid_pressure


# The standard atmosphere of 1976, table I: geometric altitude (m), density (kg/m³).
@pytest.mark.parametrize(("altitude", "density"), [(0, 1.2250), (1000, 1.1117), (3000, 0.90925), (8000, 0.52579)])
def test_the_pressure_is_that_of_the_speed_in_the_standard_atmosphere(tmp_path, altitude, density):
    twin = twin_with(tmp_path, on_box("air_speed"), xyz=(0, 0, altitude))
    twin.entities.set_state("box", linear=(20.0, 5.0, -3.0))
    assert pressure(twin) == pytest.approx(0.5 * density * 20**2, rel=2e-3)
    twin.entities.set_state("box", linear=(-20.0, 5.0, -3.0))
    assert pressure(twin) == pytest.approx(-0.5 * density * 20**2, rel=2e-3)


def test_it_measures_along_its_own_x_axis_where_it_is_on_a_turning_link(tmp_path):
    """A sensor that looks to the left, 0.5 m in front of the middle: 2 m/s sideways and 3 rad/s make 3.5 m/s."""
    twin = twin_with(tmp_path, on_box("air_speed", "<pose>0.5 0 0 0 0 1.5707963267948966</pose>"), xyz=(0, 0, 0))
    half = np.sqrt(0.5)
    twin.entities.set_state("box", linear=(-2.0, 9.0, 0.0), angular=(0, 0, 3.0), orientation=(half, 0, 0, half))
    assert pressure(twin) == pytest.approx(0.5 * SEA * 3.5**2)


def test_a_steady_wind_counts_as_the_way_does(tmp_path):
    wind = "<wind><linear_velocity>-8 3 0</linear_velocity></wind>"
    twin = twin_with(tmp_path, on_box("air_speed"), world=wind, xyz=(0, 0, 0))
    twin.entities.set_state("box", linear=(4.0, 0.0, 0.0))
    assert pressure(twin) == pytest.approx(0.5 * SEA * 12**2)


def test_a_wind_that_rises_is_measured_as_it_is(tmp_path):
    wind = f"<wind><linear_velocity>-8 0 0</linear_velocity></wind>{effects(rise=0.5)}"
    twin = twin_with(tmp_path, on_box("air_speed"), world=wind)
    assert pressure(twin) == 0.0
    twin.advance_to(0.5)
    assert pressure(twin) == pytest.approx(0.5 * SEA * (8 * (1 - np.exp(-1))) ** 2, rel=1e-4)


def test_the_noise_is_in_hectopascals(tmp_path):
    noise = "<noise type='gaussian'><mean>0.2</mean><stddev>0.5</stddev></noise>"
    twin = twin_with(
        tmp_path, on_box("air_speed", f"<air_speed><pressure>{noise}</pressure></air_speed>"), time_step=0.01
    )
    found = []
    for number in range(1, 301):
        twin.advance_to(number * 0.01)
        found.append(pressure(twin))
    assert (np.mean(found), np.std(found)) == (pytest.approx(20, abs=9), pytest.approx(50, rel=0.15))
    assert twin.latest(TOPIC).variance == 50.0**2
