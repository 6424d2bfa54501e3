"""Gains of the implicit PD servo that Drake applies at each actuated joint.

They follow from the joint's own inertia and load over its range, so that a robot needs no tuning and one robot's gains
never depend on another's. The command interface that drives a joint decides which gains apply.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import fsum, inf

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JointActuator, ModelInstanceIndex, PdControllerGains
from pydrake.systems.framework import Context

from drake_twin.description.robot_description import RobotDescription
from drake_twin.diagram.joint_friction import CREEP, FRICTION_SUFFIX
from drake_twin.errors import InputError
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.systems.state_layout import StateLayout

# The time constant with which a velocity servo reaches its command against inertia alone (s).
_VELOCITY_TIME_CONSTANT = 0.005
# The velocity error of a servo under the joint's largest gravity load, and under its share of the robot's weight
# (rad/s, m/s).
_VELOCITY_ERROR_UNDER_GRAVITY = 2.5e-4
_VELOCITY_ERROR_UNDER_CONTACT = 1e-2
_RELATIVE_ERROR_UNDER_DAMPING = 5e-4  # relative to the commanded velocity

# A position servo settles in about this time without overshoot (s), and sags by this much under gravity (rad or m).
SETTLING_TIME = 0.2
_SAG_UNDER_GRAVITY = 5e-4
_YIELD_UNDER_CONTACT = 1e-2

# A joint that is stopped brakes as a dry friction of its effort limit would: with the full effort above this velocity.
# Below, where less effort holds it, it is at rest (rad/s or m/s).
REST_VELOCITY = 1e-3

# A commanded effort fades to nothing while the joint passes its velocity limit by this part of the limit.
_OVER_VELOCITY_LIMIT = 0.01

_SAMPLES = 16
_LEAST_INERTIA = 1e-9  # keeps the damping positive: Drake ends the process if both gains are zero


@dataclass(frozen=True)
class JointLoad:
    """The load of a joint.

    Attributes:
        inertia: The joint's largest inertia (kg·m² or kg).
        gravity: The largest gravity load, the joint's dry friction, and the drag of a base (N·m or N).
        contact: Its share of the robot's weight, if it may have to bear it (N·m or N).
        damping: The joint's viscous damping (N·m·s/rad or N·s/m).
    """

    inertia: float
    gravity: float
    contact: float
    damping: float = 0.0


def velocity_gains(load: JointLoad, *, continuous: bool = False) -> PdControllerGains:
    """Return the gains of a joint that follows a velocity.

    Args:
        load: The joint's load.
        continuous: Whether the engine is ``cenic``, which takes a velocity target with the wrong sign: the velocity is
            then given as a far position, with a stiffness that has almost no effect of its own.
    """
    damping = max(
        load.inertia / _VELOCITY_TIME_CONSTANT,
        load.gravity / _VELOCITY_ERROR_UNDER_GRAVITY,
        load.contact / _VELOCITY_ERROR_UNDER_CONTACT,
        load.damping / _RELATIVE_ERROR_UNDER_DAMPING,
    )
    return PdControllerGains(p=damping / VELOCITY_AS_POSITION if continuous else 0.0, d=damping)


def position_gains(load: JointLoad, time_constant: float | None = None) -> PdControllerGains:
    """Return the gains of a joint that moves to a position or holds one.

    With Kd = Kp · T the servo is overdamped whenever Kp ≥ 4 · inertia / T²; 16 leaves room for a varying inertia. The
    joint then moves as gz_ros2_control's does, at a velocity of error / T.

    Args:
        load: The joint's load.
        time_constant: T (s); the default suits most joints.
    """
    T = time_constant or SETTLING_TIME
    stiffness = max(16.0 * load.inertia / T**2, load.gravity / _SAG_UNDER_GRAVITY, load.contact / _YIELD_UNDER_CONTACT)
    return PdControllerGains(p=stiffness, d=stiffness * T)


def brake_gains(load: JointLoad, effort_limit: float) -> PdControllerGains:
    """Return the gains of a joint that comes to rest.

    Args:
        load: The joint's load, which sets the braking of a joint without an effort limit.
        effort_limit: The effort limit (N·m or N).
    """
    if np.isfinite(effort_limit):
        return PdControllerGains(p=0.0, d=max(effort_limit / REST_VELOCITY, _LEAST_INERTIA))
    return PdControllerGains(p=0.0, d=max(velocity_gains(load).d, (load.gravity + load.contact) / REST_VELOCITY))


def effort_gains(effort_limit: float, velocity_limit: float, *, continuous: bool = False) -> PdControllerGains:
    """Return the gains of a joint that follows an effort up to its velocity limit, as in Gazebo's physics.

    The servo follows the limit in the direction of the effort, with no more than the effort.

    Args:
        effort_limit: The effort limit (N·m or N).
        velocity_limit: The velocity limit (rad/s or m/s).
        continuous: As for `velocity_gains`.
    """
    if not (np.isfinite((effort_limit, velocity_limit)).all() and velocity_limit > 0):
        return _NO_GAINS
    damping = max(effort_limit / (_OVER_VELOCITY_LIMIT * velocity_limit), _LEAST_INERTIA)
    return PdControllerGains(p=damping / VELOCITY_AS_POSITION if continuous else 0.0, d=damping)


# In a continuous plant a velocity v is commanded as the position v · this (s).
VELOCITY_AS_POSITION = 1e7

# How a joint is driven: its position is held, one of its command interfaces is written, or nothing holds it. It brakes
# until it can be held, or rests where its position is too large a number to be held exactly. A far position is
# approached at the joint's velocity limit, up or down.
HOLD, POSITION, VELOCITY, EFFORT, FREE = "hold", "position", "velocity", "effort", "free"
BRAKE, REST, UP, DOWN = "brake", "rest", "up", "down"
MODES = (HOLD, POSITION, VELOCITY, EFFORT, FREE, BRAKE, REST, UP, DOWN)

# Drake ends the process if both gains are zero. This damping has no effect.
_NO_GAINS = PdControllerGains(p=0.0, d=1e-9)


@dataclass(frozen=True)
class ServoGains:
    """The gains of one actuator in each mode.

    Attributes:
        position: For a commanded or held position.
        velocity: For a commanded velocity, or a position that is approached at the velocity limit.
        brake: For a joint that comes to rest.
        effort: For a commanded effort.
        effort_limit: The largest effort of the actuator (N·m or N).
    """

    position: PdControllerGains
    velocity: PdControllerGains
    brake: PdControllerGains
    effort: PdControllerGains
    effort_limit: float

    def velocity_as_position(self, mode: str) -> float:
        """Return the lead of a position that replaces a velocity (s): damping over stiffness; 0 without stiffness."""
        gains = self.of(mode)
        return float(gains.d / gains.p) if gains.p > 0 else 0.0

    def of(self, mode: str) -> PdControllerGains:
        """Return the gains of a mode."""
        if mode in (HOLD, POSITION):
            return self.position
        if mode in (VELOCITY, UP, DOWN):
            return self.velocity
        if mode in (BRAKE, REST):
            return self.brake
        return self.effort if mode == EFFORT else _NO_GAINS


def velocity_limit(description: RobotDescription, joint: str | None) -> float:
    """Return the velocity limit of an actuator's joint (rad/s or m/s); infinite if its file has none."""
    limit = inf if joint is None else description.joints_by_name[joint].limits.velocity
    return limit if limit > 0 else inf


