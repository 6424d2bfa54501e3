"""The sensors of a world's own models: places, names in Gazebo and ROS, what they measure.

Names: gz-sim's src/Util.cc (``scopedName``, ``topicFromScopedName``) and src/systems/sensors/Sensors.cc; Gazebo
classic: gazebo_ros_pkgs' gazebo_ros/src/node.cpp, whose nodes in a world are in the root namespace.
"""

from math import pi

import numpy as np
import pytest
from camera_rig import centroid, need_mesa
from conftest import ROVER
from hinge import create, gz, launched, node
from launch_files import write
from rig import xyz

from drake_twin import Twin, TwinBuilder
from drake_twin.errors import InputError
from drake_twin.findings import Kind, texts
from drake_twin.scenario import World
from drake_twin.scenario.scenario_file import ScenarioFile, scenario_to_yaml

IMU, SCAN, IMAGE = "sensor_msgs/msg/Imu", "sensor_msgs/msg/LaserScan", "sensor_msgs/msg/Image"
INERTIAL = "<inertial><mass>1</mass><inertia><ixx>.1</ixx><iyy>.1</iyy><izz>.1</izz></inertia></inertial>"
BOX = "<geometry><box><size>0.2 0.2 0.2</size></box></geometry>"
RAYS = """<lidar><scan><horizontal><samples>3</samples><min_angle>-0.1</min_angle><max_angle>0.1</max_angle>
</horizontal></scan><range><min>0.3</min><max>20</max></range></lidar>"""


def link(inside, name="l", shape="collision"):
    return f'<link name="{name}">{INERTIAL}<{shape} name="c">{BOX}</{shape}>{inside}</link>'


def sensor(kind, inside="", name="s", attributes=""):
    return f'<sensor name="{name}" type="{kind}" {attributes}>{inside}</sensor>'


def model(inside, name="post", pose="0 0 1 0 0 0", static=True):
    return f'<model name="{name}"><static>{static}</static><pose>{pose}</pose>{inside}</model>'


def world(tmp_path, *models):
    text = f'<sdf version="1.9"><world name="w"><gravity>0 0 -9.81</gravity>{"".join(models)}</world></sdf>'
    return write(tmp_path / "w.sdf", text)


def twin_in(tmp_path, *models, bridged=None):
    file = world(tmp_path, *models)
    return TwinBuilder(world=World(file=str(file), ground=True, bridged=bridged)).robot("r", ROVER).build()


def table(twin):
    """The topics of the world's sensors: topic → (type, frame, rate)."""
    plans = [item for model in twin._session.built.sensing_models for item in model.sensors]
    return {topic.topic: (topic.type, item.frame, item.rate) for item in plans for topic in item.topics if topic.topic}


# --- names


@pytest.mark.parametrize(
    ("inside", "expected"),
    [
        (sensor("imu"), ("/post/s/imu", IMU, "post/l/s")),
        (sensor("imu", "<topic>/imu</topic>"), ("/post/imu", IMU, "post/l/s")),
        (sensor("imu", "<gz_frame_id>l</gz_frame_id>"), ("/post/s/imu", IMU, "l")),
        (
            sensor("imu", '<plugin name="p" filename="libgazebo_ros_imu_sensor.so"/>'),
            ("/p/out", IMU, "l"),
        ),
        (
            sensor(
                "imu",
                '<plugin name="p" filename="libgazebo_ros_imu_sensor.so"><ros><namespace>/yard</namespace>'
                "<remapping>~/out:=imu</remapping></ros></plugin>",
            ),
            ("/imu", IMU, "l"),
        ),
    ],
)
@pytest.mark.parametrize("static", [True, False])
def test_without_a_bridge_a_sensor_is_below_its_models_name_and_a_plugins_in_the_root(
    tmp_path, inside, expected, static
):
    topic, kind, frame = expected
    twin = twin_in(tmp_path, model(link(inside), static=static))
    assert table(twin) == {topic: (kind, frame, 0.0)}
    assert twin.graph.topics()[topic] == kind


