"""Sensors whose files are wrong: one paragraph with file, line, value and choices, and exit code 2."""

import subprocess
import sys
from pathlib import Path
from tempfile import TemporaryDirectory

import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st
from launch_files import write
from lxml import etree
from rig import BODY, on_box, twin_with

from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import Sensor
from drake_twin.description.sensor_element import SensorElement
from drake_twin.description.sensors import SENSOR_PLUGINS
from drake_twin.description.world_file import read_world
from drake_twin.errors import InputError
from drake_twin.findings import Place
from drake_twin.from_launch.bridges import bridge_lines
from drake_twin.planning.sensor_plan import plan_sensors
from drake_twin.planning.world_sensors import plan_models
from drake_twin.ros2.launched import LaunchedProcess
from drake_twin.scenario import Robot
from drake_twin.sensors.registry import SENSORS, sensor_class

WRONG = [
    ("imu", "<update_rate>-5</update_rate>", "update_rate is '-5', but it cannot be negative"),
    ("imu", "<update_rate>nan</update_rate>", "update_rate is 'nan', which is not finite"),
    ("imu", "<pose>1 2</pose>", "pose is '1 2', where six numbers are needed"),
    ("imu", "<pose degrees='true'>1 2</pose>", "is not a pose"),
    ("imu", "<imu><enable_orientation>maybe</enable_orientation></imu>", "neither true nor false"),
    (
        "imu",
        "<imu><orientation_reference_frame><localization>UP</localization></orientation_reference_frame></imu>",
        "unknown localization 'UP'. Valid: CUSTOM, ENU, NWU, NED",
    ),
    (
        "imu",
        "<imu><angular_velocity><x><noise type='gaussian'><stddev>nan</stddev></noise></x></angular_velocity></imu>",
        "stddev is 'nan', which is not finite",
    ),
    (
        "altimeter",
        (
            "<altimeter><vertical_position><noise><type>gaussian</type><stddev>-1</stddev></noise></vertical_position>"
            "</altimeter>"
        ),
        "stddev is '-1', but it must be at least 0",
    ),
    (
        "magnetometer",
        "<magnetometer><y><noise type='brown'/></y></magnetometer>",
        "unknown noise type 'brown'. Valid: none, gaussian, gaussian_quantized",
    ),
    (
        "air_pressure",
        "<air_pressure><reference_altitude>high</reference_altitude></air_pressure>",
        "reference_altitude is 'high', which is not a number",
    ),
    (
        "imu",
        '<plugin filename="libgazebo_ros_imu_sensor.so" name="p"><gaussianNoise>-1</gaussianNoise></plugin>',
        "gaussianNoise is '-1', but it must be at least 0",
    ),
]


@pytest.mark.parametrize(("kind", "inside", "what"), WRONG)
def test_a_wrong_value_is_refused_with_its_line(tmp_path, kind, inside, what):
    with pytest.raises(InputError) as raised:
        twin_with(tmp_path, "\n\n" + on_box(kind, inside))
    error = raised.value
    assert what in str(error)
    assert (Path(error.file).name, error.line) == ("box.urdf", 5)


def test_a_wrong_direction_or_frame_of_a_wrench_is_refused_with_the_choices(tmp_path):
    joint = '<joint name="j" type="fixed"><parent link="box"/><child link="a"/></joint><link name="a"/>'
    for inside, what in (
        ("<frame>world</frame>", "unknown frame 'world'. Valid: child, parent, sensor"),
        ("<measure_direction>up</measure_direction>", "unknown measure_direction 'up'. Valid: child_to_parent"),
    ):
        text = (
            f'<gazebo reference="j"><sensor name="s" type="force_torque"><force_torque>{inside}</force_torque></sensor>'
        )
        with pytest.raises(InputError, match=what.replace(".", r"\.")):
            twin_with(tmp_path, joint, f"{text}</gazebo>")


