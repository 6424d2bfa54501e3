"""Joint velocity commands from a topic, as ros2_controllers' forward command controllers take them."""

from collections.abc import Sequence
from typing import Any

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context, InputPort, LeafSystem, OutputPort

from drake_twin.errors import CommandError
from drake_twin.systems.weak_callback import weakly


class VelocityController(LeafSystem):
    """Forwards joint velocities, clamped to the joints' limits.

    Behaves as ``forward_command_controller/ForwardCommandController`` with ``interface_name: velocity`` and
    ``velocity_controllers/JointGroupVelocityController`` do in ROS 2 Jazzy, with limits enforced.

    .. pydrake_system::

        name: VelocityController
        input_ports:
        - commands
        output_ports:
        - velocity_commands

    - ``commands``: ``std_msgs/msg/Float64MultiArray``, one velocity a joint (rad/s, or m/s for prismatic joints) in
      the order of ``joints``; topic ``~/commands``. ``None`` before the first message.
    - ``velocity_commands``: vector of the same size and units, clamped to ``[lower, upper]``. NaN before the first
      message: nothing is written to the joints. It depends on ``commands`` alone, so it is computed once a message.

    Args:
        joints: the joints' names, in the order of the parameters file.
        lower: the lowest velocity of each.
        upper: the highest velocity of each.

    Raises:
        CommandError: on evaluation, when the message has the wrong size or an element that is not finite.
    """

    def __init__(self, joints: Sequence[str], lower: Sequence[float], upper: Sequence[float]):
        super().__init__()
        self.joints = tuple(joints)
        self.lower = np.array(lower, dtype=float)
        self.upper = np.array(upper, dtype=float)
        if not len(self.joints) == len(self.lower) == len(self.upper):
            raise ValueError(
                f"{len(self.joints)} joints, but {len(self.lower)} lower and {len(self.upper)} upper limits"
            )
        self._commands = self.DeclareAbstractInputPort("commands", AbstractValue.Make(None))
        self._velocity_commands = self.DeclareVectorOutputPort(
            "velocity_commands",
            len(self.joints),
            weakly(self._calc_velocity_commands),
            prerequisites_of_calc={self.input_port_ticket(self._commands.get_index())},
        )

    def get_commands_input_port(self) -> InputPort:
        """The port ``commands``."""
        return self._commands

    def get_velocity_commands_output_port(self) -> OutputPort:
        """The port ``velocity_commands``."""
        return self._velocity_commands

    def check_command(self, message: Any) -> np.ndarray:
        """The velocities of a message, clamped.

        Raises:
            CommandError: the message has the wrong size, or an element is not a finite number.
        """
        data = np.asarray(message.data, dtype=float)
        if data.shape != (len(self.joints),):
            raise CommandError(
                f"the command has {data.size} elements, but there are {len(self.joints)} joints:"
                f" {', '.join(self.joints)}"
            )
        if not np.isfinite(data).all():
            bad = int(np.flatnonzero(~np.isfinite(data))[0])
            raise CommandError(f"the command for joint {self.joints[bad]} is {data[bad]}, which is not a finite number")
        return np.asarray(np.clip(data, self.lower, self.upper))

    def _calc_velocity_commands(self, context: Context, output: BasicVector) -> None:
        message = self._commands.Eval(context)
        if message is None:
            output.SetFromVector(np.full(len(self.joints), np.nan))
        else:
            output.SetFromVector(self.check_command(message))