def servo_gains(
    plant: MultibodyPlant,
    robots: Sequence[tuple[RobotPlan, ModelInstanceIndex, StateLayout]],
    known: Mapping[str, tuple[ServoGains | None, ...]] | None = None,
    context: Context | None = None,
) -> dict[str, tuple[ServoGains | None, ...]]:
    """Return the gains of every robot's actuators, in their order; None for one that models friction.

    The friction's own gains are set here; the servos' are applied by `set_gains`.

    Args:
        plant: The finalized plant.
        robots: The robots in the plant.
        known: Gains that were calculated before.
        context: A context of the plant with the masses and dampings that count, at the start; by default the files'.

    Raises:
        InputError: If a joint's limits are so large that gains cannot be calculated.
    """
    known = known or {}
    servos: list[tuple[RobotPlan, JointActuator]] = []
    for plan, instance, _ in robots:
        for actuator in map(plant.get_joint_actuator, plant.GetJointActuatorIndices(instance)):
            if actuator.name().endswith(FRICTION_SUFFIX):
                actuator.set_controller_gains(PdControllerGains(p=0.0, d=actuator.effort_limit() / CREEP))
            elif plan.name not in known:
                servos.append((plan, actuator))
    new = [robot for robot in robots if robot[0].name not in known]
    continuous = plant.time_step() == 0.0
    loads = _joint_loads(plant, new, servos, plant.CreateDefaultContext() if context is None else context)
    for (plan, actuator), load in zip(servos, loads, strict=True):
        if not np.isfinite((load.inertia, load.gravity, load.contact)).all():
            raise InputError(
                f"robot {plan.name!r}: joint {actuator.joint().name()!r} cannot be driven: within the joints' limits"
                " its inertia or load is too large for a floating-point number",
                file=plan.description.file,
            )
    gains = {
        actuator.index(): ServoGains(
            position_gains(load, plan.position_time_constant),
            velocity_gains(load, continuous=continuous),
            brake_gains(load, actuator.effort_limit()),
            effort_gains(
                actuator.effort_limit(),
                velocity_limit(plan.description, actuator.joint().name()),
                continuous=continuous,
            ),
            actuator.effort_limit(),
        )
        for (plan, actuator), load in zip(servos, loads, strict=True)
    }
    return {
        plan.name: known.get(plan.name) or tuple(gains.get(index) for index in plant.GetJointActuatorIndices(instance))
        for plan, instance, _ in robots
    }


