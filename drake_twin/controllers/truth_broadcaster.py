"""The base of broadcasters of a robot's true motion, which no sensor of its file measures."""

from typing import Any

from drake_twin.controllers.sensor_broadcaster import SensorBroadcaster
from drake_twin.description.robot_description import RobotDescription


class TruthBroadcaster(SensorBroadcaster):
    """Publish what a system of its own, `own_sensor`, measures in the plant; a subclass tells how many values."""

    kind = ""

    @classmethod
    def sensor_name(cls, parameters: Any) -> str:
        """Return an empty name: the robot's file has no such sensor."""
        return ""

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return None: each robot has a pose."""
        return None
