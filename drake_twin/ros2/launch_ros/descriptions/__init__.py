"""Stand-ins for ``launch_ros.descriptions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "composable_node": "ComposableLifecycleNode ComposableNode",
        "launch_ros.parameter_descriptions": "Parameter ParameterFile ParameterValue",
    },
)
