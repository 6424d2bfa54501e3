"""Receivers of satellite navigation against pyproj."""

from math import cos, radians, sin

import numpy as np
import pytest
from rig import START_HEIGHT, on_box, twin_with, xyz

from drake_twin.description.surroundings import SphericalCoordinates
from drake_twin.sensors.navsat import Tangent

NAVSAT = """<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>{}</latitude_deg>
<longitude_deg>{}</longitude_deg><elevation>{}</elevation><heading_deg>{}</heading_deg></spherical_coordinates>"""


def test_a_receiver_at_the_worlds_origin_is_where_the_world_says(tmp_path):
    world = NAVSAT.format(48.1, 11.5, 520.0, 0.0)
    inside = f"<pose>0 0 {-START_HEIGHT} 0 0 0</pose>"
    message = twin_with(tmp_path, on_box("navsat", inside), world=world).latest("/box/s/navsat")
    found = (message.latitude, message.longitude, message.altitude)
    assert found == pytest.approx((48.1, 11.5, 520.0), abs=1e-9)
    assert (message.status.status, message.position_covariance_type) == (0, 0)


@pytest.mark.parametrize("heading", [0.0, 90.0, -37.0])
@pytest.mark.parametrize("place", [(48.1, 11.5, 520.0), (-33.9, 151.2, 5.0), (0.0, 179.999, 0.0), (85.0, -60.0, 0.0)])
def test_within_a_kilometre_it_agrees_with_pyproj(heading, place):
    pyproj = pytest.importorskip("pyproj", reason="the extra 'test' has pyproj, the second opinion on WGS 84")
    latitude, longitude, elevation = place
    to_ecef = pyproj.Transformer.from_crs("EPSG:4979", "EPSG:4978", always_xy=True)
    topocentric = pyproj.Transformer.from_pipeline(
        f"+proj=topocentric +ellps=WGS84 +lon_0={longitude} +lat_0={latitude} +h_0={elevation}"
    )
    geod = pyproj.Geod(ellps="WGS84")
    dut = Tangent(SphericalCoordinates(latitude, longitude, elevation, heading))
    turn = radians(heading)
    for x, y, z in ((1000.0, 0.0, 0.0), (0.0, 1000.0, 30.0), (-600.0, 700.0, -5.0), (0.0, 0.0, 100.0)):
        found = dut.geodetic(np.array([x, y, z]))
        ecef = to_ecef.transform(found[1], found[0], found[2])
        east, north, up = topocentric.transform(*ecef)
        expected = (x * cos(turn) - y * sin(turn), x * sin(turn) + y * cos(turn), z)
        assert (east, north, up) == pytest.approx(expected, abs=1e-6)
        back = geod.inv(longitude, latitude, found[1], found[0])
        assert back[2] == pytest.approx(float(np.hypot(x, y)), rel=2e-4, abs=1e-3)


def test_with_the_heading_the_x_axis_points_north_at_90_degrees():
    dut = Tangent(SphericalCoordinates(10.0, 20.0, 0.0, 90.0))
    latitude, longitude, _ = dut.geodetic(np.array([100.0, 0.0, 0.0]))
    assert latitude > 10.0005
    assert longitude == pytest.approx(20.0, abs=1e-9)


def test_a_world_that_is_nowhere_has_no_fix_and_says_so(tmp_path):
    twin = twin_with(tmp_path, on_box("navsat"))
    assert twin.latest("/box/s/navsat") is None
    assert any("no <spherical_coordinates>" in warning for warning in twin.findings.warnings)


def test_gazebo_classics_receiver_publishes_its_velocity_too(tmp_path):
    inside = '<update_rate>5</update_rate><plugin name="gps" filename="libgazebo_ros_gps_sensor.so"/>'
    twin = twin_with(tmp_path, on_box("gps", inside), world=NAVSAT.format(48.1, 11.5, 520.0, 90.0), xyz=(0, 0, 50))
    twin.entities.set_state("box", linear=(3.0, 1.0, 0))
    velocity = twin.latest("/box/gps/vel")
    assert xyz(velocity.vector) == pytest.approx([-1.0, 3.0, 0.0], abs=1e-9)  # x is north, y is west
    assert velocity.header.frame_id == "box/box"
    assert twin.latest("/box/gps/out").position_covariance_type == 2