def test_a_bridge_carries_default_and_given_topics(tmp_path):
    inside = sensor("imu") + sensor("gpu_lidar", f"<topic>scan</topic><update_rate>5</update_rate>{RAYS}", "lds")
    file = world(tmp_path, model(link(inside), static=False), model(link(sensor("imu")), "other", "3 0 1 0 0 0"))
    words = [
        f"/world/w/model/post/link/l/sensor/s/imu@{IMU}[gz.msgs.IMU",
        f"/scan@{SCAN}[gz.msgs.LaserScan",
        f"/world/w/model/none/link/l/sensor/s/imu@{IMU}[gz.msgs.IMU",
    ]
    bridge = node("ros_gz_bridge", "parameter_bridge", *words, remappings=[(words[0].partition("@")[0], "/post_imu")])
    robot = write(tmp_path / "r.urdf", '<robot name="r"><link name="b"/></robot>')
    scenario = launched(tmp_path, gz(str(file)), create("-file", robot, "-name", "r"), bridge).scenario
    twin = Twin(scenario)
    assert table(twin) == {"/post_imu": (IMU, "post/l/s", 0.0), "/scan": (SCAN, "post/l/lds", 5.0)}
    warnings = [*texts(scenario.findings, Kind.WARNING), *twin.findings.warnings]
    assert any(
        "'s'" in text and "no bridge carries /world/*/model/other/link/l/sensor/s/imu" in text for text in warnings
    )
    (line,) = {text.partition(",")[0] for text in warnings if "the bridge carries" in text}
    assert "model/none/" in line
    assert ScenarioFile(scenario_to_yaml(scenario), "saved").scenario == scenario


def test_a_model_inside_a_model_is_named_with_both(tmp_path):
    inner = f'<model name="head"><pose>0 0 0.5 0 0 0</pose>{link(sensor("imu"))}</model>'
    joint = '<joint name="j" type="fixed"><parent>l</parent><child>head::l</child></joint>'
    for static in (True, False):
        twin = twin_in(tmp_path, model(link("") + inner + joint, static=static))
        assert table(twin) == {"/post/head/s/imu": (IMU, "post/head/l/s", 0.0)}
        (plan,) = twin._session.built.sensing_models
        (topic,) = plan.sensors[0].topics
        assert topic.in_gazebo == "/world/*/model/post/model/head/link/l/sensor/s/imu"


def test_names_that_ros_does_not_take_are_changed(tmp_path):
    assert [*table(twin_in(tmp_path, model(link(sensor("imu")), "3 posts!")))] == ["/_3_posts_/s/imu"]


def test_an_included_models_sensors_are_read_with_their_own_file_and_line(tmp_path):
    inner = "\n\n" + model(link(sensor("imu", "<update_rate>fast</update_rate>")), "eye")
    for folder in ("eye", "mast"):
        (tmp_path / folder).mkdir()
        write(tmp_path / folder / "model.config", '<model><sdf version="1.9">model.sdf</sdf></model>')
    write(tmp_path / "eye" / "model.sdf", f'<sdf version="1.9">{inner}</sdf>')
    include = f"<include><uri>{tmp_path}/eye</uri></include>"
    outer = model(link("") + include.replace("<include>", "<include merge='true'>"), "mast")
    write(tmp_path / "mast" / "model.sdf", f'<sdf version="1.9">{outer}</sdf>')
    for body in (include, include.replace("/eye", "/mast")):
        with pytest.raises(InputError, match=r"update_rate is 'fast', which is not a .*number") as raised:
            twin_in(tmp_path, body)
        assert str(tmp_path / "eye" / "model.sdf") in str(raised.value)
        assert raised.value.line == 3


# --- what cannot be


