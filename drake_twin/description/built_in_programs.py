"""ROS programs that the twin has itself, as rclpy nodes: launch files start them where the workspace has no other."""

from pathlib import Path

from drake_twin.description.python_programs import PythonProgram

_FOLDER = Path(__file__).parents[1] / "nodes" / "programs"
# Package → executable → the module here and its function.
_PROGRAMS = {
    "joint_state_publisher": {"joint_state_publisher": ("joint_state_publisher", "main")},
    "robot_localization": {"ekf_node": ("ekf_node", "main")},
    "teleop_twist_keyboard": {"teleop_twist_keyboard": ("teleop_twist_keyboard", "main")},
    "twist_mux": {"twist_mux": ("twist_mux", "main")},
    "topic_tools": {
        "mux": ("topic_mux", "main"),
        "relay": ("topic_tools", "relay"),
        "throttle": ("topic_tools", "throttle"),
    },
    "twist_stamper": {
        "twist_stamper": ("twist_stamper", "stamp"),
        "twist_unstamper": ("twist_stamper", "unstamp"),
    },
}


def built_in_programs(package: str) -> dict[str, PythonProgram]:
    """Return the programs of a ROS package that the twin has itself, by their executables' names."""
    return {
        executable: PythonProgram(_FOLDER / f"{module}.py", module, function, _FOLDER)
        for executable, (module, function) in _PROGRAMS.get(package, {}).items()
    }
