from drake_twin.ros2.logic_substitutions import (
    AllSubstitution,
    AndSubstitution,
    AnySubstitution,
    NotSubstitution,
    OrSubstitution,
)

__all__ = ["AllSubstitution", "AndSubstitution", "AnySubstitution", "NotSubstitution", "OrSubstitution"]
