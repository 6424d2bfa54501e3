"""A sensor from its file to its topic: names, frames, rates, stamps, and what nobody listens to."""

from math import atan2

import pytest

from drake_twin import TwinBuilder
from drake_twin.findings import Kind
from drake_twin.sensors.imu_sensor import ImuSensor

BODY = """<robot name="box"><link name="box"><inertial><mass value="1"/>
  <inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>
  <collision><geometry><box size=".4 .4 .2"/></geometry></collision></link>
  {}</robot>"""


def twin_with(tmp_path, *sensors, name="box", **options):
    (tmp_path / "box.urdf").write_text(BODY.format("".join(sensors)))
    return TwinBuilder().robot(name, tmp_path / "box.urdf", xyz=(0, 0, 0.1), **options).build()


def imu(inside="", name="imu"):
    return f'<gazebo reference="box"><sensor name="{name}" type="imu">{inside}</sensor></gazebo>'


def heard(twin, topic, rate=None):
    messages = []
    twin.subscribe(topic, messages.append, rate)
    return messages


def stamps(messages):
    return [item.header.stamp.sec + item.header.stamp.nanosec * 1e-9 for item in messages]


def test_an_imu_publishes_its_own_topic_at_its_rate_with_its_frame(tmp_path):
    twin = twin_with(tmp_path, imu("<topic>/imu</topic><update_rate>40</update_rate>"))
    assert twin.graph.topics()["/box/imu"] == "sensor_msgs/msg/Imu"
    messages = heard(twin, "/box/imu")
    twin.advance_to(0.5)
    assert stamps(messages) == pytest.approx([k / 40 for k in range(20)], abs=1e-9)
    assert messages[-1].header.frame_id == "box/box/imu"
    assert messages[-1].linear_acceleration.z == pytest.approx(9.81, abs=1e-3)


@pytest.mark.parametrize(("asked", "got"), [(7, 5), (100, 10), (10, 10), (2, 2), (3.4, 10 / 3)])
def test_a_listener_with_a_rate_of_its_own_hears_measurements_of_the_sensors_times(tmp_path, asked, got):
    twin = twin_with(tmp_path, imu("<update_rate>10</update_rate>"))
    messages = heard(twin, "/box/imu/imu", asked)
    twin.advance_to(2.01)
    times = stamps(messages)
    assert times == pytest.approx([k / got for k in range(len(times))], abs=2e-3)
    assert all(abs(time * 10 - round(time * 10)) < 1e-6 for time in times)
    assert len(times) == pytest.approx(2 * got, abs=1)


def test_a_rate_off_the_grid_of_steps_is_met_at_the_first_step_that_is_not_before(tmp_path):
    twin = twin_with(tmp_path, imu("<update_rate>30</update_rate>"))
    messages = heard(twin, "/box/imu/imu")
    twin.advance_to(0.11)
    assert stamps(messages) == pytest.approx([0.0, 0.034, 0.067, 0.1], abs=1e-9)


def test_nobody_listens_and_nothing_is_computed(tmp_path, monkeypatch):
    calls = []
    real = ImuSensor._calc_spatial
    monkeypatch.setattr(ImuSensor, "_calc_spatial", lambda *args: (calls.append(1), real(*args)))
    twin = twin_with(tmp_path, imu("<update_rate>100</update_rate>"))
    twin.advance_to(0.5)
    assert calls == []
    end = twin.subscribe("/box/imu/imu", lambda message: None)
    twin.advance_to(1.0)
    assert len(calls) == 50
    end()
    twin.advance_to(1.5)
    assert len(calls) == 50


def test_the_state_is_the_same_with_and_without_listeners(tmp_path):
    hashes = set()
    for listens in (False, True):
        twin = twin_with(tmp_path, imu("<update_rate>100</update_rate>"))
        if listens:
            twin.subscribe("/box/imu/imu", lambda message: None)
        twin.advance_to(0.3)
        hashes.add(twin.state_sha256())
    assert len(hashes) == 1


def test_an_unknown_kind_is_not_started_and_says_where(tmp_path):
    twin = twin_with(tmp_path, '<gazebo reference="box">\n<sensor name="eye" type="thermal"/></gazebo>')
    (finding,) = [item for item in twin.findings if "thermal" in item.what]
    assert (finding.kind, finding.lines) == (Kind.NOT_STARTED, (5,))
    assert finding.what == "sensor 'eye' of type thermal on 'box': the twin has no such sensor"


def test_of_two_sensors_of_one_name_on_a_link_gazebo_makes_the_first(tmp_path):
    """SensorManager::CreateSensor and sdf::Link::Load refuse the second; Talos describes its depth camera twice."""
    twice = '<sensor name="eye" type="depth"><update_rate>{}</update_rate></sensor>'
    twin = twin_with(tmp_path, f'<gazebo reference="box">\n{twice.format(6)}\n{twice.format(7)}</gazebo>')
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.lines == (6,)
    assert "a sensor before it has this name" in finding.what
    assert [item.rate for item in twin.built.plans[0].sensors] == [6.0]


def test_what_no_kind_reads_is_ignored_with_its_line(tmp_path):
    twin = twin_with(
        tmp_path, imu("<imu>\n<magic/><angular_velocity><x><noise type='none'/></x></angular_velocity></imu>")
    )
    (finding,) = [item for item in twin.findings if "magic" in item.what]
    assert (finding.kind, finding.what, finding.lines) == (Kind.IGNORED, "<magic> in <imu> of sensor 'imu'", (5,))


def test_an_imu_without_orientation_says_so_as_the_message_defines_it(tmp_path):
    inside = "<imu><enable_orientation>false</enable_orientation></imu>"
    message = twin_with(tmp_path, imu(inside), rpy=(0, 0, 1.0)).latest("/box/imu/imu")
    assert message.orientation_covariance[0] == -1.0
    turn = message.orientation
    assert (turn.w, turn.x, turn.y, turn.z) == (1.0, 0.0, 0.0, 0.0)


def test_an_imu_of_gazebo_classic_measures_its_orientation_in_the_world(tmp_path):
    """REP 145: gazebo_ros_imu_sensor.cpp sets the reference to the identity unless it is told otherwise."""
    plugin = '<plugin name="p" filename="libgazebo_ros_imu_sensor.so">{}</plugin>'
    for inside, expected in (
        ("", 1.0),
        ("<initial_orientation_as_reference>true</initial_orientation_as_reference>", 0.0),
    ):
        message = twin_with(tmp_path, imu(plugin.format(inside)), rpy=(0, 0, 1.0)).latest("/box/p/out")
        turn = message.orientation
        assert 2 * atan2(turn.z, turn.w) == pytest.approx(expected)


def test_ros_1s_imu_plugin_of_a_model_has_noise_on_all_ten_numbers(tmp_path):
    plugin = """<gazebo><plugin name="p" filename="libgazebo_ros_imu.so"><bodyName>box</bodyName>
      <topicName>imu/data</topicName><updateRate>20</updateRate><gaussianNoise>0.1</gaussianNoise></plugin></gazebo>"""
    twin = twin_with(tmp_path, plugin)
    messages = heard(twin, "/box/imu/data")
    twin.advance_to(0.5)
    assert len(messages) == 10
    for part, names in (("orientation", "wxyz"), ("angular_velocity", "xyz"), ("linear_acceleration", "xyz")):
        for name in names:
            assert len({getattr(getattr(message, part), name) for message in messages}) == 10
        assert getattr(messages[0], f"{part}_covariance")[4] == pytest.approx(0.01)
