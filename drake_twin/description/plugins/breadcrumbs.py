"""The system of gz-sim that lets a robot drop models: what the twin does between two advances."""

from drake_twin.description.breadcrumbs import read_breadcrumbs
from drake_twin.description.gazebo_drive import DrivePlugin, GazeboDrive, gazebo_plugin
from drake_twin.description.triggers import Trigger, TriggeredRequest


@gazebo_plugin("gz-sim-breadcrumbs-system")
def breadcrumbs_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-breadcrumbs-system`` to models that the twin spawns between two advances."""
    deploy = read_breadcrumbs(plugin, plugin.name)
    if deploy is None:
        return GazeboDrive(plugin.plugin, is_part=True)
    trigger = Trigger(
        name=plugin.name,
        topic=deploy.topic,
        type="std_msgs/msg/Empty",
        requests=(TriggeredRequest(f"breadcrumb {deploy.name}", request=deploy),),
        place=plugin.plugin.place,
    )
    return GazeboDrive(plugin.plugin, is_part=True, triggers=(trigger,))
