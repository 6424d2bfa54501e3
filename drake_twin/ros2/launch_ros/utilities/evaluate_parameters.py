"""Stand-ins for ``launch_ros.utilities.evaluate_parameters``."""

from drake_twin.ros2.parameters import evaluate_parameter_dict as evaluate_parameters_dict
from drake_twin.ros2.parameters import evaluate_parameters

__all__ = ["evaluate_parameters", "evaluate_parameters_dict"]
