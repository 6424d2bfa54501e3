"""Stand-ins for ``nav2_common.launch``."""

from drake_twin.ros2.lazy_exports import lazy_exports

__all__, __getattr__ = lazy_exports(
    __name__,
    {
        "has_node_params": "HasNodeParams",
        "launch_config_as_bool": "LaunchConfigAsBool",
        "parse_multirobot_pose": "ParseMultiRobotPose",
        "replace_string": "ReplaceString",
        "rewritten_yaml": "RewrittenYaml",
    },
)
