"""ROS 2's launch entities for Python programs.

``from drake_twin.launch import LaunchDescription, Node`` gives what ``launch`` and ``launch_ros`` give launch files;
`drake_twin.ros2.evaluate` evaluates such a description. ``expose_action`` and ``expose_substitution`` add a tag and a
``$(name …)`` to XML and YAML launch files.
"""

from typing import Any

# Where a name is looked for, in this order: a few stand for two things in ROS.
_MODULES = (
    *("launch", "launch.frontend", "launch.utilities", "launch.actions", "launch.conditions", "launch.event_handlers"),
    *("launch.substitutions", "launch.launch_description_sources", "launch_ros.actions", "launch_ros.descriptions"),
    *("launch_ros.substitutions", "nav2_common.launch"),
)


def __getattr__(name: str) -> Any:
    """Return the entity of that name, imported when it is first asked for."""
    if not name.startswith("_"):
        from drake_twin.ros2.stand_in_modules import exports, stand_in

        for module in _MODULES:
            if name in (exports(module) or ()):
                return stand_in(module, name)
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
