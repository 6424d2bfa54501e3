"""Stand-ins for ``launch_ros.utilities``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "evaluate_parameters": "evaluate_parameters evaluate_parameters_dict",
    },
)
