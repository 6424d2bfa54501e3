"""Robots whose sensors have names, and the tables of these names."""

from hinge import create, launched
from launch_files import write

INERTIAL = '<inertial><mass value="1"/><inertia ixx=".1" iyy=".1" izz=".1" ixy="0" ixz="0" iyz="0"/></inertial>'


def table(twin):
    """The topics of sensors: (topic, type, frame, rate)."""
    found = {}
    for plan in twin.built.plans:
        for item in plan.sensors:
            for topic in item.topics:
                if topic.topic is not None:
                    assert twin.graph.topics()[topic.topic] == topic.type
                    found[topic.topic] = (topic.type, item.frame, item.rate)
    return found


def gazebo(inside="", link="imu_link", name="s", kind="imu"):
    return f'<gazebo reference="{link}"><sensor name="{name}" type="{kind}">{inside}</sensor></gazebo>'


def spawned(tmp_path, text, name, *more):
    suffix = "sdf" if "<sdf" in text else "urdf"
    file = write(tmp_path / f"{name}.{suffix}", text)
    return launched(tmp_path, create("-file", file, "-name", name, "-z", 0.1), *more).scenario
