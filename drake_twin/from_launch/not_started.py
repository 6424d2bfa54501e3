"""The reasons why nodes of a launch file are not started."""

import re
from collections.abc import Collection, Iterator
from difflib import get_close_matches
from pathlib import Path

from drake_twin.findings import Finding, Kind, Place, at_places
from drake_twin.from_launch.launched_controllers import words_of
from drake_twin.ros2.launched import Launched, LaunchedProcess, UnfiredHandler

# A word of "package/executable" → the reason; the first match applies.
_WINDOWS = {
    **dict.fromkeys(("rviz", "rviz2", "plotjuggler", "foxglove"), "the page shows the robots"),
    "rqt": "it is a window of ROS",
    "gui": "it is a window",
    "gzclient": "the page shows the robots",
}
_REASONS = {
    "joint_state_publisher": "joint states come from the simulation",
    "teleop": "publish commands with --pub or on the page",
    "joy": "it reads a device: /joy will be missing; publish it by a node, for teleop_twist_joy",
    "amcl": "navigation is not a part of the twin: the transform from map to odom will be missing",
    "map_server": "navigation is not a part of the twin: /map will be missing",
    "nav2": "navigation is not a part of the twin: goals will not be planned or followed",
    **dict.fromkeys(
        ("slam", "cartographer", "rtabmap"),
        "mapping is not a part of the twin: /map and the transform from map to odom will be missing",
    ),
    **dict.fromkeys(
        ("moveit", "move_group"), "motion planning is not a part of the twin: /move_action and plans will be missing"
    ),
    "navsat": "localization is not a part of the twin: odometry/gps will be missing",
    **dict.fromkeys(
        ("robot_localization", "ekf", "ukf"),
        "localization is not a part of the twin but for robot_localization/ekf_node: its odometry and transform will be"
        " missing",
    ),
    **dict.fromkeys(
        ("image", "depth"), "processing pictures is not a part of the twin: what it publishes will be missing"
    ),
    "laser": "processing scans is not a part of the twin: what it publishes will be missing",
    "pointcloud": "processing points is not a part of the twin: what it publishes will be missing",
    "rosbag": "the twin records with --record",
}
_NO_PYTHON = "it is not a Python program of the workspace: publish its messages by --pub, or run a node by --node"
# Nodes of ROS packages whose work the twin does itself, or which serve Gazebo alone.
_EXECUTABLES = {
    "ros_gz_sim": {"create": "", "gzserver": "", "remove": "", "set_entity_pose": "it asks Gazebo's services"},
    "ros_gz_bridge": {"parameter_bridge": "", "static_bridge": "", "bridge_node": ""},
    "ros_ign_bridge": {"parameter_bridge": ""},
    "ros_ign_gazebo": {"create": ""},
    "gazebo_ros": {"spawn_entity.py": "", "gzserver": "", "gzclient": ""},
    "controller_manager": {"spawner": "", "unspawner": "", "ros2_control_node": "", "hardware_spawner": ""},
    "robot_state_publisher": {"robot_state_publisher": ""},
    "joint_state_publisher": {"joint_state_publisher": "joint states come from the simulation"},
    "teleop_twist_keyboard": {
        "teleop_twist_keyboard": "it needs a terminal: --node 'teleop_twist_keyboard teleop_twist_keyboard'"
    },
    "turtlesim": {
        "turtlesim_node": "",
        "mimic": "",
        "turtle_teleop_key": "it needs a terminal: --node 'turtlesim turtle_teleop_key'",
        "draw_square": "",
    },
    "rclcpp_components": {
        "component_container": "its components are looked at one by one",
        "component_container_mt": "its components are looked at one by one",
        "component_container_isolated": "its components are looked at one by one",
    },
    "tf2_ros": {"static_transform_publisher": "", "buffer_server": "", "tf2_echo": "", "tf2_monitor": ""},
    "xacro": {"xacro": ""},
}


def misspelt_package(process: LaunchedProcess) -> str | None:
    """Return the package that a node's executable is of, where the node names one that is close to it."""
    homes = [package for package, executables in _EXECUTABLES.items() if process.executable in executables]
    if not homes or process.package is None or process.package in homes:
        return None
    return next(iter(get_close_matches(process.package, homes, n=1, cutoff=0.8)), None)


def is_window(process: LaunchedProcess) -> bool:
    """Return whether an executable only displays something, as the page does."""
    return _reason(_WINDOWS, process.what) is not None


def calls_spawn(process: LaunchedProcess) -> bool:
    """Return whether a process calls a service that spawns: ``ros2 service call NAME PACKAGE/srv/SpawnEntity …``."""
    words = words_of(process)
    spawns = re.compile(r"\w+/srv/Spawn(Entity|Model)")
    return words[:3] == ["ros2", "service", "call"] and any(map(spawns.fullmatch, words[4:5]))


def why_not_started(process: LaunchedProcess) -> str:
    """Return ``PACKAGE/EXECUTABLE (reason)`` for an executable that the twin does not start."""
    what = process.what
    reason = _reason(_WINDOWS, what) or _reason(_REASONS, what)
    known = _EXECUTABLES.get(process.package or "")
    if known is not None and process.executable not in known:
        if near := get_close_matches(process.executable, known, n=1):
            reason = f"{process.executable!r} of {process.package} is unknown; did you mean {near[0]!r}?"
    elif known is not None:
        reason = known[process.executable] or reason
    if reason is None and process.package is None:
        reason = "of programs, the twin starts only Python nodes"
    return f"{what} ({reason or _NO_PYTHON})"


def never_happened(launched: Launched, file: Path, happens: Collection[UnfiredHandler]) -> Iterator[Finding]:
    """Yield findings of what a launch file has and nothing comes of.

    Args:
        launched: The result of its evaluation.
        file: The launch file.
        happens: The handlers whose event comes when a node has ended.
    """
    for include in launched.failed_includes:
        yield Finding.at(Kind.NOT_STARTED, f"include {include.what} ({include.reason})", include.place)
    for handler in (item for item in launched.unfired_handlers if item not in happens):
        yield Finding.at(Kind.NOT_STARTED, f"event handler ({handler.what} never happens)", handler.place)
    yield from at_places(Kind.REFUSED_BY_ROS, ((item.what, item.place) for item in launched.refused_by_ros))
    for name, close in launched.undeclared_arguments.items():
        hint = f". Did you mean {close!r}?" if close else ""
        yield Finding.at(Kind.NOT_STARTED, f"argument {name} (no file declares it){hint}", Place(str(file)))
    yield from at_places(Kind.IGNORED, ((item.what, item.place) for item in launched.lost_arguments))


def _reason(reasons: dict[str, str], what: str) -> str | None:
    words = set(re.split(r"[^a-z0-9]+", what.lower())) | set(re.split(r"[^a-z0-9_]+", what.lower()))
    for part, reason in reasons.items():
        if part in words or ("_" in part and part in what.lower()) or any(word.startswith(part) for word in words):
            return reason
    return None
