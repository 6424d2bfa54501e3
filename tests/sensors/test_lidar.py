"""Lidars from their files to their messages."""

from math import pi

import numpy as np
import pytest
import trimesh
from rig import BODY, on_box, twin_with

from drake_twin import InputError, TwinBuilder
from drake_twin.findings import Kind
from drake_twin.sensors.ray_caster import RayCaster

WALL = """<model name="wall"><static>true</static><pose>{} 0 0.5 0 0 {}</pose><link name="l">
  <visual name="v"><geometry><box><size>0.2 6 1</size></box></geometry></visual>
  <collision name="c"><pose>0.5 0 0 0 0 0</pose><geometry><box><size>0.2 6 1</size></box></geometry></collision>
</link></model>"""


def lidar(kind="gpu_lidar", scan="", ranges="<min>0.12</min><max>3.5</max>", more="", part="lidar", **options):
    horizontal = "<samples>5</samples><min_angle>-0.2</min_angle><max_angle>0.2</max_angle>"
    rays = f"<scan><horizontal>{scan or horizontal}</horizontal>{options.pop('vertical', '')}</scan>"
    inside = f"<topic>scan</topic><update_rate>10</update_rate><{part}>{rays}<range>{ranges}</range>{more}</{part}>"
    return on_box(kind, inside + options.pop("plugin", ""), **options)


def heard(twin, topic, until=0.25):
    found = []
    twin.subscribe(topic, found.append)
    twin.advance_to(until)
    return found


def test_a_wall_two_meters_ahead_is_at_two_meters(tmp_path):
    twin = twin_with(tmp_path, lidar(), world=WALL.format(2.1, 0))
    scans = heard(twin, "/box/scan")
    assert [item.header.stamp.nanosec for item in scans] == [0, 100_000_000, 200_000_000]
    scan = scans[-1]
    assert scan.ranges == pytest.approx(2.0 / np.cos([-0.2, -0.1, 0.0, 0.1, 0.2]), abs=1e-4)
    assert (scan.angle_min, scan.angle_max, scan.angle_increment) == pytest.approx((-0.2, 0.2, 0.1))
    assert (scan.range_min, scan.range_max) == pytest.approx((0.12, 3.5))
    assert scan.header.frame_id == "box/box/s"


def test_a_scan_from_left_to_right_goes_backwards_as_in_gazebo_classic(tmp_path):
    """ANGLE = i · (max - min) / (samples - 1) + min of gazebo's MultiRayShape, for champ's lidar too."""
    scan = "<samples>4</samples><min_angle>0.2</min_angle><max_angle>-0.1</max_angle>"
    twin = twin_with(tmp_path, lidar(scan=scan), world=WALL.format(2.1, 0))
    scan = heard(twin, "/box/scan")[-1]
    assert (scan.angle_min, scan.angle_max, scan.angle_increment) == pytest.approx((0.2, -0.1, -0.1))
    assert scan.ranges == pytest.approx(2.0 / np.cos([0.2, 0.1, 0.0, -0.1]), abs=1e-4)


@pytest.mark.parametrize("kind", ["ray", "lidar"])
def test_a_ray_sees_collision_shapes(tmp_path, kind):
    outside = "<min>0.3</min><max>3.5</max>"
    twin = twin_with(tmp_path, lidar(kind, ranges=outside, part="ray"), world=WALL.format(2.1, 0))
    assert heard(twin, "/box/scan")[-1].ranges[2] == pytest.approx(2.5, abs=1e-4)


@pytest.mark.parametrize("suffix", ["stl", "obj"])
def test_a_ray_sees_a_collision_mesh_as_it_is_and_not_its_hull(tmp_path, suffix):
    """The lidar stands in the notch of an L: Gazebo's rays meet the mesh, so that they leave by the open side."""
    low, high = trimesh.creation.box((0.4, 0.4, 0.1)), trimesh.creation.box((0.1, 0.4, 0.3))
    high.apply_translation((-0.15, 0, 0.2))
    body = low + high
    body.apply_scale(1000.0)
    body.export(tmp_path / f"body.{suffix}")
    mesh = f'<mesh filename="{tmp_path}/body.{suffix}" scale="0.001 0.001 0.001"/>'
    circle = f"<samples>2</samples><min_angle>0</min_angle><max_angle>{pi}</max_angle>"
    sensor = lidar("ray", scan=circle, ranges="<min>0.02</min><max>3.5</max>", part="ray")
    twin = twin_with(
        tmp_path,
        sensor.replace("<topic>", "<pose>0 0 0.12 0 0 0</pose><topic>"),
        world=WALL.format(1.6, 0),
        body=BODY.replace('<box size=".4 .4 .2"/>', mesh),
        xyz=(0, 0, 0.05),
    )
    assert twin.latest("/box/scan").ranges == pytest.approx([2.0, 0.1], abs=1e-4)


