"""The combination of a robot's controllers' commands into the set-points of its joint servos."""

import logging
from collections.abc import Mapping, Sequence
from math import copysign, isnan, nan

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.tree import JointActuator
from pydrake.systems.framework import (
    AbstractStateIndex,
    BasicVector,
    Context,
    InputPort,
    NumericParameterIndex,
    OutputPort,
)

from drake_twin.dataclass import dataclass
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly
from drake_twin.systems.witnessless_system import WitnesslessSystem

_log = logging.getLogger(__name__)

COMMANDS = ("position", "velocity", "effort")  # the rows of the limits

_NO_EFFORT = 1e-12  # N·m or N; Drake refuses zero as a limit


@saved("ServoAssignment")
@dataclass(frozen=True)
class ServoAssignment(Frozen):
    """The sources of each actuator's set-points.

    A source is an index into the concatenation of the controllers' ports; -1 without a command.

    Attributes:
        modes: The mode of each actuator, as in `drake_twin.diagram.servo_gains`.
        holds: The position that is held without a command (rad or m).
        positions: The source of the commanded position.
        velocities: The source of the commanded velocity, or of the position's feedforward.
        efforts: The source of the commanded effort.
    """

    modes: tuple[str, ...]
    holds: tuple[float, ...]
    positions: tuple[int, ...]
    velocities: tuple[int, ...]
    efforts: tuple[int, ...]


