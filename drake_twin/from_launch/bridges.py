"""The Gazebo topics that a parameter_bridge renames."""

from pathlib import Path
from typing import Any

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
    files: list[Any] = [parameters(process).get("config_file")]
    for file in files:
        if isinstance(file, str) and Path(file).is_file():
            found |= _bridge_file(Path(file), process)
    return found


def _bridge_file(file: Path, process: LaunchedProcess) -> dict[str, str]:
    entries = YamlDocument(file.read_text(encoding="utf-8"), file).data
    found = {}
    for entry in entries if isinstance(entries, list) else []:
        if isinstance(entry, dict):
            ros = str(entry.get("ros_topic_name") or entry.get("topic_name") or "")
            gz = str(entry.get("gz_topic_name") or entry.get("topic_name") or ros)
            if ros and gz:
                found["/" + gz.strip("/")] = process.resolve(ros)
    return {gz: ros for gz, ros in found.items() if gz != ros}
