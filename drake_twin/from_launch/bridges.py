"""The Gazebo topics that the bridges of a launch file carry: parameter_bridge and image_bridge."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import field
from difflib import get_close_matches
from pathlib import Path
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.source_file import file_text
from drake_twin.description.yaml_document import YamlDocument
from drake_twin.errors import did_you_mean
from drake_twin.findings import Finding, Kind, Place
from drake_twin.from_launch.launched_robots import parameters
from drake_twin.messages import known_types
from drake_twin.ros2.launched import LaunchedProcess, absolute_name
from drake_twin.values import is_true

_PACKAGES = ("ros_gz_bridge", "ros_ign_bridge", "ros_gz_image", "ros_ign_image")
_STAMPED = "geometry_msgs/msg/TwistStamped"
_IMAGE = "sensor_msgs/msg/Image"
_TYPES = ("ros_type_name", "gz_type_name")
_KEYS = (
    *("topic_name", "ros_topic_name", "gz_topic_name", *_TYPES, "direction"),
    *("publisher_queue", "subscriber_queue", "lazy", "qos_profile", "frame_id"),
)
_OTHER_PACKAGES = ("ros_gz_interfaces", "ros_ign_interfaces", "actuator_msgs", "gps_msgs", "vision_msgs")
_DIRECTIONS = {"@": "BIDIRECTIONAL", "[": "GZ_TO_ROS", "]": "ROS_TO_GZ"}


@dataclass(frozen=True)
class BridgeLine:
    """One topic of a bridge.

    Attributes:
        gz: Its name in Gazebo, with a leading slash.
        ros: Its name in ROS.
        ros_type: The ROS message type; empty where the line gives none.
        direction: ``GZ_TO_ROS``, ``ROS_TO_GZ`` or ``BIDIRECTIONAL``.
        place: Where it was written.
    """

    gz: str
    ros: str
    ros_type: str = ""
    direction: str = "BIDIRECTIONAL"
    place: Place = field(default=Place(""), compare=False)

    @property
    def is_to_ros(self) -> bool:
        """Whether ROS hears what Gazebo publishes."""
        return self.direction != "ROS_TO_GZ"


def is_bridge(process: LaunchedProcess) -> bool:
    """Return whether a node is a bridge of topics."""
    return process.package in _PACKAGES and process.executable in ("parameter_bridge", "bridge_node", "image_bridge")


def bridge_lines(
    process: LaunchedProcess, findings: list[Finding], written: Mapping[str, str] | None = None
) -> tuple[BridgeLine, ...]:
    """Return the topics of a bridge.

    Args:
        process: The bridge.
        findings: Takes what cannot be read, with which ROS's bridge would end.
        written: The texts of files that the launch writes, see `WrittenFiles`.
    """
    words = [word for word in process.arguments if word and not word.startswith("-")]
    if process.executable == "image_bridge":
        return tuple(_line(process, word, word, _IMAGE, "GZ_TO_ROS", process.place) for word in words)
    found = []
    for word in words:
        topic, at, kinds = word.partition("@")
        place = min((kinds.find(mark) for mark in _DIRECTIONS if mark in kinds), default=-1)
        service = "/srv/" in word and place < 0
        if not topic or not at or (place <= 0 and not service):
            what = f"{process.what}: {word!r} is not TOPIC@ROS_TYPE@GZ_TYPE, with [ or ] for one direction only"
            findings.append(Finding.at(Kind.REFUSED_BY_ROS, what, process.place))
        elif not service:
            direction = _DIRECTIONS[kinds[place]]
            found.append(_line(process, topic, topic, kinds[:place], direction, process.place))
    lines = (*found, *_in_file(process, findings, written or {}))
    for line in lines:
        if (close := _close_type(line.ros_type)) is not None:
            what = f"{process.what}: unknown type {line.ros_type!r} of {line.ros}. Did you mean {close!r}?"
            findings.append(Finding.at(Kind.REFUSED_BY_ROS, what, line.place))
    return lines


def _close_type(name: str) -> str | None:
    """Return the message type that an unknown one is close to; other packages have types that the twin lacks."""
    if not name or name in known_types() or name.partition("/")[0] in _OTHER_PACKAGES:
        return None
    return next(iter(get_close_matches(name, sorted(known_types()), n=1, cutoff=0.85)), None)


def _wrong_keys(process: LaunchedProcess, entry: Any, document: YamlDocument, index: int) -> Iterator[Finding]:
    """Report the keys of an entry that ROS's bridge does not read."""
    for key in (key for key in map(str, entry if isinstance(entry, dict) else ()) if key not in _KEYS):
        place = Place(str(document.file), document.line((index, key)))
        what = f"{process.what}: {key} of an entry of its file{did_you_mean(key, _KEYS)}"
        yield Finding.at(Kind.IGNORED, what, place)


