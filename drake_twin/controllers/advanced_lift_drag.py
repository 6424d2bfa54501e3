"""The forces of the air on an aircraft by its stability derivatives, as gz-sim's AdvancedLiftDrag computes them."""

from collections.abc import Sequence
from dataclasses import field
from math import pi, sqrt
from typing import ClassVar

import numpy as np

from drake_twin.controllers.body_forces import BodyForces, ForceController, Motion, RobotBody
from drake_twin.controllers.registry import controller
from drake_twin.controllers.wing import Flow, Wing, check_vectors
from drake_twin.dataclass import dataclass
from drake_twin.description.gazebo_drive import ADVANCED_LIFT_DRAG
from drake_twin.description.parameters import ParameterError

_BLEND = 15.0  # 1/rad: how fast the flow separates about the stall
_PLATE = (-0.224, -0.115)  # of a flat plate's drag by its aspect ratio
_STILL = 1e-9  # m/s
_ABOVE_ZERO = {"above": 0.0}

# Lift, drag, side force; moments about forward, right and down.
_KINDS = ("CL", "CD", "CY", "Cell", "Cem", "Cen")
_OF_SURFACES = ("directions", *(f"{kind}_ctrl" for kind in _KINDS))


@dataclass(frozen=True, kw_only=True)
class AdvancedLiftDragParameters:
    """Parameters of ``gz_sim/AdvancedLiftDrag``, named after the elements of ``gz-sim-advanced-lift-drag-system``.

    Attributes:
        link_name: The link on which the air acts.
        CL0: The lift's coefficient at an angle of attack of zero.
        CD0: That of the drag.
        CLa: The slope of the lift's coefficient by the angle of attack, before stall (1/rad).
        CYa: That of the side force.
        Cella: That of the roll moment.
        Cena: That of the yaw moment.
        CLb: The slope of the lift's coefficient by the angle of sideslip (1/rad).
        CYb: That of the side force.
        Cellb: That of the roll moment.
        Cemb: That of the pitch moment.
        Cenb: That of the yaw moment.
        CDp: The slope of the drag's coefficient by the roll rate · span / 2 / speed.
        CYp: That of the side force.
        CLp: That of the lift.
        Cellp: That of the roll moment.
        Cemp: That of the pitch moment.
        Cenp: That of the yaw moment.
        CDq: The slope of the drag's coefficient by the pitch rate · chord / 2 / speed.
        CYq: That of the side force.
        CLq: That of the lift.
        Cellq: That of the roll moment.
        Cemq: That of the pitch moment.
        Cenq: That of the yaw moment.
        CDr: The slope of the drag's coefficient by the yaw rate · span / 2 / speed.
        CYr: That of the side force.
        CLr: That of the lift.
        Cellr: That of the roll moment.
        Cemr: That of the pitch moment.
        Cenr: That of the yaw moment.
        alpha_stall: The angle of attack at which it stalls (rad).
        cp: The point where the forces act, in the link's frame (m).
        area: The area (m²).
        AR: The aspect ratio: the span is √(area · AR).
        mac: The mean chord (m); 0 for the area ÷ the span.
        eff: Oswald's efficiency of the wing.
        air_density: The density of the air (kg/m³).
        forward: The direction of flight, in the link's frame.
        upward: The direction of lift, in the link's frame.
        joints: The joints of the control surfaces.
        directions: The factor on the position of each.
        CL_ctrl: The lift's coefficient for a position of each (1/°).
        CD_ctrl: That of the drag.
        CY_ctrl: That of the side force.
        Cell_ctrl: That of the roll moment.
        Cem_ctrl: That of the pitch moment.
        Cen_ctrl: That of the yaw moment.
    """

    link_name: str
    CL0: float = 0.0
    CD0: float = 0.0
    CLa: float = 0.0
    CYa: float = 0.0
    Cella: float = 0.0
    Cena: float = 0.0
    CLb: float = 0.0
    CYb: float = 0.0
    Cellb: float = 0.0
    Cemb: float = 0.0
    Cenb: float = 0.0
    CDp: float = 0.0
    CYp: float = 0.0
    CLp: float = 0.0
    Cellp: float = 0.0
    Cemp: float = 0.0
    Cenp: float = 0.0
    CDq: float = 0.0
    CYq: float = 0.0
    CLq: float = 0.0
    Cellq: float = 0.0
    Cemq: float = 0.0
    Cenq: float = 0.0
    CDr: float = 0.0
    CYr: float = 0.0
    CLr: float = 0.0
    Cellr: float = 0.0
    Cemr: float = 0.0
    Cenr: float = 0.0
    alpha_stall: float = field(default=pi / 2, metadata={"lower": 0.0})
    cp: tuple[float, ...] = (0.0, 0.0, 0.0)
    area: float = field(default=1.0, metadata=_ABOVE_ZERO)
    AR: float = field(metadata=_ABOVE_ZERO)
    mac: float = field(default=0.0, metadata={"lower": 0.0})
    eff: float = field(metadata=_ABOVE_ZERO)
    air_density: float = field(default=1.2041, metadata={"lower": 0.0})
    forward: tuple[float, ...] = (1.0, 0.0, 0.0)
    upward: tuple[float, ...] = (0.0, 0.0, 1.0)
    joints: tuple[str, ...] = ()
    directions: tuple[float, ...] = ()
    CL_ctrl: tuple[float, ...] = ()
    CD_ctrl: tuple[float, ...] = ()
    CY_ctrl: tuple[float, ...] = ()
    Cell_ctrl: tuple[float, ...] = ()
    Cem_ctrl: tuple[float, ...] = ()
    Cen_ctrl: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        check_vectors(self, "cp", "forward", "upward")
        for name in ("forward", "upward"):
            if not any(getattr(self, name)):
                raise ParameterError(f"{name} is zero", name)
        for name in _OF_SURFACES:
            if len(getattr(self, name)) != len(self.joints):
                raise ParameterError(
                    f"{name} has {len(getattr(self, name))} numbers for {len(self.joints)} joints", name
                )

    @property
    def span(self) -> float:
        """The span (m)."""
        return sqrt(self.area * self.AR)

    @property
    def chord(self) -> float:
        """The mean chord (m)."""
        return self.mac if self.mac > _STILL else self.area / self.span


