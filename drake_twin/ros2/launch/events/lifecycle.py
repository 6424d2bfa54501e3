"""Where the events of ``launch_ros.events.lifecycle`` are looked for, too."""

from drake_twin.ros2.launch_ros.events.lifecycle import ChangeState, StateTransition, matches_node_name

__all__ = ["ChangeState", "StateTransition", "matches_node_name"]