def renamed(lines: Iterable[BridgeLine]) -> dict[str, str]:
    """Return Gazebo topic → ROS topic."""
    return {line.gz: line.ros for line in lines}


def stamped(lines: Iterable[BridgeLine]) -> tuple[str, ...]:
    """Return the Gazebo topics that are ``TwistStamped`` in ROS."""
    return tuple(line.gz for line in lines if line.ros_type == _STAMPED)


def _line(
    process: LaunchedProcess, gz: str, ros: str, ros_type: str, direction: str, place: Place, *, expand: bool = False
) -> BridgeLine:
    name = absolute_name(gz, process.namespace) if expand else f"/{gz.strip('/')}"
    return BridgeLine(name, process.resolve(ros), ros_type, direction, place)


def _in_file(process: LaunchedProcess, findings: list[Finding], written: Mapping[str, str]) -> Iterator[BridgeLine]:
    """Yield the topics in the YAML file of a bridge."""
    given = parameters(process)
    name = given.get("config_file")
    if not isinstance(name, str) or not name:
        return
    file = Path(name)
    if name not in written and not file.is_file():
        # ROS ends with an error only if no other program of the launch has written the file by then.
        what = f"{process.what}: its config_file {name} does not exist"
        findings.append(Finding.at(Kind.NOT_STARTED, what, process.place))
        return
    text = written[name] if name in written else file_text(file, errors="replace")
    document = YamlDocument(text, file)
    entries = document.data
    if not isinstance(entries, list):
        what = f"{process.what}: its config_file is not a list of topics"
        findings.append(Finding.at(Kind.REFUSED_BY_ROS, what, Place(str(file))))
        return
    expand = is_true(str(given.get("expand_gz_topic_names", False)))
    for index, entry in enumerate(entries):
        place = Place(str(file), document.line((index,)))
        findings += _wrong_keys(process, entry, document, index)
        values = {key: str(value) for key, value in entry.items() if value} if isinstance(entry, dict) else {}
        gz = values.get("gz_topic_name") or values.get("topic_name") or values.get("ros_topic_name", "")
        ros = values.get("ros_topic_name") or values.get("topic_name") or values.get("gz_topic_name", "")
        direction = values.get("direction", "BIDIRECTIONAL")
        if not gz or direction not in _DIRECTIONS.values():
            valid = ", ".join(_DIRECTIONS.values())
            why = f"its direction is {direction!r}, where valid are {valid}" if gz else "it names no topic"
            findings.append(Finding.at(Kind.REFUSED_BY_ROS, f"{process.what}: an entry of its file: {why}", place))
            continue
        if missing := [key for key in _TYPES if key not in values]:
            what = f"{process.what}: an entry of its file has no {' and no '.join(missing)}"
            findings.append(Finding.at(Kind.REFUSED_BY_ROS, what, place))
        yield _line(process, gz, ros, values.get("ros_type_name", ""), direction, place, expand=expand)
