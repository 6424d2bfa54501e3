"""The messages, services and actions of ROS 2's packages, as data: a line of ``interfaces.txt`` for each of them.

They are those of Jazzy's desktop-full, Nav2, MoveIt, ros2_control and others that programs import, where rosbags' store
lacks them; ``gazebo_msgs`` is that of Gazebo classic. A line has the type's name and, separated by ``; ``, what its
file declares: fields (``TYPE NAME``, or ``TYPE NAME VALUE`` with a default value), constants (``TYPE NAME=VALUE``) and
``---`` between the parts of a service or an action. The file is read when a type is first asked for.
"""

from functools import cache
from pathlib import Path


@cache
def interface_names() -> frozenset[str]:
    """Return the names of all types, for example ``nav2_msgs/action/NavigateToPose``."""
    return frozenset(_declarations())


def interface_text(name: str) -> str | None:
    """Return a type in the notation of ``.msg``, ``.srv`` and ``.action`` files; None if it is not in the data."""
    declarations = _declarations().get(name)
    return None if declarations is None else "".join(f"{item}\n" for item in declarations.split("; ") if item)


@cache
def _declarations() -> dict[str, str]:
    lines = Path(__file__).with_name("interfaces.txt").read_text(encoding="utf-8").splitlines()
    pairs = (line.partition(":") for line in lines)
    return {name: declarations.strip() for name, _, declarations in pairs}
