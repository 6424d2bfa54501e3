"""Sensors of the plant against closed forms."""

from math import cos, pi, radians, sin

import numpy as np
import pytest
from rig import START_HEIGHT, on_box, twin_with, xyz

from drake_twin.description.surroundings import SphericalCoordinates
from drake_twin.sensors.navsat import Tangent

G = 9.81
NAVSAT = """<spherical_coordinates><surface_model>EARTH_WGS84</surface_model><latitude_deg>{}</latitude_deg>
<longitude_deg>{}</longitude_deg><elevation>{}</elevation><heading_deg>{}</heading_deg></spherical_coordinates>"""


# --- magnetometer


@pytest.mark.parametrize(("yaw", "expected"), [(0, (1, 2, 3)), (90, (2, -1, 3)), (180, (-1, -2, 3)), (270, (-2, 1, 3))])
def test_a_magnetometer_turned_four_ways_has_the_worlds_field_in_its_own_axes(tmp_path, yaw, expected):
    field = "<magnetic_field>1e-5 2e-5 3e-5</magnetic_field>"
    twin = twin_with(tmp_path, on_box("magnetometer"), world=field, rpy=(0, 0, radians(yaw)))
    message = twin.latest("/box/s/magnetometer")
    assert xyz(message.magnetic_field) == pytest.approx([1e-5 * value for value in expected], abs=1e-18)
    assert message.header.frame_id == "box/box/s"


def test_a_magnetometer_on_its_side_has_up_in_its_own_y(tmp_path):
    field = "<magnetic_field>1e-5 2e-5 3e-5</magnetic_field>"
    inside = f"<pose>0 0 0 {pi / 2} 0 0</pose>"
    twin = twin_with(tmp_path, on_box("magnetometer", inside), world=field)
    assert xyz(twin.latest("/box/s/magnetometer").magnetic_field) == pytest.approx([1e-5, 3e-5, -2e-5], abs=1e-18)


def test_without_a_field_of_its_own_a_world_has_that_of_sdf(tmp_path):
    # sdformat's sdf/1.x/world.sdf: <magnetic_field> defaults to this.
    twin = twin_with(tmp_path, on_box("magnetometer"), world=None)
    expected = [5.5645e-6, 22.8758e-6, -42.3884e-6]
    assert xyz(twin.latest("/box/s/magnetometer").magnetic_field) == pytest.approx(expected, rel=1e-12)


# --- height


def test_an_altimeter_falls_as_a_stone(tmp_path):
    twin = twin_with(tmp_path, on_box("altimeter", "<pose>0.1 0 0.3 0 0 0</pose>"), xyz=(0, 0, 50), time_step=1e-4)
    twin.advance_to(1.0)
    message = twin.latest("/box/s/altimeter")
    assert message.vertical_reference == pytest.approx(50.3)
    assert message.vertical_position == pytest.approx(-G / 2, rel=2e-4)
    assert message.vertical_velocity == pytest.approx(-G, rel=1e-9)


def test_an_altimeter_beside_the_axis_of_a_turning_link_moves_up_and_down(tmp_path):
    twin = twin_with(tmp_path, on_box("altimeter", "<pose>0.5 0 0 0 0 0</pose>"), xyz=(0, 0, 50))
    twin.entities.set_state("box", linear=(0, 0, 1.0), angular=(0, 2.0, 0))
    message = twin.latest("/box/s/altimeter")
    assert message.vertical_velocity == pytest.approx(1.0 - 2.0 * 0.5)


@pytest.mark.parametrize("noisy", ["vertical_position", "vertical_velocity"])
def test_height_and_velocity_have_each_its_own_noise(tmp_path, noisy):
    noise = "<noise type='gaussian'><mean>7</mean></noise>"
    inside = f"<altimeter><{noisy}>{noise}</{noisy}></altimeter>"
    twin = twin_with(tmp_path, on_box("altimeter", inside), xyz=(0, 0, 50))
    message = twin.latest("/box/s/altimeter")
    found = {name: getattr(message, name) for name in ("vertical_position", "vertical_velocity")}
    assert found == {**dict.fromkeys(found, 0.0), noisy: 7.0}


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


