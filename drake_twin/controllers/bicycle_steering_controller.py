"""Steering of a base with one driven and one steered wheel."""

from dataclasses import field
from typing import ClassVar

from drake_twin.control.drive_kinematics import SteeringDrive
from drake_twin.controllers.registry import controller
from drake_twin.controllers.steering_controller import SteeringController, SteeringParameters
from drake_twin.dataclass import dataclass


@dataclass(frozen=True, kw_only=True)
class BicycleSteeringParameters(SteeringParameters):
    """Parameters of ``bicycle_steering_controller/BicycleSteeringController``.

    Attributes:
        wheelbase: The distance between the axles (m).
        traction_wheel_radius: The radius of the driven wheel (m).
        front_wheel_radius: Deprecated.
        rear_wheel_radius: Deprecated.
    """

    read_only: ClassVar[tuple[str, ...]] = ("front_steering", "*_names", "front_wheel_radius", "rear_wheel_radius")

    wheelbase: float = field(metadata={"above": 0.0})
    traction_wheel_radius: float = 0.0
    front_wheel_radius: float = 0.0
    rear_wheel_radius: float = 0.0

    def kinematics(self) -> SteeringDrive:
        """Return the drive; the deprecated names are applied as upstream does."""
        radius = self.rear_wheel_radius or self.front_wheel_radius or self.traction_wheel_radius
        return SteeringDrive(wheelbase=self.wheelbase, wheel_radius=radius)


@controller("bicycle_steering_controller/BicycleSteeringController")
class BicycleSteeringController(SteeringController):
    """Implement ``bicycle_steering_controller/BicycleSteeringController``; see `SteeringController`."""

    Parameters: ClassVar[type] = BicycleSteeringParameters
