"""The system of gz-sim that publishes messages when it hears one, of a model and of a world."""

from drake_twin.description.gazebo_drive import TRIGGERED_PUBLISHER, DrivePlugin, GazeboDrive, gazebo_plugin
from drake_twin.description.gazebo_plugins import PluginReader
from drake_twin.description.triggers import read_trigger
from drake_twin.description.world_plugins import WorldPlugin, world_plugin

_NAME = "gz-sim-triggered-publisher-system"


@gazebo_plugin(_NAME)
def triggered_publisher_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-triggered-publisher-system`` to what the twin publishes between two steps."""
    return GazeboDrive(plugin.plugin, is_part=True, triggers=(read_trigger(plugin),))


@world_plugin(_NAME)
def triggered_publisher_of_world(plugin: PluginReader) -> WorldPlugin:
    """Convert ``gz-sim-triggered-publisher-system`` of a world."""
    return WorldPlugin(TRIGGERED_PUBLISHER, read_trigger(plugin), exerts_forces=False)
