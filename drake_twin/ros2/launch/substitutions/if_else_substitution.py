from drake_twin.ros2.logic_substitutions import IfElseSubstitution

__all__ = ["IfElseSubstitution"]