def test_without_embree_a_lidar_is_not_started_and_the_twin_runs_on(tmp_path, monkeypatch):
    monkeypatch.setattr("drake_twin.sensors.lidar.find_spec", lambda name: None)
    twin = twin_with(tmp_path, lidar(), world=WALL.format(2.1, 0))
    twin.advance_to(0.1)
    assert "/box/scan" not in twin.graph.topics()
    assert any("lidars need embreex, which is not installed" in text for text in twin.findings.not_started)


def test_the_ground_is_seen(tmp_path):
    down = "<pose>0 0 0 0 0.5 0</pose>"
    twin = twin_with(tmp_path, lidar(ranges="<min>0.01</min><max>3.5</max>").replace("<topic>", f"{down}<topic>"))
    assert twin.latest("/box/scan").ranges[2] == pytest.approx(0.1 / np.sin(0.5), abs=1e-4)


def test_a_row_may_look_straight_down(tmp_path):
    vertical = f"<vertical><samples>2</samples><min_angle>{-pi / 2}</min_angle><max_angle>-0.5</max_angle></vertical>"
    sensor = lidar(scan="<samples>1</samples>", vertical=vertical, ranges="<min>0.01</min><max>3.5</max>")
    twin = twin_with(tmp_path, sensor, xyz=(0, 0, 0.8))
    z = np.asarray(twin.latest("/box/scan/points").data).view("<f4").reshape(2, 8)[:, 2]
    assert z == pytest.approx([-0.8, -0.8], abs=1e-4)  # both meet the ground
    assert twin.latest("/box/scan").ranges == pytest.approx([0.8 / np.sin(0.5)], abs=1e-4)


def test_a_proximity_sensor_sees_less_than_a_meter(tmp_path):
    twin = twin_with(tmp_path, lidar(ranges="<min>0.05</min><max>0.5</max>"), world=WALL.format(0.5, 0))
    scan = twin.latest("/box/scan")
    assert scan.range_max == pytest.approx(0.5)
    assert scan.ranges == pytest.approx(0.4 / np.cos([-0.2, -0.1, 0.0, 0.1, 0.2]), abs=1e-4)


def test_beyond_the_largest_range_is_infinite(tmp_path):
    twin = twin_with(tmp_path, lidar(ranges="<min>0.1</min><max>1.5</max>"), world=WALL.format(2.1, 0))
    assert np.isposinf(heard(twin, "/box/scan")[-1].ranges).all()


def test_the_scan_of_a_robot_that_turns_is_that_of_a_twin_built_at_its_pose(tmp_path):
    turning = twin_with(tmp_path, lidar(), world=WALL.format(2.1, 0.3))
    turning.entities.set_state("box", linear=[0.3, 0.1, 0.0], angular=[0.0, 0.0, 0.8])
    ranges = []
    turning.subscribe("/box/scan", lambda scan: ranges.append((turning.entities.state("box"), scan.ranges)))
    turning.advance_to(0.45)
    assert len(ranges) == 5
    assert ranges[0][1][2] != ranges[-1][1][2]
    for state, seen in ranges:
        still = twin_with(tmp_path, lidar(), world=WALL.format(2.1, 0.3))
        still.entities.set_state("box", position=state.position, orientation=state.orientation)
        assert still.latest("/box/scan").ranges.tobytes() == seen.tobytes()