class AircraftForces(BodyForces):
    """The forces and moments on all aircraft.

    Each force is a coefficient times the area and the pressure of the flow in the plane of ``forward`` and ``upward``;
    each moment has the span or the chord as well. Lift and drag are across that flow and along it, moments about the
    link's axes. Vectors are in links' frames, shape (3, n).
    """

    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        crafts: list[tuple[AdvancedLiftDragParameters, RobotBody]] = [(item.setup.parameters, b) for item, b in sources]
        self.bodies = [body.link(craft.link_name) for craft, body in crafts]

        def column(*names: str) -> np.ndarray:
            return np.array([[getattr(craft, name, 0.0) for craft, _ in crafts] for name in names])

        self._flow = Flow(np.array([np.eye(3)] * len(crafts)), column("cp")[0])
        units = np.stack([column("forward")[0].T, -column("upward")[0].T])
        self._forward, self._down = units / np.linalg.norm(units, axis=1, keepdims=True)
        self._right = _cross(self._down, self._forward)
        # gz-sim reads Cem0, Cema and Cema_stall, and writes over what it makes of them.
        self._at_zero = column("CL0", "CD0", "", "", "", "")
        self._by_attack = column("CLa", "", "CYa", "Cella", "", "Cena")
        self._by_sideslip = column("CLb", "", "CYb", "Cellb", "Cemb", "Cenb")
        span, chord = (np.array([getattr(craft, name) for craft, _ in crafts]) for name in ("span", "chord"))
        lengths = {"p": span / 2, "q": -chord / 2, "r": -span / 2}  # rates about forward, left and up
        self._by_rate = np.stack([column(*(kind + rate for kind in _KINDS)) * lengths[rate] for rate in lengths])
        self._half_density, (self._stall,) = 0.5 * column("air_density")[0], column("alpha_stall")
        ratio = column("AR")[0]
        self._plate = 2.0 / (1.0 + np.exp(_PLATE[0] + _PLATE[1] * np.maximum(ratio, 1.0 / ratio)))
        self._induced = 1.0 / (pi * ratio * column("eff")[0])
        area = column("area")[0]
        self._sizes = area * np.stack([-np.ones_like(area), -np.ones_like(area), np.ones_like(area), span, chord, span])
        surfaces = [
            (number, body.joint(joint).position_start(), coefficients)
            for number, (craft, body) in enumerate(crafts)
            for joint, *coefficients in zip(craft.joints, *(getattr(craft, n) for n in _OF_SURFACES), strict=True)
        ]
        self._joints = np.array([place for _, place, _ in surfaces], dtype=int)
        self._by_joint = np.zeros((6, len(crafts), len(surfaces)))
        for index, (number, _, (direction, *coefficients)) in enumerate(surfaces):
            self._by_joint[:, number, index] = np.degrees(direction * np.array(coefficients))

    @np.errstate(over="ignore", invalid="ignore")  # of what flies apart, which the twin reports
    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench of the air on each link."""
        velocity = self._flow.velocities(motion)
        aside = _dot(velocity, self._right)
        in_plane = velocity - aside * self._right
        speed = np.sqrt(_dot(in_plane, in_plane))
        along = in_plane / np.maximum(speed, _STILL)
        across = _cross(along, self._right)  # downwards
        attack = np.arctan2(_dot(along, self._down), _dot(along, self._forward))
        sideslip = np.arctan2(aside, _dot(velocity, self._forward))
        coefficients = self._coefficients(attack, sideslip, motion.state)
        by_rate = (self._by_rate * motion.V_B[:, :3].T[:, None, :]).sum(axis=0)
        lift, drag, side, roll, pitch, yaw = (
            self._sizes * self._half_density * signals * speed * (coefficients * speed + by_rate)
        )
        force = lift * across + drag * along + side * self._right
        moment = roll * self._forward + pitch * self._right + yaw * self._down
        return self._flow.wrenches(np.concatenate([force, moment]))

    def _coefficients(self, attack: np.ndarray, sideslip: np.ndarray, state: np.ndarray) -> np.ndarray:
        """Return the coefficients without those of rates (6×n)."""
        controls = self._by_joint @ state[self._joints]
        found = self._at_zero + self._by_attack * attack
        # How much of the flow has left the wing: two sigmoids, one for each side.
        up, down = np.exp(_BLEND * (attack - self._stall)), np.exp(-_BLEND * (attack + self._stall))
        stalled = 1.0 - 1.0 / ((1.0 + up) * (1.0 + down))
        sine = np.sin(attack)
        plate = 2.0 * np.sign(attack) * sine * sine * np.cos(attack)
        found[0] = (1.0 - stalled) * found[0] + stalled * plate
        found += self._by_sideslip * sideslip
        found[0] += controls[0]
        controls[0] = 0.0
        of_plate = self._plate * sine * sine  # sin² α = (1 - cos 2α) / 2
        found[1] = (1.0 - stalled) * (found[1] + self._induced * found[0] * found[0]) + stalled * of_plate
        coefficients: np.ndarray = found + controls
        return coefficients


def _dot(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    products: np.ndarray = (a * b).sum(axis=0)
    return products


def _cross(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    return np.stack([a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]])


@controller(ADVANCED_LIFT_DRAG)
class AdvancedLiftDrag(Wing):
    """Let the air act on a link as on an aircraft whose stability derivatives are known.

    Behaves as gz-sim's AdvancedLiftDrag (from its source), in the world's wind. As there, the pitch moment follows from
    sideslip, rates and control surfaces alone, and rates are about the link's axes. At an angle of attack of exactly
    zero, where gz-sim has no force, the twin has that of the angles beside it.

    .. pydrake_system::

        name: AdvancedLiftDrag
        output_ports:
        - signals

    - ``signals``: 1 while it is active, else 0.
    """

    Parameters: ClassVar[type] = AdvancedLiftDragParameters
    Forces: ClassVar[type[BodyForces]] = AircraftForces