def test_the_program_ends_with_exit_code_2_and_one_paragraph(tmp_path):
    kind, inside, what = WRONG[6]
    file = write(tmp_path / "box.urdf", BODY.format(on_box(kind, inside)))
    command = [sys.executable, "-m", "drake_twin.run", str(file), "--headless", "--duration", "0.01"]
    run = subprocess.run(command, capture_output=True, text=True, check=False)
    assert run.returncode == 2
    assert what in run.stderr
    assert "Traceback" not in run.stderr


def test_a_rate_of_zero_is_every_step(tmp_path):
    twin = twin_with(tmp_path, on_box("imu", "<update_rate>0</update_rate>"))
    times = []
    twin.subscribe("/box/s/imu", lambda message: times.append(message.header.stamp.nanosec))
    twin.advance_to(0.01)
    assert len(times) == 10


def test_a_world_on_another_planet_or_beyond_a_pole_is_nowhere_and_that_is_said(tmp_path):
    for inside, what in (
        ("<surface_model>MOON_SCS</surface_model>", "unknown surface_model 'MOON_SCS': it is left out"),
        ("<latitude_deg>91</latitude_deg>", "latitude_deg is '91', but it must be -90 to 90"),
        ("<elevation>x</elevation>", "elevation is 'x', which is not a number"),
    ):
        twin = twin_with(tmp_path, on_box("navsat"), world=f"<spherical_coordinates>{inside}</spherical_coordinates>")
        assert [finding for finding in twin.findings if what in finding.what]
        assert twin.built.world_file.surroundings.spherical is None


TAGS = (
    *("imu", "angular_velocity", "linear_acceleration", "x", "y", "z", "noise", "mean", "stddev", "type", "plugin"),
    *("orientation_reference_frame", "localization", "custom_rpy", "enable_orientation", "force_torque", "frame"),
    *("measure_direction", "force", "torque", "contact", "collision", "topic", "navsat", "gps", "position_sensing"),
    *("horizontal", "vertical", "magnetometer", "altimeter", "vertical_position", "air_pressure", "pressure"),
    *("reference_altitude", "gaussianNoise", "gaussian_noise", "xyz_offset", "rpy_offsets", "ros", "namespace"),
    *("remapping", "argument", "frame_name", "body_name", "initial_orientation_as_reference"),
    *("camera", "image", "width", "height", "format", "clip", "near", "far", "horizontal_fov", "distortion", "k1"),
    *("center", "lens", "intrinsics", "projection", "fx", "cx", "p_fx", "tx", "depth_camera", "delay", "cameraName"),
    *("camera_info_topic", "camera_name", "focal_length", "rectification_matrix", "min_depth", "max_depth"),
    *("lidar", "ray", "scan", "samples", "resolution", "min_angle", "max_angle", "range", "min", "max", "output_type"),
    *("topicName", "frameName", "radiation", "logical_camera", "aspect_ratio", "pose", "update_rate", "frame_id"),
)
TEXTS = st.one_of(
    st.sampled_from(["", "0", "-1", "1e400", "nan", "true", "1 2 3", "gaussian", "ENU", "~/out:=/x", "'", ":=", "a:="]),
    st.text(st.characters(blacklist_categories=("Cs", "Cc")), max_size=8),
)


def elements(depth):
    children = st.just(()) if depth == 0 else st.lists(st.deferred(lambda: elements(depth - 1)), max_size=4)
    return st.tuples(st.sampled_from(TAGS), TEXTS, children)


def built(tree, parent):
    tag, text, children = tree
    libraries = {"camera": "camera", "depth": "camera", "ray": "ray_sensor", "gpu_ray": "range"}
    library = libraries.get(parent.get("type"), "imu_sensor")
    element = etree.SubElement(parent, tag, **({"filename": f"libgazebo_ros_{library}.so"} if tag == "plugin" else {}))
    if tag == "noise":
        element.set("type", text)
    element.text = text
    for child in children:
        built(child, element)


