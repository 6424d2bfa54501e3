"""Where each joint of a robot stands in its model instance's state vector."""

from collections.abc import Mapping
from dataclasses import dataclass


@dataclass(frozen=True)
class StateLayout:
    """Indices into a model instance's state ``[q; v]`` and actuation ``u``, as its plant's ports carry them.

    Attributes:
        size: the number of elements of ``[q; v]``.
        positions: joint name → index of its position (rad or m).
        velocities: joint name → index of its velocity (rad/s or m/s).
        efforts: joint name → index of the actuator that drives it (N·m or N); joints without one are left out.
        num_actuators: the number of actuators, those that model joint friction included.
        base_position: index of a floating base's seven positions (qw, qx, qy, qz, x, y, z); None for a fixed base.
        base_velocity: index of its six velocities (angular rad/s, then linear m/s, both in the world frame).
    """

    size: int
    positions: Mapping[str, int]
    velocities: Mapping[str, int]
    efforts: Mapping[str, int]
    num_actuators: int = 0
    base_position: int | None = None
    base_velocity: int | None = None