class JointServo(WitnesslessSystem):
    """Combine the controllers' commands into the plant's input ports of one robot.

    The servo itself is Drake's implicit PD inside the plant, so no Python runs in a physics step. As in
    gz_ros2_control, an unclaimed joint is held, a joint with a claimed velocity that is not yet written stands still,
    and one with a claimed effort that is not yet written has zero effort. The assignment's modes define how each joint
    is driven at the moment; `drake_twin.twin.servo_modes` changes them as commands and motion require.

    .. pydrake_system::

        name: JointServo
        input_ports:
        - <controller>
        output_ports:
        - desired_state
        - actuation
        - commanded_motion

    - ``<controller>``, one port for each: that controller's ``command_interfaces`` (rad, rad/s, N·m, or m, m/s, N); NaN
      where it writes nothing.
    - ``desired_state``: vector ``[q_d; v_d]`` in the order of the robot's actuators (rad, rad/s, or m, m/s).
    - ``actuation``: vector of the efforts added to the servos' (N·m or N).
    - ``commanded_motion``: vector of one element: 1 if a velocity or an effort other than zero is commanded, else 0.

    They follow from the controllers' ports, the assignment and the shift alone, so they are computed once a command.
    Commands are clamped to the limits; the first command of each interface that is cut is logged as a warning. An
    effort drives its joint towards the joint's velocity limit, with that effort as the actuator's limit, which belongs
    to the plant.

    Args:
        controllers: Controller name → the number of its values.
        assignment: The assignment at the start.
        as_position: For a continuous plant, the seconds by which a velocity is ahead of its position, for each mode and
            each actuator: Drake's CENIC takes velocity targets with the wrong sign, so they are given as positions.
            None for a discrete plant.
        own_velocities: The velocities of the modes that do not follow a command (rad/s or m/s).
        lower: Three rows (position, velocity, effort) of the lowest command of each actuator.
        upper: Three rows of the highest command of each actuator.
        limited: Mode in which efforts act up to a joint's velocity limit → index of the actuator → the actuator in the
            plant, and that limit (rad/s or m/s).
        names: What warnings call each actuator's joint.
    """

    def __init__(
        self,
        controllers: Mapping[str, int],
        assignment: ServoAssignment,
        lower: np.ndarray,
        upper: np.ndarray,
        as_position: Mapping[str, Sequence[float]] | None = None,
        own_velocities: Mapping[str, Sequence[float]] | None = None,
        limited: Mapping[str, Mapping[int, tuple[JointActuator, float]]] | None = None,
        names: Sequence[str] = (),
    ):
        super().__init__()
        self._as_position = as_position
        self._own_velocities = own_velocities or {}
        self._limited = limited or {}
        self._lower, self._upper = np.array(lower, dtype=float).tolist(), np.array(upper, dtype=float).tolist()
        self._names = names or [f"actuator {index}" for index in range(len(self._lower[0]))]
        self._said: set[tuple[int, int]] = set()
        self._ports = [self.DeclareVectorInputPort(name, size) for name, size in controllers.items()]
        self._assignment: AbstractStateIndex = self.DeclareAbstractState(AbstractValue.Make(assignment))
        prerequisites = {self.input_port_ticket(port.get_index()) for port in self._ports}
        prerequisites.add(self.abstract_state_ticket(self._assignment))
        size = len(self._lower[0])
        self._shift = self.DeclareNumericParameter(BasicVector(np.zeros(size)))
        prerequisites.add(self.numeric_parameter_ticket(NumericParameterIndex(self._shift)))
        self._desired_state = self.DeclareVectorOutputPort(
            "desired_state", 2 * size, weakly(self._calc_desired_state), prerequisites
        )
        self._actuation = self.DeclareVectorOutputPort("actuation", size, weakly(self._calc_actuation), prerequisites)
        self._commanded_motion = self.DeclareVectorOutputPort(
            "commanded_motion", 1, weakly(self._calc_commanded_motion), prerequisites
        )

    def get_controller_input_port(self, controller: str) -> InputPort:
        """Return the port of one controller."""
        return self.GetInputPort(controller)

    def get_desired_state_output_port(self) -> OutputPort:
        """Return the port ``desired_state``."""
        return self._desired_state

    def get_actuation_output_port(self) -> OutputPort:
        """Return the port ``actuation``."""
        return self._actuation

    def get_commanded_motion_output_port(self) -> OutputPort:
        """Return the port ``commanded_motion``."""
        return self._commanded_motion

    @property
    def moves_limits(self) -> bool:
        """Whether it changes the effort limits of the plant's motors."""
        return any(self._limited.values())

    def assignment(self, context: Context) -> ServoAssignment:
        """Return the present sources of each actuator's set-points."""
        assignment: ServoAssignment = context.get_abstract_state(int(self._assignment)).get_value()
        return assignment

    def assign(self, context: Context, assignment: ServoAssignment) -> None:
        """Change the sources of the set-points; the caller applies the gains of the new modes to the plant."""
        context.SetAbstractState(int(self._assignment), assignment)

    def shift(self, context: Context) -> np.ndarray:
        """Return by how much each actuator is drawn elsewhere than commanded (rad or m); zero at the start."""
        return np.array(context.get_numeric_parameter(self._shift).value())

    def set_shift(self, context: Context, shift: np.ndarray) -> None:
        """Let the servos draw to other positions than commanded, as those of a robot that gives way do."""
        context.get_mutable_numeric_parameter(self._shift).SetFromVector(shift)

    def check(self, assignment: ServoAssignment) -> None:
        """Check that an assignment fits this robot.

        Raises:
            ValueError: If it has the wrong number of actuators, or a source does not exist.
        """
        count, values = len(self._lower[0]), sum(port.size() for port in self._ports)
        columns = vars(assignment).values()
        sources = (*assignment.positions, *assignment.velocities, *assignment.efforts)
        if any(len(column) != count for column in columns) or not all(-1 <= index < values for index in sources):
            raise ValueError(f"there are {count} actuators, and {values} values of controllers for them")

    def commanded(self, context: Context) -> tuple[list[float], list[float]]:
        """Return all actuators' commanded positions and velocities, within their limits; NaN without a command."""
        assignment, values = self.assignment(context), self._values(context)
        return self._clamped(0, values, assignment.positions), self._clamped(1, values, assignment.velocities)

    def _values(self, context: Context) -> list[float]:
        """Return all controllers' values, with NaN as the last one."""
        values: list[float] = []
        for port in self._ports:
            values += port.Eval(context).tolist()
        values.append(nan)
        return values

    def _clamped(self, row: int, values: Sequence[float], sources: Sequence[int]) -> list[float]:
        """Return the command of each actuator within its limits; NaN without one."""
        clamped = []
        for index, (source, lower, upper) in enumerate(zip(sources, self._lower[row], self._upper[row], strict=True)):
            value = values[source]
            if value < lower or value > upper:
                limit = lower if value < lower else upper
                if (row, index) not in self._said:
                    self._said.add((row, index))
                    text = "%s: the %s command %g is beyond the limit %g: it is cut to the limit"
                    _log.warning(text, self._names[index], COMMANDS[row], value, limit)
                value = limit
            clamped.append(value)
        return clamped

    def _calc_desired_state(self, context: Context, output: BasicVector) -> None:
        assignment, values = self.assignment(context), self._values(context)
        positions = self._clamped(0, values, assignment.positions)
        velocities = self._clamped(1, values, assignment.velocities)
        shift = context.get_numeric_parameter(self._shift).value().tolist()
        for index, source in enumerate(assignment.positions):
            if isnan(positions[index]):
                positions[index] = assignment.holds[index]
            # At the end of its range a joint must not move on at the velocity of a position beyond.
            at_end = source >= 0 and not self._lower[0][index] < positions[index] < self._upper[0][index]
            if at_end or isnan(velocities[index]):
                velocities[index] = 0.0
            positions[index] += shift[index]
            if assignment.modes[index] in self._own_velocities:
                velocities[index] = self._own_velocities[assignment.modes[index]][index]
        if self._limited:
            efforts = self._clamped(2, values, assignment.efforts)
            for index, (_, fastest) in self._limited_now(assignment).items():
                if abs(efforts[index]) > 0.0:
                    velocities[index] = copysign(fastest, efforts[index])
        if self._as_position is not None:
            ahead = [self._as_position[mode][index] for index, mode in enumerate(assignment.modes)]
            positions = [p + v * seconds for p, v, seconds in zip(positions, velocities, ahead, strict=True)]
            velocities = [0.0] * len(velocities)
        output.SetFromVector(positions + velocities)

    def _calc_actuation(self, context: Context, output: BasicVector) -> None:
        assignment = self.assignment(context)
        efforts = [
            0.0 if isnan(effort) else effort for effort in self._clamped(2, self._values(context), assignment.efforts)
        ]
        for index, (actuator, _) in self._limited_now(assignment).items() if self._limited else ():
            actuator.set_effort_limit(max(abs(efforts[index]), _NO_EFFORT))
        output.SetFromVector(efforts)

    def _calc_commanded_motion(self, context: Context, output: BasicVector) -> None:
        assignment, values = self.assignment(context), self._values(context)
        commands = [values[source] for source in (*assignment.velocities, *assignment.efforts)]
        output.SetFromVector([float(any(command and not isnan(command) for command in commands))])

    def _limited_now(self, assignment: ServoAssignment) -> dict[int, tuple[JointActuator, float]]:
        """Return those whose efforts act up to a velocity limit in their present mode."""
        return {
            index: limit
            for mode, limits in self._limited.items()
            for index, limit in limits.items()
            if assignment.modes[index] == mode
        }
