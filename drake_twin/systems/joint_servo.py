"""What the controllers of a robot command, put together into the desired state of its joint servos."""

from collections.abc import Mapping, Sequence

import numpy as np
from pydrake.systems.framework import BasicVector, Context, InputPort, LeafSystem, OutputPort

from drake_twin.systems.weak_callback import weakly


class JointServo(LeafSystem):
    """Fans the controllers' joint velocities in to the plant's desired-state port of one robot.

    The servo itself is Drake's implicit PD inside the plant, so no Python runs in a physics step. As in
    gz_ros2_control, a joint that nobody commands is held: at zero velocity when a controller has claimed it, at its
    start position when none has.

    .. pydrake_system::

        name: JointServo
        input_ports:
        - <controller>
        output_ports:
        - desired_state

    - ``<controller>``, one port for each: vector of joint velocities (rad/s or m/s) in that controller's joint order;
      NaN where it has no command.
    - ``desired_state``: vector ``[q_d; v_d]`` in the order of the robot's actuators (rad, rad/s, or m, m/s). It depends
      on the controllers' ports alone, so it is computed once a command.

    Args:
        hold_positions: the position at which each actuator's joint is held (rad or m); of no meaning for an actuator
            without stiffness, such as one that models joint friction.
        controllers: controller name → for each of its joints the index of that joint's actuator.
    """

    def __init__(self, hold_positions: Sequence[float], controllers: Mapping[str, Sequence[int]]):
        super().__init__()
        self._hold_positions = np.array(hold_positions, dtype=float)
        self._inputs = [
            (self.DeclareVectorInputPort(name, len(actuators)), np.array(actuators, dtype=int))
            for name, actuators in controllers.items()
        ]
        self._desired_state = self.DeclareVectorOutputPort(
            "desired_state",
            2 * len(self._hold_positions),
            weakly(self._calc_desired_state),
            prerequisites_of_calc={self.input_port_ticket(port.get_index()) for port, _ in self._inputs}
            or {self.nothing_ticket()},
        )

    def get_controller_input_port(self, controller: str) -> InputPort:
        """The port of one controller."""
        return self.GetInputPort(controller)

    def get_desired_state_output_port(self) -> OutputPort:
        """The port ``desired_state``."""
        return self._desired_state

    def _calc_desired_state(self, context: Context, output: BasicVector) -> None:
        velocities = np.zeros_like(self._hold_positions)
        for port, actuators in self._inputs:
            velocities[actuators] = np.nan_to_num(port.Eval(context))
        output.SetFromVector(np.concatenate([self._hold_positions, velocities]))
