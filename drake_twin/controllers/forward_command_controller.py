"""Joint commands from a topic, as ros2_controllers' forward command controllers write them."""

from dataclasses import field
from math import isfinite, nan
from typing import Any, ClassVar

from pydrake.systems.framework import BasicVector, Context, InputPort

from drake_twin import messages
from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.errors import CommandError
from drake_twin.systems.no_message import NO_MESSAGE


@dataclass(frozen=True, kw_only=True)
class CommandTimeoutParameters:
    """The parameter that the twin adds to all forward command controllers.

    Attributes:
        command_timeout: The time after which a command expires (s); 0 for never. ros2_controllers has no such
            parameter.
    """

    command_timeout: float = field(default=0.0, metadata={"lower": 0.0})


@dataclass(frozen=True)
class ForwardCommandParameters(CommandTimeoutParameters):
    """Parameters of ``forward_command_controller/ForwardCommandController``.

    Attributes:
        joints: The joints, in the order of a command's elements.
        interface_name: The command interface of all joints.
    """

    joints: tuple[str, ...]
    interface_name: str = field(metadata={"not_empty": True})


@dataclass(frozen=True)
class MultiInterfaceForwardCommandParameters(CommandTimeoutParameters):
    """Parameters of ``forward_command_controller/MultiInterfaceForwardCommandController``.

    Attributes:
        joint: The joint.
        interface_names: Its command interfaces, in the order of a command's elements.
    """

    joint: str = field(metadata={"not_empty": True})
    interface_names: tuple[str, ...]


class NumbersForClaims:
    """How a controller takes one number for each command interface that it claims.

    Attributes:
        claims: The claimed interfaces; a controller has them.
        has_positions: Whether one of the numbers is a position.
    """

    claims: tuple[Interface, ...]
    has_positions: bool

    def read(self, topic: str, message: Any, context: Context) -> messages.Numbers:
        """Convert a message to numbers, one for each claim.

        Raises:
            CommandError: If the number of elements is wrong, for which ros2_control deactivates the controller, or an
                element is not finite, for which the message is dropped.
        """
        data = tuple(map(float, message.data))
        if len(data) != len(self.claims):
            raise CommandError(
                f"the command has {len(data)} elements, but there are {len(self.claims)} command interfaces:"
                f" {', '.join(map(str, self.claims))}",
                deactivates=True,
            )
        for claim, number in zip(self.claims, data, strict=True):
            if not isfinite(number):
                raise CommandError(f"the command for {claim} is {number}, which is not a finite number")
        return messages.Numbers(data)

    def starts_or_stops(self, before: messages.Numbers | None, now: messages.Numbers | None) -> bool:
        """Return whether a joint may start or stop: a new position may be far away, a velocity of zero brakes."""
        if before is None or now is None or self.has_positions:
            return True
        return before.data != now.data and [*map(bool, before.data)] != [*map(bool, now.data)]


@controller("forward_command_controller/ForwardCommandController")
class ForwardCommandController(NumbersForClaims, Controller):
    """Forward commands to command interfaces as they arrive.

    Behaves as ``forward_command_controller/ForwardCommandController`` does in ROS 2 Jazzy. It has no state and no
    events: its output is computed once a message.

    .. pydrake_system::

        name: ForwardCommandController
        input_ports:
        - commands
        output_ports:
        - command_interfaces

    - ``commands``: `messages.Numbers` from ``std_msgs/msg/Float64MultiArray``, one for each claim (rad, rad/s, N·m, or
      m, m/s, N); topic ``~/commands``. None before the first message.
    - ``command_interfaces``: the same as a vector; NaN before the first message.
    """

    Parameters: ClassVar[type] = ForwardCommandParameters

    @classmethod
    def claimed_interfaces(
        cls, parameters: ForwardCommandParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the interface of each joint."""
        return tuple(Interface(joint, parameters.interface_name) for joint in parameters.joints)

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self.has_positions = any(claim.name == "position" for claim in self.claims)
        self._commands = self.declare_topic_input("commands", "std_msgs/msg/Float64MultiArray")
        self.declare_command_interfaces(
            self._calc_command_interfaces, {self.input_port_ticket(self._commands.get_index())}
        )

    def get_commands_input_port(self) -> InputPort:
        """Return the port ``commands``."""
        return self._commands

    def timeout(self, topic: str) -> float | None:
        """Return the parameter ``command_timeout``."""
        return self.setup.parameters.command_timeout or None

    def _calc_command_interfaces(self, context: Context, output: BasicVector) -> None:
        # Not `received`: this call is on the shortest path from a message to a joint.
        numbers = self._commands.Eval(context) if self._commands.HasValue(context) else NO_MESSAGE
        output.SetFromVector([nan] * len(self.claims) if numbers is NO_MESSAGE else numbers.data)


@controller("forward_command_controller/MultiInterfaceForwardCommandController")
class MultiInterfaceForwardCommandController(ForwardCommandController):
    """Forward commands to several command interfaces of one joint."""

    Parameters: ClassVar[type] = MultiInterfaceForwardCommandParameters

    @classmethod
    def claimed_interfaces(cls, parameters: Any, description: RobotDescription) -> tuple[Interface, ...]:
        """Return each interface of the joint."""
        return tuple(Interface(parameters.joint, name) for name in parameters.interface_names)
