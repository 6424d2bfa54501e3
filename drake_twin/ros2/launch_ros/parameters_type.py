"""Stand-ins for ``launch_ros.parameters_type``, which launch files use in annotations."""

from typing import Any

__all__ = ["SomeParameterValue", "SomeParameters", "SomeParametersDict"]

SomeParameters = Any
SomeParametersDict = Any
SomeParameterValue = Any
