"""How a launch file wants a robot's frames: the parameters of its robot_state_publisher."""

from typing import Any

from drake_twin.from_launch.launched_robots import parameters
from drake_twin.ros2.launched import LaunchedProcess
from drake_twin.scenario import Robot
from drake_twin.values import is_number


def frame_prefix(publisher: LaunchedProcess | None) -> str:
    """Return the text before the links' names, without the leading slash that tf2 strips."""
    given = {} if publisher is None else parameters(publisher)
    prefix = given.get("frame_prefix")
    return prefix.removeprefix("/") if isinstance(prefix, str) else ""


def publish_frequency(publisher: LaunchedProcess | None) -> float:
    """Return the highest rate of the moving joints (Hz), by default robot_state_publisher's."""
    given = {} if publisher is None else parameters(publisher)
    rate: Any = given.get("publish_frequency")
    return float(rate) if is_number(rate) else Robot.publish_frequency
