"""The system of gz-sim that tells that a model has touched another one, of robots and of models that never move."""

from drake_twin.description.gazebo_drive import TOUCH_PLUGIN, DrivePlugin, GazeboDrive, gazebo_plugin
from drake_twin.description.gazebo_plugins import CannotWorkError, PluginReader
from drake_twin.description.touches import read_touch
from drake_twin.description.world_plugins import WorldPlugin, world_plugin

_NAME = "gz-sim-touchplugin-system"


@gazebo_plugin(_NAME)
def touch_plugin_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-touchplugin-system`` to what the twin looks at after each step, while it is enabled."""
    return GazeboDrive(plugin.plugin, is_part=True, touches=(read_touch(plugin),))


@world_plugin(_NAME)
def touch_plugin_of_static_model(plugin: PluginReader) -> WorldPlugin:
    """Convert ``gz-sim-touchplugin-system`` of a model that never moves."""
    if not plugin.model:
        raise CannotWorkError("it has to be in a model")
    return WorldPlugin(TOUCH_PLUGIN, read_touch(plugin), exerts_forces=False, model=plugin.model)
