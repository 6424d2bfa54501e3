"""Stand-ins for ``launch_ros.parameter_descriptions``."""

from drake_twin.ros2.parameters import Parameter, ParameterFile, ParameterValue

__all__ = ["Parameter", "ParameterFile", "ParameterValue"]
