"""A base on wheels with friction in one direction each, which moves as these wheels roll."""

from dataclasses import field
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import Context

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.periodic_controller import PeriodicController, Update
from drake_twin.controllers.planar_move_controller import along_start
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import PLANAR_INTERFACES, ROLLER_WHEELS
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription


@dataclass(frozen=True, kw_only=True)
class RollerWheelsParameters:
    """Parameters of ``drake_twin/RollerWheels``, one element of each for a wheel.

    Attributes:
        wheels: The joints of the wheels.
        center_x: The wheels' centers in the root link, along x (m).
        center_y: The same along y (m).
        direction_x: The directions of their friction in the root link, along x; with ``direction_y`` of length 1.
        direction_y: The same along y.
        rim: How far the base at the wheel moves along the direction in a turn by 1 rad (m).
        friction: The smallest of their coefficients of friction.
    """

    wheels: tuple[str, ...]
    center_x: tuple[float, ...]
    center_y: tuple[float, ...]
    direction_x: tuple[float, ...]
    direction_y: tuple[float, ...]
    rim: tuple[float, ...]
    friction: float = field(default=1.0, metadata={"lower": 0.0})

    def __post_init__(self) -> None:
        for name in ("center_x", "center_y", "direction_x", "direction_y", "rim"):
            if len(getattr(self, name)) != len(self.wheels):
                has = len(getattr(self, name))
                raise ParameterError(f"{name} has {has} elements; {len(self.wheels)} wheels need one each", name)


@controller(ROLLER_WHEELS)
class RollerWheelsController(PeriodicController):
    """Move a base over the plane as its wheels roll: none slips along the direction of its friction, all slide across.

    Where the wheels contradict each other, the base moves with the least sum of squares of what they slip.

    .. pydrake_system::

        name: RollerWheelsController
        input_ports:
        - state
        output_ports:
        - command_interfaces

    - ``command_interfaces``: the velocities of the joints that move the base: along x and y of its start pose (m/s),
      and about z (rad/s).
    """

    Parameters: ClassVar[type] = RollerWheelsParameters

    @classmethod
    def claimed_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return the velocities of the joints that move the base."""
        return tuple(Interface(*interface) for interface in PLANAR_INTERFACES)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        parameters: RollerWheelsParameters = setup.parameters
        x, y, along_x, along_y, rim = (
            np.array(getattr(parameters, name))
            for name in ("center_x", "center_y", "direction_x", "direction_y", "rim")
        )
        # A row for each wheel: its velocity along its direction, by the base's vx, vy and turn.
        slips = np.column_stack([along_x, along_y, x * along_y - y * along_x])
        self._twist_of_wheels = np.linalg.pinv(slips) * rim

    def start(self, context: Context) -> None:
        """Return nothing: the base has no memory."""

    def update(self, context: Context, time: float, memory: None) -> Update:
        """Command the velocity with which the wheels roll."""
        wheels = self.velocities(context, self.setup.parameters.wheels)
        twist = (self._twist_of_wheels @ wheels).tolist()
        return Update(memory, along_start(self, context, *twist))
