"""The system of gz-sim that moves a link from waypoint to waypoint, as a controller that exerts forces."""

from math import isfinite
from typing import Any

from drake_twin.description.gazebo_drive import (
    TRAJECTORY_FOLLOWER,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    gazebo_plugin,
)
from drake_twin.values import parse_number

_RATE = 100.0  # Hz, at which a waypoint is noticed that is reached
_NUMBERS = {"force": 60.0, "torque": 50.0, "range_tolerance": 0.5, "bearing_tolerance": 2.0}


@gazebo_plugin("gz-sim-trajectory-follower-system")
def trajectory_follower_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-trajectory-follower-system``: a force along a link, and a torque that turns it."""
    link = plugin.link()
    parameters: dict[str, Any] = {tag: plugin.number(tag, default) for tag, default in _NUMBERS.items()}
    for tag in ("range_tolerance", "bearing_tolerance"):
        if parameters[tag] < 0.0:
            raise plugin.error(f"<{tag}> is {parameters[tag]:g}, and has to be zero or more")
    parameters |= _waypoints(plugin) | {"link_name": link, "loop": plugin.flag("loop", False), "update_rate": _RATE}
    warnings: tuple[str, ...] = ()
    if plugin.flag("zero_vel_on_bearing_reached", False):
        warnings = ("<zero_vel_on_bearing_reached> is not simulated: a torque stops nothing at once",)
    _, gz_topics = plugin.gz_topics({"pause": ("topic", "trajectory_follower/pause")})
    return plugin.drive(
        TRAJECTORY_FOLLOWER,
        parameters,
        topics={"pause": plugin.text("topic", "trajectory_follower/pause").strip("/")},
        gz_topics=gz_topics,
        warnings=warnings,
    )


def _waypoints(plugin: DrivePlugin) -> dict[str, Any]:
    """Return the parameters of the first of the three ways to name waypoints that the plugin has."""
    tags = {tag.partition("/")[0] for tag in plugin.plugin.elements}
    if "waypoints" in tags:
        points = [_point(plugin, text) for text in plugin.texts("waypoints/waypoint")]
        if not points:
            raise CannotWorkError("<waypoints> has no <waypoint>")
        return {"waypoints": [number for point in points for number in point]}
    if "circle" in tags:
        return {"circle_radius": _needed(plugin, "circle/radius")}
    if "line" in tags:
        return {"line_direction": _needed(plugin, "line/direction"), "line_length": _needed(plugin, "line/length")}
    raise CannotWorkError("it has no <waypoints>, no <circle> and no <line>")


def _needed(plugin: DrivePlugin, tag: str) -> float:
    value = next(iter(plugin.numbers(tag)), 0.0)
    if not plugin.has(tag) or (value == 0.0 and not tag.endswith("direction")):
        what = "is zero" if plugin.has(tag) else "is missing"
        raise CannotWorkError(f"<{tag}> {what}")
    return value


def _point(plugin: DrivePlugin, text: str) -> tuple[float, float]:
    try:
        x, y = map(parse_number, text.split())
    except ValueError:
        x = y = float("inf")
    if not (isfinite(x) and isfinite(y)):
        raise plugin.error(f"<waypoint> is {text!r}, which is not two finite numbers")
    return x, y
