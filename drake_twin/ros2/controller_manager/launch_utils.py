"""``controller_manager.launch_utils``: launch descriptions that spawn controllers."""

from collections.abc import Iterable, Mapping
from typing import Any

from drake_twin.ros2.launch.actions.declare_launch_argument import DeclareLaunchArgument
from drake_twin.ros2.launch.launch_description import LaunchDescription
from drake_twin.ros2.launch.substitutions.launch_configuration import LaunchConfiguration
from drake_twin.ros2.launch_ros.actions.node import Node


def generate_controllers_spawner_launch_description_from_dict(
    controller_info_dict: Mapping[str, Any], extra_spawner_args: Iterable[Any] = ()
) -> LaunchDescription:
    """Return a launch description that spawns several controllers at once.

    Args:
        controller_info_dict: Controller → its parameter file or files, or None.
        extra_spawner_args: Further arguments of the spawner.
    """
    files: list[Any] = []
    for given in controller_info_dict.values():
        files += given if isinstance(given, list) else [] if given is None else [given]
    words: list[Any] = [*controller_info_dict, "--controller-manager", LaunchConfiguration("controller_manager_name")]
    for file in dict.fromkeys(files):
        words += ["--param-file", file]
    return LaunchDescription(
        [
            DeclareLaunchArgument(
                "controller_manager_name", default_value="controller_manager", description="The controller manager"
            ),
            DeclareLaunchArgument(
                "unload_on_kill", default_value="false", description="Unload the controllers when the spawner ends"
            ),
            Node(package="controller_manager", executable="spawner", arguments=[*words, *extra_spawner_args]),
        ]
    )


def generate_controllers_spawner_launch_description(
    controller_names: Iterable[str], controller_params_files: Any = None, extra_spawner_args: Iterable[Any] = ()
) -> LaunchDescription:
    """Return a launch description that spawns several controllers with the same parameter files."""
    return generate_controllers_spawner_launch_description_from_dict(
        dict.fromkeys(controller_names, controller_params_files), extra_spawner_args
    )


def generate_load_controller_launch_description(
    controller_name: str, controller_params_file: Any = None, extra_spawner_args: Iterable[Any] = ()
) -> LaunchDescription:
    """Return a launch description that spawns one controller."""
    return generate_controllers_spawner_launch_description_from_dict(
        {controller_name: controller_params_file}, extra_spawner_args
    )
