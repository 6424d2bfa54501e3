from drake_twin.ros2.logic_substitutions import EqualsSubstitution

__all__ = ["EqualsSubstitution"]
