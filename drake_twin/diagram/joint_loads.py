"""What a joint has to move and to bear over its range, which its servo's gains follow from."""

from collections.abc import Sequence
from math import fsum, inf, pi, sqrt

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JointActuator, ModelInstanceIndex
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.systems.plant_reading import physics_step

# Drake's solver compares forces with these tolerances, and takes the next position of a servo from the present one: the
# rounding of that, times the stiffness, must be less, where nothing else pulls at the robot.
_ABSOLUTE_TOLERANCE, _RELATIVE_TOLERANCE = 1e-14, 1e-6
_LEAST_OF_SAMPLES = 0.1  # of the gravity loads of sampled configurations
_FARTHEST = 4 * pi  # position of a joint without limits (rad)

_SAMPLES = 16
_LEAST_INERTIA = 1e-9  # keeps gains positive: Drake ends the process if both are zero


@dataclass(frozen=True)
class JointLoad:
    """The load of a joint.

    Attributes:
        inertia: The joint's largest inertia (kg·m² or kg).
        gravity: The largest gravity load, the joint's dry friction, and the drag of a base (N·m or N).
        contact: Its share of the robot's weight, if it may have to bear it (N·m or N).
        damping: The joint's viscous damping (N·m·s/rad or N·s/m).
        stiffest: The largest stiffness of a position servo in this robot (N·m/rad or N/m).
    """

    inertia: float
    gravity: float
    contact: float
    damping: float = 0.0
    stiffest: float = inf


def joint_loads(
    plant: MultibodyPlant,
    robots: Sequence[tuple[RobotPlan, ModelInstanceIndex, StateLayout]],
    actuators: Sequence[tuple[RobotPlan, JointActuator]],
    start: Context,
) -> list[JointLoad]:
    """Return the largest inertia and gravity load of each actuated joint over sampled configurations."""
    if not actuators:
        return []
    context = plant.CreateDefaultContext()
    context.SetTimeStateAndParametersFrom(start)
    velocities = [actuator.joint().velocity_start() for _, actuator in actuators]
    inertia, least_inertia = np.full(len(actuators), _LEAST_INERTIA), np.full(len(actuators), inf)
    gravity = np.zeros(len(actuators))
    own = {plan.name: _velocities_of(plant, instance) for plan, instance, _ in robots}
    pulls = dict.fromkeys(own, inf)
    samplers = [np.random.default_rng(0) for _ in robots]  # one per robot: its samples do not depend on other robots
    for sample in range(_SAMPLES):
        for sampler, (plan, instance, layout) in zip(samplers, robots, strict=True):
            if sample > 0:  # the first sample is the start configuration
                q = plant.GetPositions(context, instance)
                _sample_joints(q, plan, layout, sampler)
                plant.SetPositions(context, instance, q)
        masses = np.diag(plant.CalcMassMatrix(context))
        loads = np.abs(plant.CalcGravityGeneralizedForces(context))
        inertia, least_inertia = np.maximum(inertia, masses[velocities]), np.minimum(least_inertia, masses[velocities])
        gravity = np.maximum(gravity, loads[velocities])
        for name, mine in own.items():
            pulls[name] = min(pulls[name], float(np.linalg.norm(loads[mine] / np.sqrt(masses[mine]))))
    g = float(np.linalg.norm(plant.gravity_field().gravity_vector()))
    weights = {plan.name: g * plant.CalcTotalMass(start, [instance]) for plan, instance, _ in robots}
    return [
        JointLoad(
            inertia=float(m),
            gravity=float(load) + _friction(plan, actuator) + _drag(plan, actuator),
            contact=_contact_load(plant, start, plan, actuator, float(m), weights[plan.name]),
            damping=float(actuator.joint().GetDampingVector(start)[0]),
            stiffest=_stiffest(physics_step(plant), actuator, float(least), pulls[plan.name]),
        )
        for (plan, actuator), m, least, load in zip(actuators, inertia, least_inertia, gravity, strict=True)
    ]


def _velocities_of(plant: MultibodyPlant, instance: ModelInstanceIndex) -> np.ndarray:
    """Return the indices of a robot's velocities."""
    marked = np.zeros(plant.num_velocities())
    plant.SetVelocitiesInArray(instance, np.ones(plant.num_velocities(instance)), marked)
    return np.flatnonzero(marked)


def _stiffest(time_step: float, actuator: JointActuator, inertia: float, pull: float) -> float:
    """Return the largest stiffness with which Drake's solver converges (N·m/rad or N/m).

    Args:
        time_step: The plant's time step (s); 0 for a continuous one, in whose solver that rounding stops nothing.
        actuator: The actuator.
        inertia: The joint's smallest inertia (kg·m² or kg).
        pull: The least of the robot's gravity loads over the square root of their inertias, as the solver scales them.
    """
    if time_step == 0.0:
        return inf
    lower, upper = actuator.joint().position_lower_limits()[0], actuator.joint().position_upper_limits()[0]
    farthest = max(abs(lower), abs(upper)) if np.isfinite((lower, upper)).all() else _FARTHEST
    rounding = 0.5 * np.finfo(float).eps * farthest * time_step / sqrt(max(inertia, _LEAST_INERTIA))
    tolerance = _ABSOLUTE_TOLERANCE + _RELATIVE_TOLERANCE * _LEAST_OF_SAMPLES * time_step * pull
    return float(tolerance / rounding) if rounding > 0.0 else inf


def _friction(plan: RobotPlan, actuator: JointActuator) -> float:
    return fsum(joint.friction for joint in plan.friction_joints if joint.name == actuator.joint().name())


def _drag(plan: RobotPlan, actuator: JointActuator) -> float:
    """Return the load that sliding wheels may put on a joint that moves the base."""
    is_of_base = any(joint.name == actuator.joint().name() for joint in plan.description.base_joints)
    return float(actuator.effort_limit()) if is_of_base else 0.0


def _contact_load(
    plant: MultibodyPlant, context: Context, plan: RobotPlan, actuator: JointActuator, inertia: float, weight: float
) -> float:
    """Return the load of a joint that bears the robot's weight: at a wheel's radius of gyration, or along a slide."""
    if plan.model.is_fixed:
        return 0.0
    joint = actuator.joint()
    lever = 1.0
    if joint.type_name() == "revolute":
        outboard = plant.GetBodiesKinematicallyAffectedBy([joint.index()])
        mass = fsum(plant.get_body(index).get_mass(context) for index in outboard)
        lever = float(np.sqrt(inertia / mass)) if mass > 0 else 0.0
    return min(weight * lever, float(actuator.effort_limit()))


def _sample_joints(q: np.ndarray, plan: RobotPlan, layout: StateLayout, sampler: np.random.Generator) -> None:
    for joint in plan.description.movable_joints:
        lower = joint.limits.lower if np.isfinite(joint.limits.lower) else -np.pi
        upper = joint.limits.upper if np.isfinite(joint.limits.upper) else np.pi
        q[layout.positions[joint.name]] = sampler.uniform(lower, max(lower, upper))
