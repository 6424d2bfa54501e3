"""Steering of a base with two driven wheels and one steered wheel."""

from dataclasses import field
from typing import ClassVar

from drake_twin.control.drive_kinematics import SteeringDrive
from drake_twin.controllers.registry import controller
from drake_twin.controllers.steering_controller import SteeringController, SteeringParameters
from drake_twin.dataclass import dataclass


@dataclass(frozen=True, kw_only=True)
class TricycleSteeringParameters(SteeringParameters):
    """Parameters of ``tricycle_steering_controller/TricycleSteeringController``.

    Attributes:
        wheel_track: Deprecated.
        traction_track_width: The distance between the driven wheels (m).
        wheelbase: The distance between the axles (m).
        traction_wheels_radius: The radius of the driven wheels (m).
        front_wheels_radius: Deprecated.
        rear_wheels_radius: Deprecated.
    """

    wheel_track: float = 0.0
    traction_track_width: float = 0.0
    wheelbase: float = field(metadata={"above": 0.0})
    traction_wheels_radius: float = 0.0
    front_wheels_radius: float = 0.0
    rear_wheels_radius: float = 0.0

    def kinematics(self) -> SteeringDrive:
        """Return the drive; the deprecated names are applied as upstream does."""
        return SteeringDrive(
            wheelbase=self.wheelbase,
            wheel_radius=self.rear_wheels_radius or self.front_wheels_radius or self.traction_wheels_radius,
            driven=2,
            driven_track=self.wheel_track or self.traction_track_width,
        )


@controller("tricycle_steering_controller/TricycleSteeringController")
class TricycleSteeringController(SteeringController):
    """Implement ``tricycle_steering_controller/TricycleSteeringController``; see `SteeringController`."""

    Parameters: ClassVar[type] = TricycleSteeringParameters
