"""The systems of gz-sim for vehicles in water, as controllers that exert forces."""

from drake_twin.description.gazebo_drive import HYDRODYNAMICS, CannotWorkError, DrivePlugin, GazeboDrive, gazebo_plugin
from drake_twin.description.sname import coefficient_name


@gazebo_plugin("gz-sim-hydrodynamics-system")
def hydrodynamics_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-hydrodynamics-system``: damping, added mass and current of one link."""
    link = plugin.text("link_name", "")
    if link not in plugin.description.links:
        raise CannotWorkError(f"the robot has no link {link!r}" if link else "<link_name> is missing")
    parameters: dict[str, object] = {
        "link_name": link,
        "coefficients": {tag: plugin.number(tag, 0.0) for tag in plugin.plugin.elements if coefficient_name(tag)},
        "disable_added_mass": plugin.flag("disable_added_mass", False),
        "disable_coriolis": plugin.flag("disable_coriolis", False),
        "default_current": list(plugin.vector("default_current")),
    }
    plugin.has("water_density")  # which gz-sim does not use
    space = plugin.text("namespace", "").strip("/")
    topic = f"/model/{space}/ocean_current" if space else "/ocean_current"
    return plugin.drive(
        HYDRODYNAMICS,
        parameters,
        topics={"ocean_current": "ocean_current" if space else "/ocean_current"},
        gz_topics={"ocean_current": topic},
    )
