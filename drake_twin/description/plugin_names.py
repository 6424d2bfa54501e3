"""Names of Gazebo's plugins that are misspelt: their library or their class is nearly that of the other."""

import re
from difflib import get_close_matches

from drake_twin.description.gazebo_plugins import CLASS, GZ_LIBRARY, class_kind
from drake_twin.description.robot_description import GazeboPlugin

_CLOSE = 0.8
_OF_ROS2_CONTROL = (
    *("gz_ros2_control::GazeboSimROS2ControlPlugin", "ign_ros2_control::IgnitionROS2ControlPlugin"),
    "gz_ros2_control::GazeboSimQuadrupedPlugin",
)


def misspelt_plugin(plugin: GazeboPlugin) -> str | None:
    """Say which of the two names of a plugin of gz-sim is misspelt; None where they fit, or are of another plugin.

    A plugin of gz-sim is a class in a library: ``gz::sim::systems::DiffDrive`` in ``gz-sim-diff-drive-system``.
    """
    library, name = plugin.filename.rpartition("/")[2], plugin.name
    in_library, of_class = GZ_LIBRARY.fullmatch(library), CLASS.fullmatch(name)
    if "ros2_control" in library and "::" in name and name not in _OF_ROS2_CONTROL:
        close = get_close_matches(name, _OF_ROS2_CONTROL, n=1, cutoff=_CLOSE)
        return _told("class", name, close)
    if of_class is not None and library and in_library is None:
        kind = class_kind(of_class[1])
        bare = re.sub(r"^lib|\.so$", "", library)
        libraries = [f"gz-sim-{kind}", f"gz-sim8-{kind}", f"ignition-gazebo-{kind}", f"ignition-gazebo6-{kind}"]
        return _told("library", library, get_close_matches(bare, libraries, n=1, cutoff=_CLOSE))
    if in_library is None:
        return None
    kind = in_library[1]
    if of_class is None:
        words = "".join(word.capitalize() for word in kind.removesuffix("-system").split("-"))
        classes = [f"{place}::systems::{words}" for place in ("gz::sim", "ignition::gazebo")]
        return _told("class", name, get_close_matches(name, classes, n=1, cutoff=_CLOSE) if "::" in name else [])
    own = class_kind(of_class[1])
    of_kind, of_own = set(kind.split("-")), set(own.split("-"))
    is_same = own.replace("-", "") == re.sub("[-_]", "", kind) or of_kind <= of_own or of_own <= of_kind
    is_misspelt = not is_same and get_close_matches(own, [kind], cutoff=_CLOSE)
    return f"Gazebo plugin {name} ({library}): one of the two names is misspelt" if is_misspelt else None


def _told(what: str, name: str, close: list[str]) -> str | None:
    return f"unknown {what} {name!r} of a Gazebo plugin. Did you mean {close[0]!r}?" if close else None
