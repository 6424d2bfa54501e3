"""The systems of gz-sim that move belts and tracks: all those of a robot as one controller."""

from collections.abc import Sequence
from math import cos, inf, sin
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.description.controllers_yaml import DEFAULT_UPDATE_RATE
from drake_twin.description.gazebo_drive import (
    EACH_STEP,
    TRACKS,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    as_rate,
    gazebo_plugin,
)
from drake_twin.description.gazebo_plugins import plugin_kind
from drake_twin.description.plugins.gz_drives import gz_limits
from drake_twin.description.robot_description import GazeboPlugin
from drake_twin.description.surface_velocity import NEEDS, has_surface_velocity

_TRACK, _VEHICLE = "track-controller-system", "tracked-vehicle-system"


@dataclass(frozen=True)
class _Track:
    """A track.

    Attributes:
        link: Its link.
        parameters: Its parameters.
        topics: Its topics in ROS: the last part of its own one → the plugin's.
        gz_topics: The same in gz's transport.
    """

    link: str
    parameters: dict[str, Any]
    topics: dict[str, str]
    gz_topics: dict[str, str]


@gazebo_plugin("gz-sim-track-controller-system")
def track_controller_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-track-controller-system``: the first one for all tracks of the robot, and its vehicle."""
    own = _track(plugin)
    tracks: list[_Track] = []
    first: GazeboPlugin | None = None
    for item in _others(plugin, _TRACK):
        try:
            track = _track(DrivePlugin(item, plugin.description, plugin.name))
        except CannotWorkError:
            continue
        if any(track.link == other.link for other in tracks):
            if item is plugin.plugin:
                raise CannotWorkError(f"another one has the link {own.link!r}")
            continue
        first = first or item
        tracks.append(track)
    if first is not plugin.plugin:
        return GazeboDrive(plugin.plugin, is_part=True)
    if not has_surface_velocity():
        raise CannotWorkError(NEEDS)
    return _drive(plugin, tracks)


@gazebo_plugin("gz-sim-tracked-vehicle-system")
def tracked_vehicle_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-tracked-vehicle-system``, whose work the controller of the tracks does."""
    if _others(plugin, _VEHICLE)[0] is not plugin.plugin:
        raise CannotWorkError("another one drives the robot")
    tracks = []
    for item in _others(plugin, _TRACK):
        try:
            tracks.append(_track(DrivePlugin(item, plugin.description, plugin.name)))
        except CannotWorkError:
            continue
    _vehicle(plugin, tracks)
    return GazeboDrive(plugin.plugin, is_part=True)


def _others(plugin: DrivePlugin, kind: str) -> list[GazeboPlugin]:
    """Return the robot's plugins of a kind, in the file's order."""
    return [item for item in plugin.description.plugins if plugin_kind(item) == kind]


def _track(plugin: DrivePlugin) -> _Track:
    link = plugin.link("link")
    age = plugin.number("max_command_age", inf)
    if age < 0.0:
        raise plugin.error(f"<max_command_age> is {age:g}, and has to be zero or more")
    plugin.skip("debug", "0", "false")
    rate = plugin.number("odometry_publish_frequency", 50.0)
    parameters: dict[str, Any] = {
        "link": link,
        "axis": _turned_y(*plugin.vector("track_orientation")),
        "max_command_age": age,
        "odometry_publish_frequency": max(rate, 0.0),
        "limits": gz_limits(plugin),
    }
    topics, gz_topics = {}, {}
    for own, tag in (("track_cmd_vel", "velocity_topic"), ("odometry", "odometry_topic")):
        given = plugin.text(tag, "")
        topics[own] = given.strip("/") or f"link/{link}/{own}"
        gz_topics[own] = given or f"/model/{{model}}/link/{link}/{own}"
    return _Track(link, parameters, topics, gz_topics)


def _turned_y(roll: float, pitch: float, yaw: float) -> list[float]:
    """Return the y axis of a frame that is turned by these angles (rad)."""
    x, y, z = sin(pitch) * sin(roll), cos(roll), cos(pitch) * sin(roll)
    return [cos(yaw) * x - sin(yaw) * y, sin(yaw) * x + cos(yaw) * y, z]


