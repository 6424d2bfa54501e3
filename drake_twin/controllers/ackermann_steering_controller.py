"""Steering of a base with two driven and two steered wheels, like a car."""

from dataclasses import field
from typing import ClassVar

from drake_twin.control.drive_kinematics import SteeringDrive
from drake_twin.controllers.registry import controller
from drake_twin.controllers.steering_controller import SteeringController, SteeringParameters
from drake_twin.dataclass import dataclass


@dataclass(frozen=True, kw_only=True)
class AckermannSteeringParameters(SteeringParameters):
    """Parameters of ``ackermann_steering_controller/AckermannSteeringController``.

    Attributes:
        front_wheel_track: Deprecated.
        steering_track_width: The distance between the steered wheels (m); 0 for that of the driven ones.
        rear_wheel_track: Deprecated.
        traction_track_width: The distance between the driven wheels (m).
        wheelbase: The distance between the axles (m).
        traction_wheels_radius: The radius of the driven wheels (m).
        front_wheels_radius: Deprecated.
        rear_wheels_radius: Deprecated.
    """

    front_wheel_track: float = 0.0
    steering_track_width: float = 0.0
    rear_wheel_track: float = 0.0
    traction_track_width: float = 0.0
    wheelbase: float = field(metadata={"above": 0.0})
    traction_wheels_radius: float = 0.0
    front_wheels_radius: float = 0.0
    rear_wheels_radius: float = 0.0

    def kinematics(self) -> SteeringDrive:
        """Return the drive; the deprecated names are applied as upstream does."""
        driven_track, steered_track = (
            self.by_axle(self.front_wheel_track, self.rear_wheel_track, kind) or width
            for kind, width in (("traction", self.traction_track_width), ("steering", self.steering_track_width))
        )
        return SteeringDrive(
            wheelbase=self.wheelbase,
            wheel_radius=self.rear_wheels_radius or self.front_wheels_radius or self.traction_wheels_radius,
            driven=2,
            steered=2,
            driven_track=driven_track,
            steered_track=steered_track or driven_track,
        )


@controller("ackermann_steering_controller/AckermannSteeringController")
class AckermannSteeringController(SteeringController):
    """Implement ``ackermann_steering_controller/AckermannSteeringController``; see `SteeringController`."""

    Parameters: ClassVar[type] = AckermannSteeringParameters
