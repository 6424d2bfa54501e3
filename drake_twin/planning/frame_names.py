"""The names of a robot's frames: their prefix, and those of files that are most likely a misspelt link."""

from collections.abc import Collection

from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import did_you_mean
from drake_twin.scenario import Robot

_CLOSE = 0.85


def frame_prefix(robot: Robot, description: RobotDescription) -> str:
    """Return the prefix of a robot's link names in tf messages, without the leading slash that tf2 strips."""
    if robot.frame_prefix is not None:
        return robot.frame_prefix.removeprefix("/")
    own = (f"{robot.name}_", f"{robot.name}/")
    named_after_robot = all(link == "world" or link.startswith(own) for link in description.links)
    return "" if named_after_robot else f"{robot.name}/"


def misspelt_frame(frame: str, links: Collection[str]) -> str | None:
    """Say that the robot has no link of a frame's name, but one that is close; None for any other frame.

    A frame that is not a link may be published by a node, so that only a close name is worth a finding. Prefixes
    before a link's name count for nothing, as files have them on one side only.

    Args:
        frame: The frame as written.
        links: The robot's links.
    """
    name = frame.strip().lstrip("/")
    if not name or any(_is_same(name, link) for link in links):
        return None
    hint = did_you_mean(name, links, _CLOSE)
    return f"the robot has no link {name!r}{hint}" if hint else None


def _is_same(name: str, link: str) -> bool:
    return name == link or name.endswith(("/" + link, "_" + link)) or link.endswith(("/" + name, "_" + name))
