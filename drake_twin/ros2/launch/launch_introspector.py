"""Launch descriptions as text."""

from drake_twin.ros2.launch.launch_description import LaunchDescription


class LaunchIntrospector:
    """Describes launch descriptions."""

    def format_launch_description(self, launch_description: LaunchDescription) -> str:
        """Return the entities, one a line."""
        return "\n".join(entity.describe() for entity in launch_description.entities)