@given(st.sampled_from(sorted(SENSORS)), st.lists(elements(4), max_size=5))
@example("imu", [("plugin", "", [("ros", "", [("argument", "'", ())])])])
@settings(max_examples=60, deadline=None)
def test_any_element_is_planned_or_refused_in_a_paragraph(kind, trees):
    if kind in SENSOR_PLUGINS:
        root = etree.Element("plugin", name="s", filename=f"lib{kind}.so")
    else:
        root = etree.Element("sensor", name="s", type=kind)
    for tree in trees:
        built(tree, root)
    text = etree.tostring(root, encoding="unicode")
    places = tuple(Place("f", line) for line in range(len(list(root.iter()))))
    sensor = Sensor("s", kind, link="l", joint="j", gazebo_link="l", text=text, places=places)
    element = SensorElement(sensor)
    cls = sensor_class(kind)
    try:
        read = cls.read(element)
        list(element.unread())
        assert read == cls.read(SensorElement(sensor))  # plans are compared
        cls.problem(read)
        list(cls.topics(sensor, read, "/base"))
    except InputError:
        return


@given(
    st.sampled_from([*sorted(SENSORS), "thermal", ""]), st.lists(elements(3), max_size=4), st.booleans(), st.booleans()
)
@settings(max_examples=100, deadline=None)
def test_any_sensor_of_a_world_is_planned_or_refused_in_a_paragraph(kind, trees, is_static, is_nested):
    root = etree.fromstring('<sdf version="1.9"><world name="w"><model name="m"><static/></model></world></sdf>')
    model = root.find("world/model")
    model[0].text = str(is_static)
    place = etree.SubElement(model, "model", name="n") if is_nested else model
    sensor = etree.SubElement(etree.SubElement(place, "link", name="l"), "sensor", name="s", type=kind)
    for tree in trees:
        built(tree, sensor)
    with TemporaryDirectory() as folder:
        file = Path(folder, "w.sdf")
        file.write_bytes(etree.tostring(root))
        try:
            (found,) = read_world(str(file), PackageIndex(())).models
            assert "<sensor" not in found.text
            (plan,) = plan_models([found], {})
        except InputError as error:
            if error.file is None:
                raise
            return
    assert plan.name == ("m::n" if is_nested else "m")
    assert plan.sensors or plan.findings


@given(st.lists(st.text(max_size=20), max_size=4), st.sampled_from(["parameter_bridge", "image_bridge"]))
@example(["/imu@sensor_msgs/msg/Imu[gz.msgs.IMU"], "parameter_bridge")
@settings(deadline=None)
def test_any_line_of_a_bridge_is_read_or_a_finding(words, executable):
    process = LaunchedProcess(
        package="ros_gz_bridge",
        kind="node",
        executable=executable,
        name="b",
        namespace="/",
        arguments=tuple(words),
        place=Place("f", 3),
    )
    findings = []
    lines = bridge_lines(process, findings)
    own = [word for word in words if word and not word.startswith("-")]
    assert len(lines) + len(findings) <= len(own)
    assert all(line.gz.startswith("/") for line in lines)


def test_no_sensors_are_no_plans():
    from urdf_text import parse_urdf

    description = parse_urdf('<robot name="r"><link name="a"/></robot>', None)
    assert plan_sensors(Robot("r", "r.urdf"), description, "") == ((), ())


def test_a_pose_that_is_relative_to_an_unknown_frame_is_relative_to_the_link(tmp_path):
    text = "<update_rate>0</update_rate><pose relative_to='{}'>0 0 0 0 0 0.5</pose>"
    twin = twin_with(tmp_path, on_box("imu", text.format("gone")))
    (finding,) = [item for item in twin.findings if item.rule == "sensor_frame"]
    assert "the sensor's pose is relative to the unknown frame 'gone': it is relative to its link" in finding.what
    assert not [item for item in twin_with(tmp_path, on_box("imu", text.format("box"))).findings if item.rule]
