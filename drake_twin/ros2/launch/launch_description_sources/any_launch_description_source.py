"""The source of a launch file of any kind."""

from drake_twin.ros2.launch.launch_description_source import LaunchDescriptionSource
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType


class AnyLaunchDescriptionSource(LaunchDescriptionSource):
    """A launch file of any kind."""

    def __init__(self, launch_file_path: SomeSubstitutionsType):
        super().__init__(None, launch_file_path, "interpreted launch file")
