"""The source of an XML or YAML launch file."""

from typing import Any

from drake_twin.ros2.launch.launch_description_source import LaunchDescriptionSource
from drake_twin.ros2.launch.substitution import SomeSubstitutionsType


class FrontendLaunchDescriptionSource(LaunchDescriptionSource):
    """An XML or YAML launch file, which is read by its name."""

    def __init__(
        self,
        launch_file_path: SomeSubstitutionsType,
        *,
        method: str = "interpreted frontend launch file",
        parser: Any = None,
    ):
        super().__init__(None, launch_file_path, method)
