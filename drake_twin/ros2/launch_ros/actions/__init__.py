"""Stand-ins for ``launch_ros.actions``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "composable_node_container": "ComposableNodeContainer",
        "lifecycle_node": "LifecycleNode",
        "lifecycle_transition": "LifecycleTransition",
        "load_composable_nodes": "LoadComposableNodes",
        "node": "Node",
        "push_ros_namespace": "PushROSNamespace PushRosNamespace",
        "ros_timer": "ROSTimer RosTimer",
        "set_parameter": "SetParameter",
        "set_parameters_from_file": "SetParametersFromFile",
        "set_remap": "SetRemap",
        "set_ros_log_dir": "SetROSLogDir",
        "set_use_sim_time": "SetUseSimTime",
    },
)
