"""The sensors that a robot's file describes: which are simulated, on which topics, and what is said of the others."""

import pytest

from drake_twin.description.package_index import PackageIndex
from drake_twin.findings import Kind
from drake_twin.planning.plan_robot import plan_robot
from drake_twin.planning.sensor_plan import is_same_topic
from drake_twin.scenario import Robot

BOX = """<robot name="box"><link name="body"/><link name="arm"/>
<joint name="elbow" type="continuous"><parent link="body"/><child link="arm"/></joint>
{}
</robot>"""
TOPIC = "/world/w/model/box/link/body/sensor/s/imu"  # gz sim's name, and the field's: gz topic -l lists it so


def sensor(kind="imu", inside="", name="s", on="body"):
    return f'<gazebo reference="{on}"><sensor name="{name}" type="{kind}">{inside}</sensor></gazebo>'


@pytest.fixture
def plan(tmp_path):
    def plan(*sensors, **options):
        (tmp_path / "box.urdf").write_text(BOX.format("\n".join(sensors)))
        return plan_robot(Robot("box", str(tmp_path / "box.urdf"), **options), PackageIndex())

    return plan


def topics(plan):
    return [{topic.own: topic.topic for topic in item.topics} for item in plan.sensors]


def said(plan, kind):
    return [item.what for item in plan.findings if item.kind is kind and "sensor" in item.what]


def test_a_sensor_has_its_topic_below_the_robots_namespace_and_its_name_in_gazebo(plan):
    (found,) = plan(sensor(inside="<update_rate>50</update_rate>")).sensors
    (topic,) = found.topics
    assert (topic.topic, topic.type) == ("/box/s/imu", "sensor_msgs/msg/Imu")
    assert is_same_topic(topic.in_gazebo, TOPIC)
    assert (found.rate, found.place, found.frame) == (50.0, "body/s", "box/body/s")


@pytest.mark.parametrize("ros", ["/imu", None])
def test_where_bridges_run_a_sensor_is_heard_only_if_one_carries_it(plan, ros):
    found = plan(sensor(), bridged={} if ros is None else {TOPIC: ros})
    assert [list(item.values()) for item in topics(found)] == [[ros]]
    assert ["no bridge carries" in what for what in said(found, Kind.WARNING)] == ([True] if ros is None else [])
    assert found.sensors[0].as_plain()["topics"] == ({} if ros is None else {"/imu": "sensor_msgs/msg/Imu"})


def test_without_bridges_nothing_is_said_of_a_sensor_that_is_well(plan):
    assert said(plan(sensor()), Kind.WARNING) == said(plan(sensor()), Kind.NOT_STARTED) == []


@pytest.mark.parametrize(
    ("kind", "on", "why"),
    [
        ("thermal", "body", "the twin has no such sensor"),
        ("imu", "elbow", "such a sensor is on a link, and this is not one"),
        ("force_torque", "body", "such a sensor is on a joint, and this is not one"),
    ],
)
def test_a_sensor_that_cannot_be_where_it_is_is_not_started_and_why(plan, kind, on, why):
    found = plan(sensor(kind, on=on))
    (what,) = said(found, Kind.NOT_STARTED)
    assert (what.endswith(f": {why}"), found.sensors) == (True, ())


def test_of_two_sensors_on_one_topic_the_first_publishes_it(plan):
    found = plan(*(sensor(inside="<topic>/imu</topic>", name=name) for name in ("front", "rear")))
    assert [list(item.values()) for item in topics(found)] == [["/box/imu"], []]
    (what,) = said(found, Kind.WARNING)
    assert "sensor 'front' publishes on /box/imu, too" in what


def test_a_sensor_of_a_joint_is_named_by_it(plan):
    (found,) = plan(sensor("force_torque", on="elbow")).sensors
    assert found.place == "elbow/s"
