"""The systems of gz-sim that watch a model, as controllers that command nothing."""

from drake_twin.description.gazebo_drive import (
    EACH_STEP,
    KINETIC_ENERGY_MONITOR,
    DrivePlugin,
    GazeboDrive,
    gazebo_plugin,
)


@gazebo_plugin("gz-sim-kinetic-energy-monitor-system")
def kinetic_energy_monitor_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-kinetic-energy-monitor-system`` to the twin's own controller of this kind."""
    link = plugin.link()
    parameters = {
        "link_name": link,
        "kinetic_energy_threshold": plugin.number("kinetic_energy_threshold", 7.0),
        "update_rate": EACH_STEP,
    }
    return plugin.drive(KINETIC_ENERGY_MONITOR, parameters, {"kinetic_energy": ("topic", "kinetic_energy")})
