"""A sensor from its file to its topic: names, frames, rates, stamps, and what nobody listens to."""

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
    assert twin.topics()["/box/imu"] == "sensor_msgs/msg/Imu"
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


def test_what_no_kind_reads_is_ignored_with_its_line(tmp_path):
    twin = twin_with(
        tmp_path, imu("<imu>\n<magic/><angular_velocity><x><noise type='none'/></x></angular_velocity></imu>")
    )
    (finding,) = [item for item in twin.findings if "magic" in item.what]
    assert (finding.kind, finding.what, finding.lines) == (Kind.IGNORED, "<magic> in <imu> of sensor 'imu'", (5,))
