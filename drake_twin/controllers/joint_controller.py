"""gz-sim's controller of velocities that begins with one."""

from typing import ClassVar

from pydrake.systems.framework import BasicVector, Context

from drake_twin.controllers.joint_group_controller import JointGroupController, JointGroupParameters
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import JOINT_CONTROLLER
from drake_twin.systems.no_message import NO_MESSAGE


@dataclass(frozen=True)
class JointControllerParameters(JointGroupParameters):
    """Parameters of ``gz_sim/JointController``.

    Attributes:
        initial_velocity: The velocity of all joints before the first command (rad/s or m/s).
    """

    initial_velocity: float = 0.0


@controller(JOINT_CONTROLLER)
class JointController(JointGroupController):
    """Command velocities: one from the start, then those of messages.

    Behaves as gz-sim's JointController with an ``<initial_velocity>``, and otherwise as JointGroupVelocityController
    of velocity_controllers.
    """

    Parameters: ClassVar[type] = JointControllerParameters
    interface = "velocity"
    needs_command_interfaces = False

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        port = self.get_commands_input_port()
        numbers = port.Eval(context) if port.HasValue(context) else NO_MESSAGE
        initial = [self.setup.parameters.initial_velocity] * len(self.claims)
        output.SetFromVector(initial if numbers is NO_MESSAGE else numbers.data)
