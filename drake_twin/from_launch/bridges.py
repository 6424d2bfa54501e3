"""The Gazebo topics that a parameter_bridge renames."""

from collections.abc import Iterator
from pathlib import Path

from drake_twin.description.yaml_document import YamlDocument
from drake_twin.from_launch.launched_robots import parameters
from drake_twin.ros2.launched import LaunchedProcess


def bridged_topics(process: LaunchedProcess) -> dict[str, str]:
    """Return Gazebo topic → ROS topic of a parameter_bridge, if the names differ."""
    found = {}
    for word in process.arguments:
        topic = word.partition("@")[0]
        if "@" in word and process.resolve(topic) != topic:
            found[topic if topic.startswith("/") else f"/{topic}"] = process.resolve(topic)
    in_file = {f"/{gz.strip('/')}": process.resolve(ros) for gz, ros, _ in _entries(process)}
    return found | {gz: ros for gz, ros in in_file.items() if gz != ros}


def stamped_topics(process: LaunchedProcess) -> tuple[str, ...]:
    """Return the Gazebo topics of a parameter_bridge that are ``TwistStamped`` in ROS."""
    words = [word.partition("@") for word in process.arguments if "@" in word]
    found = [topic for topic, _, kinds in words if kinds.startswith(_STAMPED)]
    found += [gz for gz, _, kind in _entries(process) if kind == _STAMPED]
    return tuple(f"/{topic.strip('/')}" for topic in found)


_STAMPED = "geometry_msgs/msg/TwistStamped"


def _entries(process: LaunchedProcess) -> Iterator[tuple[str, str, str]]:
    """Yield Gazebo topic, ROS topic and ROS type of each entry in the file of a bridge."""
    name = parameters(process).get("config_file")
    if not isinstance(name, str) or not Path(name).is_file():
        return
    entries = YamlDocument(Path(name).read_text(encoding="utf-8"), Path(name)).data
    for entry in entries if isinstance(entries, list) else []:
        if isinstance(entry, dict):
            ros = str(entry.get("ros_topic_name") or entry.get("topic_name") or "")
            gz = str(entry.get("gz_topic_name") or entry.get("topic_name") or ros)
            if ros and gz:
                yield gz, ros, str(entry.get("ros_type_name") or "")
