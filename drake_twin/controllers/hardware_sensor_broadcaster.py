"""The base of the broadcasters of sensors that the twin does not simulate."""

from typing import Any

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.sensor_broadcaster import SensorBroadcaster
from drake_twin.description.robot_description import RobotDescription


class HardwareSensorBroadcaster(SensorBroadcaster):
    """Publish state interfaces that no simulated sensor sets.

    Their values are what mock hardware has: the ``initial_value`` in ``<ros2_control>``, or NaN. As in ros2_control, a
    broadcaster whose state interfaces do not exist cannot be activated.
    """

    kind = ""

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup, "values")

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return which state interfaces ``<ros2_control>`` lacks; None if it has all."""
        names = cls.state_interfaces(parameters)
        missing = [name for name in names if name not in description.sensor_states]
        if not missing:
            return None
        sensors = {name.rpartition("/")[0] for name in names}
        known = [name for name in description.sensor_states if name.rpartition("/")[0] in sensors]
        has = f"it has {', '.join(known)}" if known else f"its sensors are {', '.join(description.hardware_sensors)}"
        if not description.hardware_sensors:
            has = "it has no sensor"
        return f"<ros2_control> has no state interface {', '.join(missing)} ({has})"