def set_gains(
    plant: MultibodyPlant,
    instance: ModelInstanceIndex,
    gains: Sequence[ServoGains | None],
    modes: Sequence[str],
) -> None:
    """Apply gains; they belong to the plant, not to the Context.

    Args:
        plant: The plant.
        instance: The robot's model instance.
        gains: The gains of its actuators.
        modes: The mode of each of its actuators.
    """
    for index, servo, mode in zip(plant.GetJointActuatorIndices(instance), gains, modes, strict=True):
        if servo is not None:
            actuator = plant.get_joint_actuator(index)
            actuator.set_controller_gains(servo.of(mode))
            if mode != EFFORT:  # where it is the commanded effort: see `JointServo`
                actuator.set_effort_limit(servo.effort_limit)


def _joint_loads(
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
    inertia = np.full(len(actuators), _LEAST_INERTIA)
    gravity = np.zeros(len(actuators))
    samplers = [np.random.default_rng(0) for _ in robots]  # one per robot: its samples do not depend on other robots
    for sample in range(_SAMPLES):
        for sampler, (plan, instance, layout) in zip(samplers, robots, strict=True):
            if sample > 0:  # the first sample is the start configuration
                q = plant.GetPositions(context, instance)
                _sample_joints(q, plan, layout, sampler)
                plant.SetPositions(context, instance, q)
        inertia = np.maximum(inertia, np.diag(plant.CalcMassMatrix(context))[velocities])
        gravity = np.maximum(gravity, np.abs(plant.CalcGravityGeneralizedForces(context)[velocities]))
    g = float(np.linalg.norm(plant.gravity_field().gravity_vector()))
    weights = {plan.name: g * plant.CalcTotalMass(start, [instance]) for plan, instance, _ in robots}
    return [
        JointLoad(
            inertia=float(m),
            gravity=float(load) + _friction(plan, actuator) + _drag(plan, actuator),
            contact=_contact_load(plant, start, plan, actuator, float(m), weights[plan.name]),
            damping=float(actuator.joint().GetDampingVector(start)[0]),
        )
        for (plan, actuator), m, load in zip(actuators, inertia, gravity, strict=True)
    ]


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
