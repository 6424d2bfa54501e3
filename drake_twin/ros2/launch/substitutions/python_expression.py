"""Stand-ins for ``launch.substitutions.python_expression``."""

from drake_twin.ros2.substitutions import PythonExpression

__all__ = ["PythonExpression"]
