"""Stand-ins for ``launch_ros.events.matchers``."""

from drake_twin.ros2.events import matches_node_name

__all__ = ["matches_node_name"]
