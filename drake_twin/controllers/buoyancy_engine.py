"""A bladder whose volume lifts a vehicle in water, as gz-sim's BuoyancyEngine."""

from collections.abc import Sequence
from dataclasses import field
from math import inf, isfinite
from typing import Any, ClassVar

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.multibody.tree import RigidBody
from pydrake.systems.framework import BasicVector, Context

from drake_twin import messages
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.registry import controller
from drake_twin.controllers.stateful_controller import Sample, StatefulController
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import BUOYANCY_ENGINE
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import CommandError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.no_message import set_value
from drake_twin.systems.weak_callback import weakly

_NUMBER = "std_msgs/msg/Float64"


@dataclass(frozen=True, kw_only=True)
class BuoyancyEngineParameters:
    """Parameters of ``gz_sim/BuoyancyEngine``, named after the elements of ``gz-sim-buoyancy-engine-system``.

    Attributes:
        link_name: The link that is lifted, at its origin.
        min_volume: The smallest volume that can be asked for (m³).
        max_volume: The largest one (m³).
        default_volume: The volume at the start (m³).
        first_volume: The volume that it approaches before the first command (m³).
        neutral_volume: The volume that lifts as much as the bladder weighs (m³).
        max_inflation_rate: How fast the volume changes (m³/s).
        fluid_density: In kg/m³.
        surface: The height above which nothing lifts (m); none by default.
    """

    link_name: str
    min_volume: float = 3e-5
    max_volume: float = 9.9e-4
    default_volume: float = 3e-5
    first_volume: float = 3e-5
    neutral_volume: float = 3e-4
    max_inflation_rate: float = field(default=3e-6, metadata={"lower": 0.0})
    fluid_density: float = 1000.0
    surface: float = inf

    def __post_init__(self) -> None:
        if self.max_volume < self.min_volume:
            raise ParameterError("max_volume is less than min_volume", "max_volume")


@saved("VolumeCommand")
@dataclass(frozen=True)
class VolumeCommand(Frozen):
    """What the bladder approaches.

    Attributes:
        time: The time since which it does (s).
        start: The volume then (m³).
        target: The volume that it is to have (m³).
    """

    time: float
    start: float
    target: float

    def at(self, time: float, rate: float) -> float:
        """Return the volume at a time (s), where it changes at a rate (m³/s)."""
        change, most = self.target - self.start, rate * max(time - self.time, 0.0)
        return self.start + min(max(change, -most), most)


class BuoyancyEngineForces(BodyForces):
    """What all bladders lift less what they weigh, against gravity and at the origins of their links."""

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        found = [source.setup.parameters for source, _ in sources]
        self.bodies: list[RigidBody] = [
            body.link(parameters.link_name) for parameters, (_, body) in zip(found, sources, strict=True)
        ]
        self._gravity = sources[0][1].gravity
        self._rates = np.array([parameters.max_inflation_rate for parameters in found])
        self._densities = np.array([parameters.fluid_density for parameters in found])
        self._neutral = np.array([parameters.neutral_volume for parameters in found])
        self._surfaces = np.array([parameters.surface for parameters in found])

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the force on each link."""
        is_active, times, starts, targets = signals.reshape(-1, 4).T
        most = self._rates * np.maximum(motion.time - times, 0.0)
        volumes = starts + np.clip(targets - starts, -most, most)
        volumes = np.where(motion.origins[:, 2] < self._surfaces, volumes, 0.0)
        lifts = is_active * self._densities * (self._neutral - volumes)
        forces = (lifts[:, None, None] * self._gravity) @ motion.R_WB
        return np.concatenate([np.zeros((len(lifts), 3)), forces[:, 0]], axis=1)


@controller(BUOYANCY_ENGINE)
class BuoyancyEngine(ForceController, StatefulController):
    """Change the volume of a bladder, whose buoyancy less its weight acts on a link.

    Behaves as gz-sim's BuoyancyEngine (from its sources): the volume approaches the commanded one at a constant rate.

    .. pydrake_system::

        name: BuoyancyEngine
        input_ports:
        - buoyancy_engine
        output_ports:
        - signals
        - current_volume

    - ``buoyancy_engine``: ``std_msgs/msg/Float64``, the volume to have (m³), as `VolumeCommand`.
    - ``signals``: whether it is active (1 or 0), and time (s), volume then and target (m³) of the last command.
    - ``current_volume``: ``std_msgs/msg/Float64`` (m³) of the present time; None while inactive.
    """

    Parameters: ClassVar[type] = BuoyancyEngineParameters
    Forces: ClassVar[type[BodyForces]] = BuoyancyEngineForces

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup, initial=Sample())
        self._command = self.declare_topic_input("buoyancy_engine", _NUMBER)
        tickets = {self.sample_ticket(), self.input_port_ticket(self._command.get_index())}
        self.DeclareVectorOutputPort("signals", 4, weakly(self._calc_signals), tickets)
        self.declare_topic_output("current_volume", _NUMBER, self._calc_volume, {*tickets, self.time_ticket()})

    def activate(self, context: Context) -> None:
        """Start with the volume of the start."""
        self.set_sample(context, Sample(active=True, time=context.get_time()))

    def read(self, topic: str, message: Any, context: Context) -> VolumeCommand:
        """Return a command within the range of volumes, from the volume that there is now."""
        parameters, value = self.setup.parameters, float(message.data)
        if not isfinite(value):
            raise CommandError(f"{topic}: {value:g} is not finite")
        target = min(max(value, parameters.min_volume), parameters.max_volume)
        time = context.get_time()
        return VolumeCommand(time, self._now(context).at(time, parameters.max_inflation_rate), target)

    def _now(self, context: Context) -> VolumeCommand:
        parameters = self.setup.parameters
        command: VolumeCommand | None = self.received(self._command, context)
        if command is not None:
            return command
        return VolumeCommand(self.sample(context).time, parameters.default_volume, parameters.first_volume)

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        now = self._now(context)
        output.SetFromVector([float(self.sample(context).active), now.time, now.start, now.target])

    def _calc_volume(self, context: Context, output: AbstractValue) -> None:
        if not self.sample(context).active:
            set_value(output, None)
            return
        volume = self._now(context).at(context.get_time(), self.setup.parameters.max_inflation_rate)
        set_value(output, messages.message(_NUMBER, {"data": volume}))
