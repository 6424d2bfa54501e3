"""A bladder that is filled and drained to rise and dive, as gz-sim's BuoyancyEngine."""

from collections.abc import Sequence
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from pydrake.common.value import AbstractValue
from pydrake.systems.framework import BasicVector, Context

from drake_twin import messages
from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import BUOYANCY_ENGINE
from drake_twin.description.parameters import ParameterError
from drake_twin.errors import CommandError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.no_message import set_value
from drake_twin.systems.weak_callback import weakly

_FLOAT = "std_msgs/msg/Float64"


@dataclass(frozen=True, kw_only=True)
class BuoyancyEngineParameters:
    """Parameters of ``gz_sim/BuoyancyEngine``, named after the elements of ``gz-sim-buoyancy-engine-system``.

    Attributes:
        link_name: The link with the bladder.
        min_volume: The smallest volume of a command (m³).
        max_volume: The largest one.
        neutral_volume: The volume whose buoyancy is the weight of what fills the bladder (m³).
        default_volume: The volume at the start (m³).
        first_target: The volume that it approaches from time zero on, until a command comes (m³).
        max_inflation_rate: How fast the volume changes (m³/s).
        fluid_density: In kg/m³.
        surface: The height above which the link's origin is not in the fluid (m).
    """

    link_name: str
    min_volume: float = 3e-5
    max_volume: float = 9.9e-4
    neutral_volume: float = 3e-4
    default_volume: float = 3e-5
    first_target: float = 3e-5
    max_inflation_rate: float = 3e-6
    fluid_density: float = 1000.0
    surface: float = 1e300

    def __post_init__(self) -> None:
        for name in ("max_inflation_rate", "fluid_density"):
            if getattr(self, name) < 0.0:
                raise ParameterError(f"{name} is {getattr(self, name):g}, and has to be zero or more", name)
        if self.max_volume < self.min_volume:
            raise ParameterError("max_volume is less than min_volume", "max_volume")


@saved("BladderVolume")
@dataclass(frozen=True)
class BladderVolume(Frozen):
    """A volume that approaches another one at the bladder's rate.

    Attributes:
        time: Since when (s).
        start: The volume at that time (m³).
        target: Where it goes (m³).
    """

    time: float
    start: float
    target: float


class BladderForces(BodyForces):
    """The buoyancy of all bladders less the weight of what fills them, at the origins of their links."""

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        parameters: list[BuoyancyEngineParameters] = [source.setup.parameters for source, _ in sources]
        self.bodies = [body.link(source.setup.parameters.link_name) for source, body in sources]
        self._rates = np.array([item.max_inflation_rate for item in parameters])
        self._densities = np.array([item.fluid_density for item in parameters])
        self._weights = self._densities * np.array([item.neutral_volume for item in parameters])
        self._surfaces = np.array([item.surface for item in parameters])
        self._gravity = sources[0][1].gravity

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the force on each link."""
        since, start, target = signals.reshape(-1, 3).T
        change = self._rates * np.maximum(motion.time - since, 0.0)
        volumes = start + np.clip(target - start, -change, change)
        masses = np.where(motion.origins[:, 2] < self._surfaces, self._densities * volumes, 0.0) - self._weights
        return np.hstack([np.zeros((len(masses), 3)), -masses[:, None] * (self._gravity @ motion.R_WB)])


@controller(BUOYANCY_ENGINE)
class BuoyancyEngine(ForceController, Controller):
    """Fill and drain a bladder, whose buoyancy acts at the origin of a link.

    Behaves as gz-sim's BuoyancyEngine (from its sources), whether or not it is active. The volume changes evenly at any
    time, where Gazebo adds to it in each step.

    .. pydrake_system::

        name: BuoyancyEngine
        input_ports:
        - buoyancy_engine
        output_ports:
        - signals
        - current_volume

    - ``buoyancy_engine``: ``std_msgs/msg/Float64``, the volume to fill it to (m³), as `BladderVolume`.
    - ``signals``: since when the volume changes (s), from which and to which (m³).
    - ``current_volume``: ``std_msgs/msg/Float64`` (m³).
    """

    Parameters: ClassVar[type] = BuoyancyEngineParameters
    Forces: ClassVar[type[BodyForces]] = BladderForces

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._first = BladderVolume(0.0, setup.parameters.default_volume, setup.parameters.first_target)
        self._command = self.declare_topic_input("buoyancy_engine", _FLOAT)
        ticket = self.input_port_ticket(self._command.get_index())
        self.DeclareVectorOutputPort("signals", 3, weakly(self._calc_signals), {ticket})
        self.declare_topic_output("current_volume", _FLOAT, self._calc_volume, {ticket, self.time_ticket()})

    def read(self, topic: str, message: Any, context: Context) -> BladderVolume:
        """Return the volume that a message asks for, within the bladder's bounds, and the one that there is."""
        target, parameters = float(message.data), self.setup.parameters
        if not isfinite(target):
            raise CommandError(f"{topic}: {target:g} is not finite")
        target = min(max(target, parameters.min_volume), parameters.max_volume)
        return BladderVolume(context.get_time(), self._volume(context), target)

    def _bladder(self, context: Context) -> BladderVolume:
        return self.received(self._command, context) or self._first

    def _volume(self, context: Context) -> float:
        bladder = self._bladder(context)
        change = self.setup.parameters.max_inflation_rate * max(context.get_time() - bladder.time, 0.0)
        return float(bladder.start + min(max(bladder.target - bladder.start, -change), change))

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        bladder = self._bladder(context)
        output.SetFromVector([bladder.time, bladder.start, bladder.target])

    def _calc_volume(self, context: Context, output: AbstractValue) -> None:
        set_value(output, messages.message(_FLOAT, {"data": self._volume(context)}))
