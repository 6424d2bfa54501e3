"""Barometers against the table of the standard atmosphere of 1976."""

import pytest
from rig import START_HEIGHT, on_box, twin_with


def test_the_variance_of_the_pressure_is_that_of_its_noise(tmp_path):
    noise = "<noise type='gaussian'><stddev>3</stddev></noise>"
    inside = f"<air_pressure><pressure>{noise}</pressure></air_pressure>"
    assert twin_with(tmp_path, on_box("air_pressure", inside)).latest("/box/s/air_pressure").variance == 9.0
    assert twin_with(tmp_path, on_box("air_pressure")).latest("/box/s/air_pressure").variance == 0.0


# The standard atmosphere of 1976, table I: geometric altitude (m), pressure (Pa).
@pytest.mark.parametrize(
    ("altitude", "pressure"), [(0, 101325.0), (500, 95461.0), (1000, 89876.0), (3000, 70121.0), (8000, 35652.0)]
)
def test_the_pressure_is_that_of_the_standard_atmosphere(tmp_path, altitude, pressure):
    inside = f"<air_pressure><reference_altitude>{altitude - START_HEIGHT}</reference_altitude></air_pressure>"
    twin = twin_with(tmp_path, on_box("air_pressure", inside))
    assert twin.latest("/box/s/air_pressure").fluid_pressure == pytest.approx(pressure, rel=5e-5)
