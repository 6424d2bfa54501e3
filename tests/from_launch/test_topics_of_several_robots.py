"""Robots of one launch without namespaces: each hears its own commands, as in Gazebo."""

import pytest
from hinge import create, gz, launched, node
from launch_files import write
from waters import propelled, thruster

from drake_twin import Twin
from drake_twin.findings import Kind
from drake_twin.messages.interface_types import make

CMD = "joint/shaft/cmd_thrust"


def number(value):
    return make("std_msgs/msg/Float64", {"data": value})


def two(folder, *entities):
    """Two vehicles where nothing falls."""
    text = propelled((1.0, 0.4, 0.3), thruster(velocity_control=1))
    file = write(folder / "auv.sdf", f'<sdf version="1.9">{text}</sdf>')
    world = write(folder / "w.sdf", '<sdf version="1.9"><world name="w"><gravity>0 0 0</gravity></world></sdf>')
    spawned = [create("-file", file, "-name", name, "-y", y) for name, y in (("one", 0), ("two", 3))]
    return launched(folder, gz(f"-r {world}"), *spawned, *entities)


def velocities(twin):
    twin.advance_to(twin.time + 0.2)
    return [twin.entities.state(name).linear[0] for name in ("one", "two")]


def test_without_a_bridge_the_second_one_has_the_topics_of_gazebo(tmp_path):
    launch = two(tmp_path)
    (said,) = (item for item in launch.scenario.findings if "another robot has its topics" in item.what)
    assert (said.kind, said.robot) == (Kind.WARNING, "two")
    assert said.what.endswith("those of Gazebo: /model/two/joint/shaft")
    twin = Twin(launch.scenario)
    twin.publish(f"/{CMD}", number(20.0))
    first = velocities(twin)
    assert first[0] > 0.02
    assert first[1] == pytest.approx(0.0, abs=1e-9)
    twin.publish(f"/model/two/{CMD}", number(-20.0))
    assert velocities(twin)[1] < -0.02


def test_a_bridge_names_them(tmp_path):
    words = [f"/model/{name}/{CMD}@std_msgs/msg/Float64]gz.msgs.Double" for name in ("one", "two")]
    launch = two(tmp_path, node("ros_gz_bridge", "parameter_bridge", *words))
    assert not [item for item in launch.scenario.findings if "another robot has its topics" in item.what]
    twin = Twin(launch.scenario)
    twin.publish(f"/model/two/{CMD}", number(-20.0))
    one, other = velocities(twin)
    assert one == pytest.approx(0.0, abs=1e-9)
    assert other < -0.02
    topics = twin.graph.topics()
    assert {"/joint/shaft/ang_vel", "/model/two/joint/shaft/ang_vel"} <= set(topics)
