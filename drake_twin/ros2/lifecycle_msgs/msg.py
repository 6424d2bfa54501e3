from drake_twin.ros2.lifecycle import State, Transition

__all__ = ["State", "Transition"]
