"""The forces of air on the hull of an airship, as gz-sim's LighterThanAirDynamics has them."""

from collections.abc import Sequence
from typing import ClassVar

import numpy as np
from pydrake.systems.framework import BasicVector, Context

from drake_twin.control.airship_hull import AirshipHulls, HullCoefficients
from drake_twin.control.cross_product import cross
from drake_twin.control.fossen import coriolis
from drake_twin.controllers.base_controller import Controller, ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.fluid_response import FluidResponse
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import LIGHTER_THAN_AIR
from drake_twin.description.parameters import ParameterError
from drake_twin.systems.weak_callback import weakly


@dataclass(frozen=True, kw_only=True)
class LighterThanAirDynamicsParameters:
    """Parameters of ``gz_sim/LighterThanAirDynamics``, named after the elements of gz-sim's system of that name.

    Attributes:
        link_name: The hull, which points along x.
        fluid_added_mass: Its added mass about the link's origin in the link's axes, angular first: a 6×6 matrix, row by
            row (kg·m², kg·m, kg).
        air_density: In kg/m³.
        force_inviscid_coeff: Of the force across the hull in potential flow (m²).
        force_viscous_coeff: Of that in viscous flow (m²).
        moment_inviscid_coeff: Of the moment in potential flow (m³).
        moment_viscous_coeff: Of that in viscous flow (m³).
        eps_v: How far behind the link's origin the flow stops to be potential (m).
        axial_drag_coeff: Of the drag along the hull (m²).
    """

    link_name: str
    fluid_added_mass: tuple[float, ...]
    air_density: float = 1.225
    force_inviscid_coeff: float
    force_viscous_coeff: float
    moment_inviscid_coeff: float
    moment_viscous_coeff: float
    eps_v: float
    axial_drag_coeff: float

    def __post_init__(self) -> None:
        if len(self.fluid_added_mass) != 36:
            raise ParameterError("fluid_added_mass has to have 36 numbers", "fluid_added_mass")


class HullForces(BodyForces):
    """Potential and viscous flow about all hulls, axial drag, and added mass, as `FluidResponse` makes wrenches of it.

    Of the Coriolis forces of added mass, Munk's moment is left out: the potential flow's moment is that.
    """

    is_last = True

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        parameters: list[LighterThanAirDynamicsParameters] = [source.setup.parameters for source, _ in sources]
        self._hulls = AirshipHulls(
            [
                HullCoefficients(
                    item.air_density,
                    item.force_inviscid_coeff,
                    item.force_viscous_coeff,
                    item.moment_inviscid_coeff,
                    item.moment_viscous_coeff,
                    item.eps_v,
                    item.axial_drag_coeff,
                )
                for item in parameters
            ]
        )
        self._added = np.array([item.fluid_added_mass for item in parameters]).reshape(-1, 6, 6)
        self._response = FluidResponse.of(sources, self._added)
        self.bodies = self._response.bodies

    def follow(self, plant_context: Context) -> None:
        """Respond as links of other masses do."""
        self._response.follow(plant_context)

    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench of the air on each hull; none on what it carries."""
        del signals
        velocity = motion.V_B[: len(self._added)]
        air, slope = self._hulls.calc(velocity)
        air -= coriolis(self._added, velocity)
        linear = velocity[:, 3:]
        air[:, :3] += cross(linear, (self._added[:, 3:, 3:] @ linear[:, :, None])[..., 0])
        return self._response.wrenches(motion, air, self._response.losses(slope))


@controller(LIGHTER_THAN_AIR)
class LighterThanAirDynamics(ForceController, Controller):
    """Exert the forces of air on the hull of an airship.

    Behaves as gz-sim's LighterThanAirDynamics (from its sources), whether or not it is active, with three differences.
    Its forces and the added mass are stable at any step. The Coriolis forces of added mass act once, where Gazebo's
    engine adds its own. Drag along the hull brakes it backwards, too.

    .. pydrake_system::

        name: LighterThanAirDynamics
        output_ports:
        - signals

    - ``signals``: nothing.
    """

    Parameters: ClassVar[type] = LighterThanAirDynamicsParameters
    Forces: ClassVar[type[BodyForces]] = HullForces

    def __init__(self, setup: ControllerSetup):
        super().__init__(setup)
        self.DeclareVectorOutputPort("signals", 0, weakly(self._calc_signals), {self.nothing_ticket()})

    def _calc_signals(self, context: Context, output: BasicVector) -> None:
        """Nothing beside the motion matters."""