# --- navsat


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


# --- p3d


def test_p3d_is_the_true_pose_and_twist_in_the_world(tmp_path):
    plugin = """<gazebo><plugin name="truth" filename="libgazebo_ros_p3d.so"><body_name>box</body_name>
      <xyz_offset>1 2 3</xyz_offset><ros><remapping>odom:=truth/odom</remapping></ros></plugin></gazebo>"""
    twin = twin_with(tmp_path, plugin, xyz=(0, 0, 50))
    twin.entities.set_state("box", position=(4, 5, 60), linear=(1, 2, 0), angular=(0, 0, 1))
    message = twin.latest("/box/truth/odom")
    assert xyz(message.pose.pose.position) == pytest.approx([5, 7, 63])
    assert xyz(message.twist.twist.linear) == pytest.approx([1, 2, 0])
    assert xyz(message.twist.twist.angular) == pytest.approx([0, 0, 1])
    assert (message.header.frame_id, message.child_frame_id) == ("world", "box/box")


# --- contact


def contact(name="box_collision", more=""):
    return on_box("contact", f"<contact><collision>{name}</collision></contact>{more}")


@pytest.mark.parametrize("style", ["faces", "point"])
def test_the_forces_on_a_resting_box_sum_to_its_weight(tmp_path, style):
    twin = twin_with(tmp_path, contact(), contact=style.replace("faces", "hydroelastic"))
    twin.advance_to(2.0)
    message = twin.latest("/box/s/contact")
    assert {item.collision1.name for item in message.contacts} == {"box::box::box_collision"}
    forces = [wrench.body_1_wrench.force for item in message.contacts for wrench in item.wrenches]
    assert np.sum([xyz(force) for force in forces], axis=0) == pytest.approx([0, 0, 2 * G], abs=2 * G * 1e-3)
    against = [xyz(wrench.body_2_wrench.force) for item in message.contacts for wrench in item.wrenches]
    assert np.sum(against, axis=0) == pytest.approx([0, 0, -2 * G], abs=2 * G * 1e-3)
    normals = [xyz(normal) for item in message.contacts for normal in item.normals]
    assert normals == pytest.approx(np.array([[0, 0, 1]] * len(normals)), abs=1e-6)
    depths = [depth for item in message.contacts for depth in item.depths]
    sunk = START_HEIGHT - twin.entities.state("box").position[2]
    assert max(depths) == pytest.approx(sunk, rel=0.02)
    positions = [position.z for item in message.contacts for position in item.positions]
    assert max(map(abs, positions)) < 1e-3


def test_gazebo_publishes_no_contact_while_nothing_touches_and_classic_an_empty_one(tmp_path):
    twin = twin_with(tmp_path, contact(), xyz=(0, 0, 50))
    assert twin.latest("/box/s/contact") is None
    bumper = '<update_rate>10</update_rate><plugin name="b" filename="libgazebo_ros_bumper.so"/>'
    twin = twin_with(tmp_path, contact(more=bumper), xyz=(0, 0, 50))
    state = twin.latest("/box/bumper_states")
    assert (state.states, state.header.frame_id) == ([], "world")


def test_a_bumper_sums_the_forces_of_each_pair(tmp_path):
    bumper = '<plugin name="b" filename="libgazebo_ros_bumper.so"/>'
    twin = twin_with(tmp_path, contact(more=bumper))
    twin.advance_to(2.0)
    (state,) = twin.latest("/box/bumper_states").states
    assert state.collision1_name == "box::box::box_collision"
    assert xyz(state.total_wrench.force) == pytest.approx([0, 0, 2 * G], abs=2 * G * 1e-3)
    assert np.sum([xyz(item.force) for item in state.wrenches], axis=0) == pytest.approx(xyz(state.total_wrench.force))
    assert len(state.wrenches) == len(state.contact_positions) == len(state.contact_normals) == len(state.depths)


