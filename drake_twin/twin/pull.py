"""A spring that draws a point of a link to a point of the world, as a person does with the mouse.

Its force is computed on a grid of simulated times and constant in between: it is part of the state, and a recorded run
repeats it to the last bit.
"""

from collections.abc import Iterable
from dataclasses import replace

import numpy as np
from pydrake.multibody.tree import JacobianWrtVariable, RigidBody
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.errors import InputError
from drake_twin.saved import saved
from drake_twin.twin.entity_state import find_body, finite_numbers
from drake_twin.values import is_number

PERIOD = 0.005  # s of simulation time between two renewals of the force
_FREQUENCY = 10.0  # rad/s: of the spring and the whole mass
_MOST_DAMPING = 0.5  # of the lightest mass that the point may move, in one period: twice that would be unstable
_FIXED = 1e-9  # 1/kg: a point that moves less under a force is fixed


@saved("Pull")
@dataclass(frozen=True)
class Pull:
    """A damped spring between a link and the world.

    Attributes:
        entity: The name of the link, robot or model.
        at: The point of the link, in the link's frame (m).
        target: The point in the world (m).
        stiffness: N/m.
        damping: N·s/m.
        until: The simulation time at which it ends (s).
        force: The present force, in the world's axes (N).
    """

    entity: str
    at: tuple[float, float, float]
    target: tuple[float, float, float]
    stiffness: float
    damping: float
    until: float
    force: tuple[float, float, float] = (0.0, 0.0, 0.0)

    @property
    def torque(self) -> tuple[float, float, float]:
        """None: the spring is tied to a point."""
        return (0.0, 0.0, 0.0)


def make_pull(
    built: TwinDiagram,
    plant_context: Context,
    entity: str,
    target: Iterable[float],
    at: Iterable[float],
    until: float,
    stiffness: float | None,
    period: float,
    known: Pull | None,
) -> Pull:
    """Return a spring with its present force; see `Entities.drag`.

    Args:
        period: The time between two renewals of its force (s).
        known: The entity's spring until now: at the same point, its stiffness is kept.
    """
    body = find_body(built, entity)
    x, y, z = map(float, finite_numbers(target, 3, "target"))
    point = finite_numbers(at, 3, "point")
    px, py, pz = map(float, point)
    if stiffness is not None and (not is_number(stiffness) or stiffness <= 0):
        raise InputError(f"invalid stiffness {stiffness!r} N/m: it must be above zero")
    if known is not None and stiffness is None and known.at == (px, py, pz):
        return with_force(built, plant_context, replace(known, target=(x, y, z), until=until))
    mass, lightest = _masses(built, plant_context, body, point)
    if lightest is None:
        raise InputError(f"Entity [{entity}] cannot be dragged: it is fixed to the world")
    most = _MOST_DAMPING * lightest / period
    damping = min(2.0 * _FREQUENCY * mass, most)
    softest = min(_FREQUENCY**2 * mass, damping**2 / (4.0 * lightest))
    if stiffness is not None:
        softest = float(stiffness)
        damping = min(2.0 * (softest * mass) ** 0.5, most)
    pull = Pull(str(entity), (px, py, pz), (x, y, z), softest, damping, until)
    return with_force(built, plant_context, pull)


def with_force(built: TwinDiagram, plant_context: Context, pull: Pull) -> Pull:
    """Return a spring with the force that it has in the present state."""
    body = find_body(built, pull.entity)
    X_WB = body.EvalPoseInWorld(plant_context)
    V_WB = body.EvalSpatialVelocityInWorld(plant_context)
    p_BP_W = X_WB.rotation() @ np.array(pull.at)
    position = X_WB.translation() + p_BP_W
    velocity = V_WB.translational() + np.cross(V_WB.rotational(), p_BP_W)
    x, y, z = pull.stiffness * (np.array(pull.target) - position) - pull.damping * velocity
    return replace(pull, force=(float(x), float(y), float(z)))


def _masses(
    built: TwinDiagram, plant_context: Context, body: RigidBody, point: np.ndarray
) -> tuple[float, float | None]:
    """Return the mass of a body's whole robot or model, and the least that a point of it has in any direction (kg).

    The latter is the inverse of the largest eigenvalue of J M⁻¹ Jᵀ; None if the point cannot move.
    """
    plant = built.plant
    owners = built.owners()
    own = [instance for instance, name in owners.items() if name == owners[body.model_instance()]]
    world = plant.world_frame()
    J = plant.CalcJacobianTranslationalVelocity(
        plant_context, JacobianWrtVariable.kV, body.body_frame(), point, world, world
    )
    moving = np.flatnonzero(np.abs(J).max(axis=0) > 0)
    if not len(moving):
        return 0.0, None
    M = plant.CalcMassMatrix(plant_context)[np.ix_(moving, moving)]
    mobility = float(np.linalg.eigvalsh(J[:, moving] @ np.linalg.pinv(M) @ J[:, moving].T).max())
    if mobility < _FIXED:
        return 0.0, None
    return float(plant.CalcTotalMass(plant_context, own)), 1.0 / mobility
