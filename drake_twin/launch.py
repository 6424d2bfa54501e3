"""Front ends that end in a `drake_twin.scenario.Scenario`, and ROS 2's launch entities for plain Python programs.

``from drake_twin.launch import LaunchDescription, Node`` gives what ``launch`` and ``launch_ros`` give launch
files; `drake_twin.ros2.evaluate` says what a launch file or such a description starts.
"""

from typing import Any


def __getattr__(name: str) -> Any:
    """The entity of that name, loaded when it is first asked for."""
    if name[0].isupper():  # classes; the others are modules of this package
        from drake_twin.ros2.ros_module_table import every_symbol

        symbols = every_symbol()
        if name in symbols:
            return symbols[name]
    raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
