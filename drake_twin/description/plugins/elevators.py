"""The system of gz-sim that drives an elevator: a controller, and what joins it to the joints' own controllers."""

import re
from collections.abc import Iterator
from typing import Any

import numpy as np

from drake_twin.dataclass import dataclass
from drake_twin.description.elevator_shaft import Shaft
from drake_twin.description.gazebo_drive import (
    ELEVATOR,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    as_rate,
    gazebo_plugin,
)
from drake_twin.description.gz_messages import Leaf
from drake_twin.description.triggers import Match, Trigger, TriggeredMessage
from drake_twin.description.wheel_geometry import link_poses

_NUMBER, _FLAG = "std_msgs/msg/Float64", "std_msgs/msg/Bool"
_SCAN, _NUMBERS = "sensor_msgs/msg/LaserScan", "std_msgs/msg/Int32MultiArray"
_NEARER = 0.005  # m; a beam that is shorter than its range by more than that meets something


@dataclass(frozen=True)
class Doorway:
    """Whether the first beam of a scan meets something, or not."""

    is_blocked: bool

    def holds(self, message: Any) -> bool:
        """Tell whether it is so."""
        return len(message.ranges) > 0 and self.is_blocked == (message.ranges[0] < message.range_max - _NEARER)


@gazebo_plugin("gz-sim-elevator-system")
def elevator_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-elevator-system`` to the twin's own controller of this kind."""
    cabin = plugin.text("cabin_joint", "lift")
    heights = _floor_heights(plugin, plugin.text("floor_link_prefix", "floor_"))
    prefix = plugin.text("door_joint_prefix", "door_")
    doors = tuple(f"{prefix}{floor}" for floor in range(len(heights)))
    plugin.check_joints((cabin, *doors))
    positions = [plugin.description.joints_by_name[door].limits.upper for door in doors]
    if unbounded := next((door for door, at in zip(doors, positions, strict=True) if not np.isfinite(at)), None):
        raise CannotWorkError(f"the door {unbounded!r} has no upper limit to open to")
    wait, rate = plugin.number("open_door_wait_duration", 5.0), plugin.number("state_publish_rate", 5.0)
    parameters = {
        "cabin_joint": cabin,
        "floor_heights": list(heights),
        "door_joints": list(doors),
        "open_door_positions": positions,
        "open_door_wait_duration": max(wait, 0.0),
        "state_publish_rate": max(rate, 0.0),
        "update_rate": as_rate(plugin.number("update_rate", 10.0)),
    }
    gz = {"cmd": ("cmd_topic", "cmd"), "floor": ("state_topic", "state")}
    topics, gz_topics = plugin.gz_topics(gz)
    own = {f"doorway_{floor}": f"elevator/doorway_{floor}" for floor in range(len(heights))}
    own["orders"] = "elevator/orders"
    return plugin.drive(
        ELEVATOR,
        parameters,
        topics=topics | own,
        gz_topics=gz_topics | {name: f"/model/{{model}}/{topic}" for name, topic in own.items()},
        triggers=tuple(_triggers(plugin, cabin, doors, Shaft(heights, tuple(positions), wait))),
    )


def _floor_heights(plugin: DrivePlugin, prefix: str) -> tuple[float, ...]:
    """Return the heights of the floors' links above the model's frame (m)."""
    description = plugin.description
    pattern = re.compile(f"{re.escape(prefix)}[0-9]+")
    names = [f"{prefix}{number}" for number in range(sum(map(bool, map(pattern.fullmatch, description.links))))]
    if not names:
        raise CannotWorkError(f"the robot has no link {prefix + '0'!r}")
    poses, root = link_poses(description), description.root_pose.transform().GetAsMatrix4()
    loose = {name: pose.transform().GetAsMatrix4() for name, pose in description.loose_links.items()}
    places = {name: root @ pose for name, pose in poses.items()} | loose
    missing = next((name for name in names if name not in places), None)
    if missing is not None:
        raise CannotWorkError(f"the robot has no link {missing!r}")
    return tuple(float(places[name][2, 3]) for name in names)


def _triggers(plugin: DrivePlugin, cabin: str, doors: tuple[str, ...], shaft: Shaft) -> Iterator[Trigger]:
    """Yield what hands the orders on to the joints' controllers, and what tells of a blocked doorway."""

    def ordered(number: int, joint: str, position: float) -> Trigger:
        is_meant = Match((Leaf(("data",), (number,), is_in=True),))
        command = TriggeredMessage(f"/model/{{model}}/joint/{joint}/0/cmd_pos", _NUMBER, {"data": position})
        orders = "/model/{model}/elevator/orders"
        return Trigger(plugin.name, orders, _NUMBERS, (is_meant,), messages=(command,), place=plugin.plugin.place)

    for floor, door in enumerate(doors):
        yield ordered(shaft.move(floor), cabin, shaft.floors[floor])
        yield ordered(shaft.open(floor), door, shaft.doors[floor])
        yield ordered(shaft.close(floor), door, 0.0)
        for is_blocked in (True, False):
            topic = f"/model/{{model}}/elevator/doorway_{floor}"
            told = TriggeredMessage(topic, _FLAG, {"data": is_blocked})
            lidar = f"/model/{{model}}/{door}/lidar"
            yield Trigger(
                plugin.name, lidar, _SCAN, (Doorway(is_blocked),), messages=(told,), place=plugin.plugin.place
            )
