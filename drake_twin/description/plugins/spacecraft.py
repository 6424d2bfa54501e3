"""The system of gz-sim for thrusters of spacecraft that are on or off, as controllers that exert forces."""

from drake_twin.description.gazebo_drive import (
    SPACECRAFT_THRUSTER,
    CannotWorkError,
    DrivePlugin,
    GazeboDrive,
    gazebo_plugin,
)


@gazebo_plugin("gz-sim-spacecraft-thruster-model-system")
def spacecraft_thruster_model_system(plugin: DrivePlugin) -> GazeboDrive:
    """Convert ``gz-sim-spacecraft-thruster-model-system``: a thrust for a part of each cycle."""
    link = plugin.link()
    if not plugin.has("max_thrust"):
        raise CannotWorkError("<max_thrust> is missing: it pushes nothing")
    number, frequency = plugin.number("actuator_number", 0.0), plugin.number("duty_cycle_frequency", 10.0)
    if number < 0 or number != int(number):
        raise plugin.error(f"<actuator_number> is {number:g}, which is not a whole number from 0")
    if frequency <= 0.0:
        raise plugin.error(f"<duty_cycle_frequency> is {frequency:g}, and has to be above zero")
    parameters = {
        "link_name": link,
        "actuator_number": int(number),
        "max_thrust": plugin.number("max_thrust", 0.0),
        "duty_cycle_frequency": frequency,
    }
    space, below = plugin.text("topic", "{model}").strip("/"), plugin.text("sub_topic", "").strip("/")
    own = below or (space if plugin.has("topic") else "duty_cycle")
    return plugin.drive(
        SPACECRAFT_THRUSTER,
        parameters,
        topics={"duty_cycle": own},
        gz_topics={"duty_cycle": f"/{space}/{below}".rstrip("/")},
    )