def test_rows_rings_and_the_order_of_points(tmp_path):
    vertical = "<vertical><samples>3</samples><min_angle>-0.1</min_angle><max_angle>0.1</max_angle></vertical>"
    twin = twin_with(tmp_path, lidar(vertical=vertical), world=WALL.format(2.1, 0), xyz=(0, 0, 0.5))
    cloud = twin.latest("/box/scan/points")
    assert [(item.name, item.offset, item.datatype) for item in cloud.fields] == [
        ("x", 0, 7),
        ("y", 4, 7),
        ("z", 8, 7),
        ("intensity", 16, 7),
        ("ring", 24, 4),
    ]
    assert (cloud.height, cloud.width, cloud.point_step, cloud.row_step) == (3, 5, 32, 160)
    data = np.asarray(cloud.data).tobytes()
    points = np.array([np.frombuffer(data, "<f4", 3, 32 * index) for index in range(15)])
    rings = [int(np.frombuffer(data, "<u2", 1, 32 * index + 24)[0]) for index in range(15)]
    assert rings == [0] * 5 + [1] * 5 + [2] * 5
    assert points[:, 0] == pytest.approx(2.0, abs=1e-3)
    angles = np.array([-0.2, -0.1, 0.0, 0.1, 0.2])
    assert points[5:10, 1] == pytest.approx(2.0 * np.tan(angles), abs=1e-3)
    assert points[::5, 2] == pytest.approx(2.0 / np.cos(0.2) * np.tan([-0.1, 0.0, 0.1]), abs=1e-3)
    middle = twin.latest("/box/scan").ranges
    assert middle == pytest.approx(2.0 / np.cos(angles), abs=1e-4)


@pytest.mark.parametrize(
    ("output", "kind"),
    [("", "PointCloud2"), ("LaserScan", "LaserScan"), ("PointCloud", "PointCloud"), ("Range", "Range")],
)
def test_what_gazebo_classics_plugin_publishes(tmp_path, output, kind):
    output = f"<output_type>sensor_msgs/{output}</output_type>" if output else ""
    plugin = (
        '<plugin name="laser" filename="libgazebo_ros_ray_sensor.so">'
        f"<ros><remapping>~/out:=front</remapping></ros>{output}<frame_name>lens</frame_name></plugin>"
    )
    twin = twin_with(
        tmp_path,
        lidar("ray", ranges="<min>0.3</min><max>3.5</max>", part="ray", plugin=plugin),
        world=WALL.format(2.1, 0),
    )
    assert twin.graph.topics()["/box/front"] == f"sensor_msgs/msg/{kind}"
    message = heard(twin, "/box/front")[-1]
    assert message.header.frame_id.endswith("lens")
    if kind == "Range":
        assert message.range == pytest.approx(2.5, abs=1e-4)
        assert message.field_of_view == pytest.approx(0.4)
    if kind == "PointCloud":
        assert [point.x for point in message.points] == pytest.approx([2.5] * 5, abs=1e-3)
        assert [(item.name, item.values.tolist()) for item in message.channels] == [("intensity", [0.0] * 5)]
    if kind == "PointCloud2":
        assert [(item.name, item.offset, item.datatype) for item in message.fields] == [
            ("x", 0, 7),
            ("y", 4, 7),
            ("z", 8, 7),
            ("intensity", 12, 7),
        ]
        assert (message.height, message.width, message.point_step, message.row_step) == (1, 5, 16, 80)
        assert message.is_dense
        points = np.frombuffer(message.data.tobytes(), "<f4").reshape(5, 4)
        assert points[:, 0] == pytest.approx(2.5, abs=1e-3)
        assert points[:, 1] == pytest.approx(2.5 * np.tan([-0.2, -0.1, 0.0, 0.1, 0.2]), abs=1e-3)


@pytest.mark.parametrize("kind", ["PointCloud2", "PointCloud", "Range"])
def test_what_gazebo_classics_plugin_publishes_of_nothing(tmp_path, kind):
    """gazebo_ros/conversions/sensor_msgs.hpp: no points where nothing is met, and the largest float as the range."""
    plugin = (
        '<plugin name="laser" filename="libgazebo_ros_ray_sensor.so"><ros><remapping>~/out:=front</remapping></ros>'
        f"<output_type>sensor_msgs/{kind}</output_type></plugin>"
    )
    ranges = "<min>0.3</min><max>1.0</max>"
    twin = twin_with(tmp_path, lidar("ray", ranges=ranges, part="ray", plugin=plugin), world=WALL.format(2.1, 0))
    message = heard(twin, "/box/front")[-1]
    if kind == "Range":
        assert message.range == np.finfo(np.float32).max
    elif kind == "PointCloud":
        assert message.points == []
    else:
        assert (message.height, message.width, message.data.size) == (1, 0, 0)


def test_rays_are_cast_for_listeners_only_and_once_for_both_topics(tmp_path, monkeypatch):
    casts = []
    plain = RayCaster.cast
    monkeypatch.setattr(RayCaster, "cast", lambda *arguments: (casts.append(1), plain(*arguments))[1])
    twin = twin_with(tmp_path, lidar(), lidar(name="other"), world=WALL.format(2.1, 0))
    twin.advance_to(1.0)
    assert casts == []
    heard(twin, "/box/scan", until=1.0)
    heard(twin, "/box/scan/points", until=1.95)
    assert len(casts) == 10