@pytest.mark.parametrize(
    ("inside", "reason"),
    [
        (link(sensor("thermal")), "the twin has no such sensor"),
        (
            link("") + '<joint name="j" type="fixed"><parent>world</parent><child>l</child>'
            f"{sensor('force_torque')}</joint>",
            "the model is static: it has no joints",
        ),
        (
            link("") + '<plugin name="p" filename="libgazebo_ros_p3d.so"><body_name>tail</body_name></plugin>',
            "the model has no link 'tail'",
        ),
    ],
)
def test_a_sensor_that_cannot_be_is_not_started_with_its_place(tmp_path, inside, reason):
    twin = twin_in(tmp_path, model(inside))
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(reason)
    assert finding.file.endswith("w.sdf")
    assert finding.lines
    assert not any("is not used" in item.what for item in twin.findings)


def test_an_element_that_no_kind_reads_is_ignored_with_its_line(tmp_path):
    twin = twin_in(tmp_path, model(link(sensor("imu", "<colour>red</colour>"))))
    (finding,) = [item for item in twin.findings if "colour" in item.what]
    assert (finding.kind, bool(finding.lines)) == (Kind.IGNORED, True)


def test_a_model_that_drake_refuses_has_no_sensors(tmp_path):
    broken = link(sensor("imu")) + '<joint name="j" type="revolute"><parent>l</parent><child>gone</child></joint>'
    twin = twin_in(tmp_path, model(broken, static=False))
    assert table(twin) == {}
    assert any("the model is left out" in item.what for item in twin.findings)


# --- what they measure


@pytest.mark.parametrize("static", [True, False])
def test_a_pose_relative_to_a_frame_that_its_model_lacks_counts_from_its_link(tmp_path, static):
    """As in gz-sim, whose models do not have a frame of their own name; a finding says so."""
    pose = "<pose relative_to='post'>0 0 0.5 0 0 0</pose>"
    twin = twin_in(tmp_path, model(link(f"<pose>0 0 2 0 0 0</pose>{sensor('altimeter', pose)}"), static=static))
    assert twin.latest("/post/s/altimeter").vertical_reference == pytest.approx(3.5)
    (text,) = [item.what for item in twin.findings if "unknown frame" in item.what]
    assert (
        "sensor 's': its pose is relative to the unknown frame 'post'; it is taken as relative to the link 'l'" in text
    )


def test_a_pose_relative_to_a_frame_of_a_model_that_moves_counts_from_that(tmp_path):
    pose = "<pose relative_to='mount'>0 0 0.5 0 0 0</pose>"
    mount = "<frame name='mount'><pose>0 0 0.2 0 0 0</pose></frame>"
    inside = mount + link(f"<pose>0 0 2 0 0 0</pose>{sensor('altimeter', pose)}")
    twin = twin_in(tmp_path, model(inside, static=False))
    assert twin.latest("/post/s/altimeter").vertical_reference == pytest.approx(1.7)
    assert not any("unknown frame" in item.what for item in twin.findings)


def test_a_lidar_on_a_static_model_sees_what_stands_before_it(tmp_path):
    wall = '<link name="w"><collision name="c"><geometry><box><size>0.2 9 3</size></box></geometry></collision></link>'
    pose = "<pose relative_to='mount'>0 0 0.5 0 0 0</pose>"
    mount = "<frame name='mount' attached_to='l'><pose>0.2 0 0 0 0 0</pose></frame>"
    seeing = model(mount + link(sensor("ray", pose + RAYS)), pose=f"1 2 0.5 0 0 {pi / 2}")
    twin = twin_in(tmp_path, seeing, model(wall, "wall", f"1 7 1 0 0 {pi / 2}"))
    # The lidar is 0.2 m before the model, the wall's near side at y = 6.9.
    expected = 4.7 / np.cos([0.1, 0.0, 0.1])
    assert twin.sensor("post", "s").ranges == pytest.approx(expected, abs=5e-6)
    assert np.asarray(twin.latest("/post/s/scan").ranges) == pytest.approx(expected, abs=5e-6)


