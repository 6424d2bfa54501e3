"""Efforts from a vector port, for controllers that are Drake systems of the user's own."""

from math import nan
from typing import ClassVar

import numpy as np
from pydrake.systems.framework import BasicVector, Context

from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription


@dataclass(frozen=True)
class VectorCommandParameters:
    """Parameters of ``drake_twin/VectorCommandController``.

    Attributes:
        joints: the joints, in the order of the port's elements.
    """

    joints: tuple[str, ...]


@controller("drake_twin/VectorCommandController")
class VectorCommandController(Controller):
    """Writes a vector port to the effort interfaces of joints, without delay.

    The port stands on the root diagram as ``<robot>/<controller>/command``, and on the robot's sub-diagram, where an
    extension of the diagram connects it. A value acts at once: together with ``<robot>/state_estimated`` it closes no
    algebraic loop. Like every controller it excludes others from its joints while it is active.

    .. pydrake_system::

        name: VectorCommandController
        input_ports:
        - command
        output_ports:
        - command_interfaces

    - ``command``: vector with an effort for each joint (N·m or N); without a value nothing is written.
    - ``command_interfaces``: the same; NaN where nothing is written.
    """

    Parameters: ClassVar[type] = VectorCommandParameters
    needs_command_interfaces = False

    @classmethod
    def claimed_interfaces(
        cls, parameters: VectorCommandParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the effort of each joint."""
        return tuple(Interface(joint, "effort") for joint in parameters.joints)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._command = self.declare_vector_input("command", len(self.claims))
        self.declare_command_interfaces(
            self._calc_command_interfaces, {self.input_port_ticket(self._command.get_index())}
        )

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        if not self._command.HasValue(context):
            output.SetFromVector([nan] * len(self.claims))
            return
        efforts = self._command.Eval(context)
        if not np.isfinite(efforts).all():
            raise ValueError(f"controller {self.setup.name}: the efforts on its port command are {efforts.tolist()}")
        output.SetFromVector(efforts)
