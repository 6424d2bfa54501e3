from drake_twin.ros2.events import ChangeState, StateTransition, matches_node_name

__all__ = ["ChangeState", "StateTransition", "matches_node_name"]