def test_a_static_imu_feels_gravity_and_a_falling_one_does_not(tmp_path):
    inside = link(sensor("imu", f"<pose>0 0 0 {pi / 2} 0 0</pose>"))
    twin = twin_in(tmp_path, model(inside), model(inside, "stone", "3 0 50 0 0 0", static=False))
    twin.advance_to(0.1)
    assert xyz(twin.latest("/post/s/imu").linear_acceleration) == pytest.approx([0.0, 9.81, 0.0], abs=1e-9)
    assert xyz(twin.latest("/stone/s/imu").linear_acceleration) == pytest.approx([0.0, 0.0, 0.0], abs=1e-9)


@pytest.mark.parametrize("static", [True, False])
def test_a_contact_sensor_of_the_world_is_named_as_in_gazebo(tmp_path, static):
    """A stone of 1 kg lies on a plate: one of both feels it, with its weight."""
    touch = sensor("contact", "<contact><collision>c</collision></contact>")
    plate = model(link("" if not static else touch), "plate", "3 0 0.1 0 0 0")
    stone = model(link(touch if not static else ""), "stone", "3 0 0.2995 0 0 0", static=False)
    twin = twin_in(tmp_path, plate, stone)
    twin.advance_to(1.0)
    owner, up = ("plate", -1.0) if static else ("stone", 1.0)
    contacts = twin.latest(f"/{owner}/s/contact").contacts
    force = sum(wrench.body_1_wrench.force.z for contact in contacts for wrench in contact.wrenches)
    assert force == pytest.approx(up * 9.81, rel=1e-3)
    assert contacts[0].collision1.name == f"{owner}::l::c"
    assert contacts[0].collision2.name == ("stone::l::c" if static else "plate::l::c")


def test_a_static_camera_sees_a_ball_where_it_is(tmp_path):
    need_mesa()
    picture = "<camera><horizontal_fov>1.0</horizontal_fov><image><width>80</width><height>60</height></image></camera>"
    eye = model(link(sensor("camera", f"<topic>eye/image</topic>{picture}"), shape="visual"), "eye", "0 0 2 0 0 0")
    ball = (
        '<link name="b"><visual name="v"><geometry><sphere><radius>0.1</radius></sphere></geometry>'
        "<material><diffuse>1 0 0 1</diffuse></material></visual></link>"
    )
    twin = twin_in(tmp_path, eye, model(ball, "ball", "4 0.5 2.25 0 0 0"))
    with twin:
        found = twin.sensor("eye", "s").image.astype(int)
        info = twin.latest("/eye/eye/camera_info")
    focal = 40 / np.tan(0.5)
    assert info.k[0] == pytest.approx(focal)
    expected = [info.k[2] - focal * 0.5 / 4, info.k[5] - focal * 0.25 / 4]
    assert centroid(found[:, :, 0] - found[:, :, 1] > 60) == pytest.approx(expected, abs=0.6)


def test_an_unknown_owner_of_a_sensor_is_refused_with_those_that_there_are(tmp_path):
    twin = twin_in(tmp_path, model(link(sensor("imu"))))
    with pytest.raises(InputError, match=r"unknown robot 'pots'.*post"):
        twin.sensor("pots", "s")


def test_listeners_of_a_worlds_sensor_outlive_a_spawn(tmp_path):
    from drake_twin.scenario import Robot

    twin = twin_in(tmp_path, model(link(sensor("imu", "<update_rate>100</update_rate>"))))
    heard = []
    twin.subscribe("/post/s/imu", heard.append)
    twin.advance_to(0.1)
    twin.entities.spawn(Robot("other", ROVER, xyz=(5, 0, 0.13)))
    twin.advance_to(0.2)
    assert len(heard) == 20