def _drive(plugin: DrivePlugin, tracks: Sequence[_Track]) -> GazeboDrive:
    names = _names(tracks)
    parameters: dict[str, Any] = {
        "tracks": {name: track.parameters for name, track in zip(names, tracks, strict=True)},
    }
    topics: dict[str, str] = {}
    gz_topics: dict[str, str] = {}
    for name, track in zip(names, tracks, strict=True):
        topics |= {f"{name}/{own}": topic for own, topic in track.topics.items()}
        gz_topics |= {f"{name}/{own}": topic for own, topic in track.gz_topics.items()}
    rates = [as_rate(track.parameters["odometry_publish_frequency"]) for track in tracks]
    more: dict[str, Any] = {}
    for item in _others(plugin, _VEHICLE)[:1]:
        reader = DrivePlugin(item, plugin.description, plugin.name)
        try:
            vehicle, sides = _vehicle(reader, tracks)
        except CannotWorkError:
            break
        parameters |= vehicle
        parameters |= {side: [names[index] for index in found] for side, found in sides.items()}
        own, gz = reader.gz_topics(_VEHICLE_TOPICS)
        topics, gz_topics = topics | own, gz_topics | gz
        more["odometry_rate"] = as_rate(reader.number("odom_publish_frequency", 50.0))
        rates.append(more["odometry_rate"])
    if max(rates) > DEFAULT_UPDATE_RATE:
        parameters["update_rate"] = min(max(rates), EACH_STEP)
    return plugin.drive(TRACKS, parameters, topics=topics, gz_topics=gz_topics, **more)


def _names(tracks: Sequence[_Track]) -> list[str]:
    """Return names of the tracks for parameters, where a dot stands for what is inside another one."""
    names: list[str] = []
    for track in tracks:
        name = track.link.replace(".", "_")
        while name in names:
            name += "_"
        names.append(name)
    return names


# gz's topics of a vehicle: the element that names them, and the name below the model without it.
_VEHICLE_TOPICS = {
    "cmd_vel_unstamped": ("topic", "cmd_vel"),
    "steering_efficiency": ("steering_efficiency_topic", "steering_efficiency"),
    "odom": ("odom_topic", "odometry"),
    "tf_odometry": ("tf_topic", "tf"),
}


def _vehicle(plugin: DrivePlugin, tracks: Sequence[_Track]) -> tuple[dict[str, Any], dict[str, list[int]]]:
    """Return the parameters of a vehicle, and for each side the indices of the tracks that hear it."""
    sides: dict[str, list[int]] = {}
    heard = [track.gz_topics["track_cmd_vel"].lstrip("/") for track in tracks]
    for side in ("left_track", "right_track"):
        for tag in ("link", "velocity_topic"):
            plugin.has(f"{side}/{tag}")
        wanted = []
        for element in plugin.plugin.tree:
            if element.tag == side:
                texts = {item.tag: item.text for item in reversed(element.inside)}
                link = texts.get("link", "")
                wanted.append(texts.get("velocity_topic") or f"model/{{model}}/link/{link}/track_cmd_vel")
        if not wanted:
            raise CannotWorkError(f"<{side}> is missing")
        sides[f"{side}s"] = [index for index, topic in enumerate(heard) if topic in {w.lstrip("/") for w in wanted}]
        if not sides[f"{side}s"]:
            raise CannotWorkError(f"no track of gz-sim-{_TRACK} hears what it sends to <{side}>")
    for tag in ("tracks_separation", "steering_efficiency"):
        if (value := plugin.number(tag, 1.0)) <= 0.0:
            raise plugin.error(f"<{tag}> is {value:g}, and has to be above zero")
    plugin.has("tracks_height")  # which changes nothing: gz-sim divides the speeds by it, and the odometry multiplies
    plugin.skip("debug", "0", "false")
    plugin.gz_topics(_VEHICLE_TOPICS)
    plugin.number("odom_publish_frequency", 50.0)
    body = plugin.text("body_link", plugin.description.root_link)
    parameters = {
        "tracks_separation": plugin.number("tracks_separation", 1.0),
        "steering_efficiency": plugin.number("steering_efficiency", 0.5),
        "odom_frame_id": plugin.text("frame_id", "odom"),
        "base_frame_id": plugin.text("child_frame_id", body),
        "enable_odom_tf": True,
        "use_stamped_vel": False,
        "tf_frame_prefix_enable": not plugin.has("frame_id"),
        "linear": {"x": gz_limits(plugin, above="linear_velocity/")},
        "angular": {"z": gz_limits(plugin, above="angular_velocity/")},
    }
    return parameters, sides