def test_noise_is_within_the_ranges_and_leaves_infinity_alone(tmp_path):
    noise = "<noise><type>gaussian</type><mean>0</mean><stddev>0.05</stddev></noise>"
    twin = twin_with(tmp_path, lidar(more=noise), world=WALL.format(2.1, 0))
    values = np.array([scan.ranges[2] for scan in heard(twin, "/box/scan", until=10.0)])
    assert values.std() == pytest.approx(0.05, rel=0.2)
    assert values.mean() == pytest.approx(2.0, abs=0.02)
    away = twin_with(tmp_path, lidar(more=noise), world="")
    assert np.isposinf(heard(away, "/box/scan")[-1].ranges).all()


@pytest.mark.parametrize(
    ("options", "wrong"),
    [
        ({"scan": "<samples>0</samples>"}, "samples is '0'"),
        ({"scan": "<samples>100000000</samples>"}, "rays are too many"),
        ({"vertical": "<vertical><samples>2</samples><min_angle>1</min_angle></vertical>"}, "below min_angle"),
        ({"ranges": "<min>2</min><max>1</max>"}, "not above the least"),
        ({"ranges": "<min>-1</min><max>1</max>"}, "min is '-1'"),
        ({"more": "<noise><type>gaussian</type><stddev>-1</stddev></noise>"}, "stddev is '-1'"),
        ({"more": "<noise><type>gaussian</type><mean>nan</mean></noise>"}, "nan"),
        ({"more": "<noise><type>pink</type></noise>"}, "unknown noise type 'pink'"),
        ({"vertical": "<vertical><samples>2</samples><max_angle>2</max_angle></vertical>"}, "from -pi/2"),
    ],
)
def test_bad_values_are_one_paragraph_with_file_and_line(tmp_path, options, wrong):
    with pytest.raises(InputError, match=wrong) as refused:
        twin_with(tmp_path, lidar(**options))
    assert "box.urdf" in str(refused.value)
    assert refused.value.line


@pytest.mark.parametrize(
    ("options", "what"),
    [
        ({"scan": "<samples></samples>"}, "<samples> in <horizontal> of sensor 's'"),
        ({"ranges": "<min/><max>3</max>"}, "<min> in <range> of sensor 's'"),
        ({"more": "<noise><type>gaussian</type><stddev> </stddev></noise>"}, "<stddev> in <noise> of sensor 's'"),
    ],
)
def test_a_number_that_is_empty_is_said(tmp_path, options, what):  # Gazebo refuses the file, or has the default
    (finding,) = [item for item in twin_with(tmp_path, lidar(**options)).findings if item.kind is Kind.IGNORED]
    assert finding.what == what
    assert finding.lines


def test_what_a_lidar_does_not_read_is_said(tmp_path):
    twin = twin_with(tmp_path, lidar(more="<visibility_mask>3</visibility_mask>"))
    (finding,) = [item for item in twin.findings if item.kind is Kind.IGNORED]
    assert "<visibility_mask>" in finding.what


def test_a_robot_sees_another_one(tmp_path):
    (tmp_path / "box.urdf").write_text(
        '<robot name="box"><link name="box"><inertial><mass value="2"/>'
        '<inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>'
        '<visual><geometry><cylinder radius=".3" length=".5"/></geometry></visual>'
        '<collision><geometry><box size=".4 .4 .2"/></geometry></collision></link>' + lidar() + "</robot>"
    )
    builder = TwinBuilder()
    for index in range(2):
        builder.robot(f"r{index}", tmp_path / "box.urdf", xyz=(1.5 * index, 0, 0.1))
    twin = builder.build()
    # Its own cylinder of 0.3 m is not seen from inside, as in Gazebo; the other's is 1.5 m ahead.
    angles = np.linspace(-0.2, 0.2, 5)
    expected = 1.5 * np.cos(angles) - np.sqrt(0.3**2 - (1.5 * np.sin(angles)) ** 2)
    assert twin.latest("/r0/scan").ranges == pytest.approx(expected, abs=1e-4)
    twin.entities.set_state("r1", position=[0.2, 0.0, 0.1])
    assert twin.latest("/r0/scan").ranges[2] == np.inf
