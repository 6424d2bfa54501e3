from drake_twin.ros2.substitution_text import parse_substitution

__all__ = ["parse_substitution"]
