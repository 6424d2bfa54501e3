"""The systems of gz-sim that know performers: what marks models as such, and the regions that notice them."""

from drake_twin.description.gazebo_drive import PERFORMER_DETECTOR, PERFORMERS, DrivePlugin, GazeboDrive, gazebo_plugin
from drake_twin.description.gazebo_plugins import LEVELS, CannotWorkError, PluginReader
from drake_twin.description.performers import PERFORMER, read_own_performer, read_performer_detector, read_performers
from drake_twin.description.world_plugins import WorldPlugin, world_plugin

_DETECTOR = "gz-sim-performer-detector-system"


@world_plugin(LEVELS)
def performers_of_world(plugin: PluginReader) -> WorldPlugin:
    """Convert the plugin ``gz::sim`` of a world, which marks models as performers."""
    return WorldPlugin(PERFORMERS, read_performers(plugin), exerts_forces=False)


@gazebo_plugin(PERFORMER)
def performer(plugin: DrivePlugin) -> GazeboDrive:
    """Convert the twin's own plugin of a model that was dropped as a performer."""
    return GazeboDrive(plugin.plugin, is_part=True, performers=(read_own_performer(plugin),))


@gazebo_plugin(_DETECTOR)
def performer_detector_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-performer-detector-system`` to what the twin looks at after each step."""
    return GazeboDrive(plugin.plugin, is_part=True, detectors=(read_performer_detector(plugin),))


@world_plugin(_DETECTOR)
def performer_detector_of_static_model(plugin: PluginReader) -> WorldPlugin:
    """Convert ``gz-sim-performer-detector-system`` of a model that never moves."""
    if not plugin.model:
        raise CannotWorkError("it has to be in a model")
    return WorldPlugin(PERFORMER_DETECTOR, read_performer_detector(plugin), exerts_forces=False, model=plugin.model)
