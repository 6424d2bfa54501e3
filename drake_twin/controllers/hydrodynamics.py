"""The forces of water on a moving link, as gz-sim's Hydrodynamics has them: damping, added mass and a current."""

from collections.abc import Mapping, Sequence
from dataclasses import field
from math import isfinite
from typing import Any, ClassVar

import numpy as np
from pydrake.systems.framework import BasicVector, Context

from drake_twin.control.cross_product import cross
from drake_twin.control.fossen import Damping, coefficients_of, coriolis
from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.link_response import LinkResponse
from drake_twin.controllers.registry import controller
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import HYDRODYNAMICS
from drake_twin.description.parameters import ParameterError
from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.sname import coefficient_name
from drake_twin.errors import CommandError, InputError
from drake_twin.frozen import Frozen
from drake_twin.saved import saved
from drake_twin.systems.weak_callback import weakly

_LEAST = 1e-6  # of the mass of a link, what added mass has to leave of it


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
    """

    link_name: str
    coefficients: Mapping[str, float] = field(default_factory=dict)
    default_current: tuple[float, ...] = (0.0, 0.0, 0.0)
    disable_added_mass: bool = False
    disable_coriolis: bool = False

    def __post_init__(self) -> None:
        for name, value in self.coefficients.items():
            if coefficient_name(name) is None:
                what = f"{name!r} is no coefficient, as xU, xUabsU, xUV or xDotU are"
                raise ParameterError(what, "coefficients", name)
            if not isfinite(value):
                raise ParameterError(f"{name} is {value:g}, which is not finite", "coefficients", name)
        if len(self.default_current) != 3:
            raise ParameterError("default_current has to have 3 numbers", "default_current")


@saved("OceanCurrent")
@dataclass(frozen=True)
class OceanCurrent(Frozen):
    """The velocity of the water in the world (m/s)."""

    velocity: tuple[float, float, float]


class HydrodynamicForces(BodyForces):
    """Damping and added mass of all links in water.

    With ν the link's velocity in its own axes, ν_r that relative to the water, Fossen's equations are

        M ν' + C(ν) ν = F - D(ν_r) ν_r - M_A ν_r' - C_A(ν_r) ν_r.

    As F - C ν the sum of all other known forces is taken, and W in place of M⁻¹ (`LinkResponse`). Then

        ν' = (1 + W M_A)⁻¹ (ν'₀ + W F_w),  F_w = -D ν_r - C_A ν_r,

    without an algebraic loop: nothing here depends on what the plant's solver finds. For a free body it is exact, with
    M_A of any size, where a force of minus M_A times the last step's acceleration, as in Gazebo, diverges where M_A
    exceeds M. Contacts and motors act on the link as if it had no added mass.

    Over a step h, damping is that of the exponential Euler method: the step's mean acceleration is φ(-h K) ν', with K
    what ν' loses with ν. With (1 + X + X²/2)⁻¹ in place of exp(-X) (Padé's, second order, L-stable) that is

        (1 + X + X²/2)⁻¹ (1 + X/2) ν',  X = h K.

    So terminal velocities do not depend on the step, a decay is right to second order, and damping of any size stops a
    link within a step, but never turns it round. The wrench is then F_w - M_A ν' and what the mean lacks of it, from
    which no inverse of W is needed: a link that cannot move has a W that is singular.
    """

    is_last = True

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        """Prepare the responses.

        Raises:
            InputError: If an added mass takes all the mass of a link.
        """
        self._links = [body.link(source.setup.parameters.link_name) for source, body in sources]
        self._plant = sources[0][1].plant
        parameters = [source.setup.parameters for source, _ in sources]
        coefficients = [coefficients_of(item.coefficients) for item in parameters]
        added = np.array([item.added_mass for item in coefficients])
        self._damping = Damping(coefficients)
        self._added = added * np.array([not item.disable_added_mass for item in parameters])[:, None, None]
        self._whirled = added * np.array([not item.disable_coriolis for item in parameters])[:, None, None]
        self._step = self._plant.time_step()
        self._respond(None)
        for (members, *_), response in zip(self._groups, self._response.responses, strict=True):
            effective = np.eye(response.shape[-1]) + response @ _blocks(self._added, members)
            for every in members[np.linalg.eigvals(effective).real.min(axis=1) < _LEAST]:
                raise _negative(*sources[every[0]])
        self.bodies = [*self._links, *self._response.carried]

    def follow(self, plant_context: Context) -> None:
        """Respond as links of other masses do."""
        self._respond(plant_context)

    def _respond(self, masses: Context | None) -> None:
        self._response = LinkResponse(self._plant, self._links, masses)
        self._groups = []
        for members, response in zip(self._response.groups, self._response.responses, strict=True):
            count = members.shape[1]
            mass = _blocks(self._added, members)
            unit = np.eye(6 * count)
            after = np.linalg.inv(unit + response @ mass)
            before = np.linalg.inv(unit + mass @ response)
            self._groups.append((members, unit, after, after @ response, before))

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
        free = self._response.free_acceleration(motion)
        found = np.zeros_like(motion.V_B)
        for members, unit, after, mobility, before in self._groups:
            own = water[members].reshape(len(members), -1, 1)
            mean = after @ free[members].reshape(len(members), -1, 1) + mobility @ own
            found[members] -= (self._added[members] @ mean.reshape(*members.shape, 6, 1))[..., 0]
            if self._step > 0.0:
                slopes = self._step * _blocks(slope, members)
                X = mobility @ slopes
                half = unit + X / 2
                stepped = np.linalg.solve(unit + X @ half, half @ mean)
                lost = before @ (slopes @ (half @ stepped - mean / 2))
                found[members] -= lost.reshape(*members.shape, 6)
        found[:count] += water
        return found


def _negative(source: ForceController, body: RobotBody) -> InputError:
    link, name = source.setup.parameters.link_name, source.setup.name
    negative = "xDotU and its like are negative in SNAME's notation"
    what = f"the added mass of link {link!r} is negative and takes all of its mass: {negative}"
    return InputError(f"robot {body.plant.GetModelInstanceName(body.instance)!r}: controller {name}: {what}")


def _blocks(matrices: np.ndarray, members: np.ndarray) -> np.ndarray:
    """Return matrices (n×6×6) of the members of groups (g×k) as block diagonals (g×6k×6k)."""
    count = members.shape[1]
    found = np.zeros((len(members), 6 * count, 6 * count))
    for place in range(count):
        part = slice(6 * place, 6 * place + 6)
        found[:, part, part] = matrices[members[:, place]]
    return found


@controller(HYDRODYNAMICS)
class Hydrodynamics(ForceController):
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

    @classmethod
    def problem(cls, parameters: HydrodynamicsParameters, description: RobotDescription) -> str | None:
        """Return why the water cannot act on the robot; None if it can."""
        if parameters.link_name in description.links:
            return None
        return f"the robot has no link {parameters.link_name!r}"

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
