"""Names of robots and their namespaces: they become topics, frames, files and sub-diagrams."""

import re
from typing import Any

from drake_twin.messages import shortened

# Names that a robot cannot have: those of other sub-diagrams and model instances.
RESERVED_NAMES = frozenset(
    (
        "world",
        "plant",
        "scene_graph",
        "clock",
        "tf",
        "ground_truth",
        "entity_states",
        "sensors",
        "meshcat_visualizer",
        "WorldModelInstance",
        "DefaultModelInstance",
    )
)
LONGEST_NAME = 100  # a topic of ROS has 247 characters at most, of which its controllers' topics need the rest

_NAME = re.compile(rf"[A-Za-z0-9_-]{{1,{LONGEST_NAME}}}")
_VALID = f"letters from A to Z, digits, '_' and '-', {LONGEST_NAME} at most"


def problem_of_name(name: Any) -> str | None:
    """Return what is wrong with a robot's name, None if nothing is.

    ROS refuses other letters and longer names in topics. A name that begins with a digit or has a ``-`` is one in
    Gazebo; its topics are not on the ROS 2 graph.
    """
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        return f"{shortened(name)} is not a name: use {_VALID}"
    return f"{name!r} is the name of another part of the twin" if name in RESERVED_NAMES else None


def problem_of_namespace(namespace: Any) -> str | None:
    """Return what is wrong with the namespace of a robot's topics, such as ``/team/robot_1``; None if nothing is."""
    parts = namespace.strip("/").split("/") if isinstance(namespace, str) else [""]
    if parts != [""] and all(map(_NAME.fullmatch, parts)) and len(namespace) <= 2 * LONGEST_NAME:
        return None
    if namespace in ("", "/"):  # the root
        return None
    return f"{shortened(namespace)} is not a namespace: use names with '/' between them, each of {_VALID}"


def name_in_twin(name: str) -> str:
    """Return a robot's name as the twin can take it: see `problem_of_name`."""
    name = re.sub(r"[^A-Za-z0-9_-]", "_", name)[:LONGEST_NAME]
    return f"{name}_robot".lstrip("_") if name in RESERVED_NAMES or not name else name
