"""Forward command controllers that are named after their interface."""

from typing import ClassVar

from drake_twin.controllers.forward_command_controller import CommandTimeoutParameters, ForwardCommandController
from drake_twin.controllers.interface import Interface
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription


@dataclass(frozen=True)
class JointGroupParameters(CommandTimeoutParameters):
    """Parameters of the JointGroup controllers.

    Attributes:
        joints: The joints, in the order of a command's elements.
    """

    joints: tuple[str, ...]


class JointGroupController(ForwardCommandController):
    """Forward commands to one interface of each joint.

    Attributes:
        interface: ``position``, ``velocity`` or ``effort``.
    """

    Parameters: ClassVar[type] = JointGroupParameters
    interface: ClassVar[str]

    @classmethod
    def claimed_interfaces(  # type: ignore[override]  # parameters of its own
        cls, parameters: JointGroupParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the interface of each joint."""
        return tuple(Interface(joint, cls.interface) for joint in parameters.joints)