FOLDED = """<robot name="box"><link name="box"><inertial><mass value="2"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><origin xyz="0 0 1"/><geometry><box size=".4 .4 .2"/></geometry></collision></link>
  <link name="skid"><collision name="shoe"><geometry><box size=".4 .4 .2"/></geometry></collision></link>
  <joint name="j" type="fixed"><parent link="box"/><child link="skid"/></joint>{}</robot>"""


@pytest.mark.parametrize(
    ("name", "heard"),
    [
        ("box_fixed_joint_lump__shoe_collision_1", True),
        ("box_fixed_joint_lump__shoe_collision", True),
        ("shoe_collision_1", True),
        ("shoe_collision", True),
        ("shoe", True),
        ("box_collision", False),
    ],
)
def test_a_shape_of_a_folded_link_has_the_name_that_gazebo_gives_it(tmp_path, name, heard):
    twin = twin_with(tmp_path, contact(name), body=FOLDED)
    twin.advance_to(0.5)
    message = twin.latest("/box/s/contact")
    assert (message is not None) == heard
    if heard:
        assert message.contacts[0].collision1.name == "box::box::box_fixed_joint_lump__shoe_collision_1"


def test_a_shape_with_a_name_of_its_own_is_found_by_both_names(tmp_path):
    """Gazebo's reader takes each name that does not begin with the link's for that of a folded link's shape."""
    body = FOLDED.replace('<collision><origin xyz="0 0 1"/>', '<collision name="roof"><origin xyz="0 0 1"/>')
    for name in ("box_fixed_joint_lump__roof_collision", "roof_collision", "roof"):
        assert not any(
            "collision shape" in text for text in twin_with(tmp_path, contact(name), body=body).findings.warnings
        )


def test_a_shape_that_the_link_lacks_is_a_warning_with_those_that_it_has(tmp_path):
    (warning,) = [
        text for text in twin_with(tmp_path, contact("roof"), body=FOLDED).findings.warnings if "roof" in text
    ]
    assert "it has box_collision, box_fixed_joint_lump__shoe_collision_1" in warning


# --- force/torque


def test_a_force_torque_sensor_publishes_what_its_broadcaster_would(tmp_path):
    arm = """<robot name="box"><link name="box"/><link name="load"><inertial><mass value="2"/>
      <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial></link>
      <joint name="j" type="fixed"><parent link="box"/><child link="load"/></joint>
      <link name="world"/><joint name="w" type="fixed"><parent link="world"/><child link="box"/></joint>{}</robot>"""
    sensor = '<gazebo reference="j"><sensor name="ft" type="force_torque"><topic>wrench</topic></sensor></gazebo>'
    plugin = """<gazebo><plugin name="f" filename="libgazebo_ros_ft_sensor.so"><joint_name>j</joint_name>
      <update_rate>50</update_rate></plugin></gazebo>"""
    (tmp_path / "arm").mkdir()
    twin = twin_with(tmp_path / "arm", sensor, plugin.replace('name="f"', 'name="f"'), body=arm, world=None)
    twin.advance_to(0.01)
    assert xyz(twin.latest("/box/wrench").wrench.force) == pytest.approx([0, 0, -2 * G])
    assert any(
        "publishes on /box/wrench, too" in warning for warning in twin.findings.warnings
    )  # the plugin's is the same
    twin = twin_with(tmp_path / "arm", plugin, body=arm, world=None)
    message = twin.latest("/box/wrench")
    assert xyz(message.wrench.force) == pytest.approx([0, 0, 2 * G])  # body2Force: on the child
    assert message.header.frame_id == "box/load"
