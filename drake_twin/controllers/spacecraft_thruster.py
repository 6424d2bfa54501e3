"""A thruster that is either on or off, as gz-sim's SpacecraftThrusterModel."""

from collections.abc import Sequence
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import BasicVector, Context

from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import ACTUATORS, SPACECRAFT_THRUSTER
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import CommandError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.plant_reading import physics_step
from drake_twin.systems.weak_callback import weakly


@dataclass(frozen=True, kw_only=True)
class SpacecraftThrusterParameters:
    """Parameters of ``gz_sim/SpacecraftThruster``, named after those of ``gz-sim-spacecraft-thruster-model-system``.

    Attributes:
        link_name: The link that is pushed, along its z axis and at its center of mass.
        actuator_number: The number of its command in the messages, from 0.
        max_thrust: The thrust while it is on (N).
        duty_cycle_frequency: How often it turns on and off (Hz).
    """

    link_name: str
    actuator_number: int = 0
    max_thrust: float = 0.0
    duty_cycle_frequency: float = 10.0

    def __post_init__(self) -> None:
        if not self.duty_cycle_frequency > 0.0:
            what = f"duty_cycle_frequency is {self.duty_cycle_frequency:g}, and has to be above zero"
            raise ParameterError(what, "duty_cycle_frequency")
        if self.actuator_number < 0:
            raise ParameterError(f"actuator_number is {self.actuator_number}, which is not an index", "actuator_number")


@saved("DutyCycle")
@dataclass(frozen=True)
class DutyCycle(Frozen):
    """How long a thruster is on.

    Attributes:
        start: The time at which the first cycle began (s).
        part: The part of each cycle, from 0 to 1, at whose begin it is on.
    """

    start: float = 0.0
    part: float = 0.0


class SpacecraftThrusterForces(BodyForces):
    """The thrusts of all thrusters: in each step the mean of what is on and off in it."""

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        found = [source.setup.parameters for source, _ in sources]
        self.bodies: list[RigidBody] = [
            body.link(parameters.link_name) for parameters, (_, body) in zip(found, sources, strict=True)
        ]
        forces = np.array([[0.0, 0.0, parameters.max_thrust] for parameters in found])
        centers = np.array([body.default_com() for body in self.bodies])
        self._wrenches = np.hstack([np.cross(centers, forces), forces])
        self._frequencies = np.array([parameters.duty_cycle_frequency for parameters in found])
        self._step = physics_step(sources[0][1].plant)

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the thrust on each link."""
        starts, parts = signals.reshape(-1, 2).T
        cycles = (motion.time - starts) * self._frequencies
        if self._step == 0.0:
            on = (np.mod(cycles, 1.0) < parts).astype(float)
        else:
            half = self._frequencies * self._step / 2
            on = (_cycles_on(cycles + half, parts) - _cycles_on(np.maximum(cycles - half, 0.0), parts)) / (2 * half)
        wrenches: np.ndarray = on[:, None] * self._wrenches
        return wrenches


def _cycles_on(cycles: np.ndarray, parts: np.ndarray) -> np.ndarray:
    """Return how many of some cycles since the start each thruster has been on."""
    whole = np.floor(cycles)
    found: np.ndarray = whole * parts + np.minimum(cycles - whole, parts)
    return found


@controller(SPACECRAFT_THRUSTER)
class SpacecraftThruster(ForceController, Controller):
    """Push a link for a part of each cycle.

    Behaves as gz-sim's SpacecraftThrusterModel (from its sources): the cycles begin with the first command. Unlike
    there, each lasts exactly 1 / ``duty_cycle_frequency``, and a step that is only partly on has a part of the thrust.

    .. pydrake_system::

        name: SpacecraftThruster
        input_ports:
        - duty_cycle
        output_ports:
        - signals

    - ``duty_cycle``: ``actuator_msgs/msg/Actuators``, whose ``normalized`` has the parts, as `DutyCycle`.
    - ``signals``: the time at which the cycles began (s), and the part of them at whose begin it is on.
    """

    Parameters: ClassVar[type] = SpacecraftThrusterParameters
    Forces: ClassVar[type[BodyForces]] = SpacecraftThrusterForces

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._command = self.declare_topic_input("duty_cycle", ACTUATORS)
        ticket = self.input_port_ticket(self._command.get_index())
        self.DeclareVectorOutputPort("signals", 2, weakly(self._calc_signals), {ticket})

    def read(self, topic: str, message: Any, context: Context) -> DutyCycle:
        """Return the thruster's own part; the cycles go on.

        Raises:
            CommandError: If the message has none for it, or it is not finite.
        """
        number, parts = self.setup.parameters.actuator_number, message.normalized
        if number >= len(parts):
            raise CommandError(f"{topic}: normalized has {len(parts)} numbers, and this thruster's is number {number}")
        part = float(parts[number])
        if not isfinite(part):
            raise CommandError(f"{topic}: {part:g} is not finite")
        before = self.received(self._command, context)
        start = context.get_time() if before is None else before.start
        return DutyCycle(start, min(max(part, 0.0), 1.0))

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        cycle = self.received(self._command, context) or DutyCycle()
        output.SetFromVector([cycle.start, cycle.part])
