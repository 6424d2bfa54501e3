"""The system of gz-sim that is a bladder in a vehicle, as a controller that exerts forces."""

from math import inf
from typing import Any

from drake_twin.description.gazebo_drive import (
    BUOYANCY_ENGINE,
    EACH_STEP,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    gazebo_plugin,
)

# Element → gz-sim's default.
_NUMBERS = {
    "min_volume": 3e-5,
    "max_volume": 9.9e-4,
    "neutral_volume": 3e-4,
    "max_inflation_rate": 3e-6,
    "fluid_density": 1000.0,
    "surface": inf,
}
_FIRST = 3e-5  # m³
_NOT_NEGATIVE = ("max_inflation_rate", "fluid_density")


@gazebo_plugin("gz-sim-buoyancy-engine-system")
def buoyancy_engine_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-buoyancy-engine-system``: a bladder, its volume and what it lifts."""
    link = plugin.text("link_name", "")
    if link not in plugin.description.links:
        raise CannotWorkError(f"the robot has no link {link!r}" if link else "<link_name> is missing")
    parameters: dict[str, Any] = {tag: plugin.number(tag, default) for tag, default in _NUMBERS.items()}
    for tag in _NOT_NEGATIVE:
        if parameters[tag] < 0.0:
            raise plugin.error(f"<{tag}> is {parameters[tag]:g}, and has to be zero or more")
    if parameters["max_volume"] < parameters["min_volume"]:
        raise plugin.error("<max_volume> is less than <min_volume>")
    default = plugin.number("default_volume", parameters["min_volume"])
    first = default if plugin.has("default_volume") else _FIRST  # as gz-sim
    parameters |= {"link_name": link, "default_volume": default, "first_volume": first, "update_rate": EACH_STEP}
    space = plugin.text("namespace", "").strip("/")
    below = f"/model/{space}/buoyancy_engine" if space else "/buoyancy_engine"
    ros = "buoyancy_engine" if space else "/buoyancy_engine"
    return plugin.drive(
        BUOYANCY_ENGINE,
        parameters,
        topics={"buoyancy_engine": ros, "current_volume": f"{ros}/current_volume"},
        gz_topics={"buoyancy_engine": below, "current_volume": f"{below}/current_volume"},
    )
