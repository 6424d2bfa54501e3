"""Three rovers one behind the other, each with its controllers: a launch description in plain Python.

It runs with ``python -m drake_twin.run diagrams/rovers_in_formation.launch.py rovers:=5`` and with ``ros2 launch``.
"""

from launch import LaunchDescription
from launch.actions import DeclareLaunchArgument, IncludeLaunchDescription, OpaqueFunction
from launch.launch_description_sources import AnyLaunchDescriptionSource, PythonLaunchDescriptionSource
from launch.substitutions import LaunchConfiguration, PathJoinSubstitution
from launch_ros.substitutions import FindPackageShare

LAUNCH = PathJoinSubstitution([FindPackageShare("rover_gazebo"), "launch"])


def rovers(context):
    count = int(LaunchConfiguration("rovers").perform(context))
    file = PathJoinSubstitution([LAUNCH, "spawn_with_control.launch.xml"])
    return [
        IncludeLaunchDescription(
            AnyLaunchDescriptionSource(file),
            launch_arguments={"robot_name": f"rover_{number}", "x": str(-1.5 * number), "y": "0.0"}.items(),
        )
        for number in range(1, count + 1)
    ]


def generate_launch_description():
    world = PathJoinSubstitution([LAUNCH, "start_world.launch.py"])
    return LaunchDescription(
        [
            DeclareLaunchArgument("rovers", default_value="3", description="How many rovers"),
            IncludeLaunchDescription(PythonLaunchDescriptionSource(world)),
            OpaqueFunction(function=rovers),
        ]
    )
