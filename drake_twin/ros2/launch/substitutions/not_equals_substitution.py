from drake_twin.ros2.logic_substitutions import NotEqualsSubstitution

__all__ = ["NotEqualsSubstitution"]
