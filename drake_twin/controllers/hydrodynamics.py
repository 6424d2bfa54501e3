"""The forces of water on a moving link, as gz-sim's Hydrodynamics has them: damping, added mass and a current."""

from collections.abc import Mapping, Sequence
from dataclasses import field
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import BasicVector, Context

from drake_twin.control.cross_product import cross
from drake_twin.control.fossen import Damping, coefficients_of, coriolis
from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.fluid_response import FluidResponse
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import HYDRODYNAMICS
from drake_twin.description.parameters import ParameterError
from drake_twin.description.sname import coefficient_name
from drake_twin.errors import CommandError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly


@dataclass(frozen=True, kw_only=True)
class HydrodynamicsParameters:
    """Parameters of ``gz_sim/Hydrodynamics``, named after the elements of ``gz-sim-hydrodynamics-system``.

    Attributes:
        link_name: The link in the water.
        coefficients: Name → coefficient, in SI units, with the names and signs of gz-sim: ``xU`` (linear damping,
            negative), ``xUabsU`` and ``xUU`` (quadratic), ``xDotU`` (added mass, negative), for x, y, z, k, m, n and
            U, V, W, P, Q, R in any combination.
        default_current: The velocity of the water in the world until a message says another one (m/s).
        disable_added_mass: Whether added mass resists no acceleration.
        disable_coriolis: Whether added mass has no Coriolis and centripetal forces.
        fluid_added_mass: More added mass about the link's origin, in its axes, angular first (6×6, row by row): SDF's
            ``<fluid_added_mass>``: it always acts in full.
    """

    link_name: str
    coefficients: Mapping[str, float] = field(default_factory=dict)
    default_current: tuple[float, ...] = (0.0, 0.0, 0.0)
    disable_added_mass: bool = False
    disable_coriolis: bool = False
    fluid_added_mass: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for name, value in self.coefficients.items():
            if coefficient_name(name) is None:
                what = f"{name!r} is not a coefficient, as xU, xUabsU, xUV or xDotU are"
                raise ParameterError(what, "coefficients", name)
            if not isfinite(value):
                raise ParameterError(f"{name} is {value:g}, which is not finite", "coefficients", name)
        if len(self.default_current) != 3:
            raise ParameterError("default_current has to have 3 numbers", "default_current")
        if len(self.fluid_added_mass) not in (0, 36):
            raise ParameterError("fluid_added_mass has to have 36 numbers", "fluid_added_mass")


@saved("OceanCurrent")
@dataclass(frozen=True)
class OceanCurrent(Frozen):
    """The velocity of the water in the world (m/s)."""

    velocity: tuple[float, float, float]


class HydrodynamicForces(BodyForces):
    """Damping, added mass and Coriolis forces of all links in water: what `FluidResponse` makes of Fossen's terms."""

    is_last = True

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        parameters = [source.setup.parameters for source, _ in sources]
        coefficients = [coefficients_of(item.coefficients) for item in parameters]
        added = np.array([item.added_mass for item in coefficients])
        self._damping = Damping(coefficients)
        self._added = added * np.array([not item.disable_added_mass for item in parameters])[:, None, None]
        self._whirled = added * np.array([not item.disable_coriolis for item in parameters])[:, None, None]
        more = np.array([item.fluid_added_mass or np.zeros(36) for item in parameters]).reshape(-1, 6, 6)
        self._added, self._whirled = self._added + more, self._whirled + more
        self._response = FluidResponse.of(sources, self._added)
        self.bodies = self._response.bodies

    def follow(self, plant_context: Context) -> None:
        """Respond as links of other masses do."""
        self._response.follow(plant_context)

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench of the water on each link; none on what it carries."""
        count = len(self._added)
        current = np.einsum("nij,ni->nj", motion.R_WB[:count], signals.reshape(-1, 3))
        velocity = motion.V_B[:count].copy()
        velocity[:, 3:] -= current
        water, slope = self._damping.calc(velocity)
        water -= coriolis(self._whirled, velocity)
        if signals.any():  # a current that is constant in the world turns in the link's axes
            water -= (self._added[:, :, 3:] @ cross(motion.V_B[:count, :3], current)[:, :, None])[..., 0]
        return self._response.wrenches(motion, water, self._response.losses(slope))


@controller(HYDRODYNAMICS)
class Hydrodynamics(ForceController, Controller):
    """Exert the forces of water on a link: damping, added mass and its Coriolis forces, in a current.

    Behaves as gz-sim's Hydrodynamics (from its sources), whether or not it is active, with two differences. Forces that
    follow from the motion are computed for the whole step, so that they are stable however large they are. The Coriolis
    forces of added mass keep the momentum that the water has with the body, and have all of the matrix, where Gazebo
    applies those of its diagonal with the opposite sign.

    .. pydrake_system::

        name: Hydrodynamics
        input_ports:
        - ocean_current
        output_ports:
        - signals

    - ``ocean_current``: ``geometry_msgs/msg/Vector3``, as `OceanCurrent`.
    - ``signals``: the velocity of the water in the world (m/s).
    """

    Parameters: ClassVar[type] = HydrodynamicsParameters
    Forces: ClassVar[type[BodyForces]] = HydrodynamicForces

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self._current = self.declare_topic_input("ocean_current", "geometry_msgs/msg/Vector3")
        tickets = {self.input_port_ticket(self._current.get_index())}
        self.DeclareVectorOutputPort("signals", 3, weakly(self._calc_signals), tickets)

    def read(self, topic: str, message: Any, context: Context) -> OceanCurrent:
        """Return the velocity in a message."""
        velocity = (float(message.x), float(message.y), float(message.z))
        if not np.isfinite(velocity).all():
            raise CommandError(f"{topic}: the velocity is not finite")
        return OceanCurrent(velocity)

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        current = self.received(self._current, context)
        output.SetFromVector(self.setup.parameters.default_current if current is None else current.velocity)
