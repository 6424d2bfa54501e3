"""Gains of the implicit PD servo that Drake applies at each actuated joint.

They follow from the joint's own inertia and load over its range, so that a robot needs no tuning and one robot's gains
never depend on another's. The command interface that drives a joint decides which gains apply.
"""

from collections.abc import Mapping, Sequence
from math import inf, sqrt

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import JointActuator, ModelInstanceIndex, PdControllerGains
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.description.robot_description import RobotDescription
from drake_twin.diagram.joint_friction import CREEP, FRICTION_SUFFIX
from drake_twin.diagram.joint_loads import JointLoad, joint_loads
from drake_twin.errors import InputError
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.planning.robot_plan import RobotPlan

# The time constant with which a velocity servo reaches its command against inertia alone (s).
_VELOCITY_TIME_CONSTANT = 0.005
_VELOCITY_AT_ONCE = 1e-5  # that of a plugin's servo that is there in the next step (s)
# The velocity error of a servo under the joint's largest gravity load, and under its share of the robot's weight
# (rad/s, m/s).
_VELOCITY_ERROR_UNDER_GRAVITY = 2.5e-4
_VELOCITY_ERROR_UNDER_CONTACT = 1e-2
_RELATIVE_ERROR_UNDER_DAMPING = 5e-4  # relative to the commanded velocity

# A position servo sags by at most this much under gravity, and under its share of the robot's weight (rad or m).
_SAG_UNDER_GRAVITY = 5e-4
_YIELD_UNDER_CONTACT = 1e-2
# It has its full effort where it is behind the velocity that its error asks for by this much (rad/s, m/s). In Gazebo a
# joint that is behind at all has it.
_FULL_EFFORT_VELOCITY = 1e-2
_STIFFEST = 1e5  # of what moves the joint: as good as rigid, and within what Drake's solvers take
_AT_ONCE = 1e-3  # error over velocity of a servo that is there in a step of Gazebo (s)

# A joint that is stopped brakes as a dry friction of its effort limit would: with the full effort above this velocity.
# Below, where less effort holds it, it is at rest (rad/s or m/s).
REST_VELOCITY = 1e-3

# A commanded effort fades to nothing while the joint passes its velocity limit by this part of the limit.
_OVER_VELOCITY_LIMIT = 0.01


def velocity_gains(
    load: JointLoad, *, time_constant: float = _VELOCITY_TIME_CONSTANT, continuous: bool = False
) -> PdControllerGains:
    """Return the gains of a joint that follows a velocity.

    Args:
        load: The joint's load.
        time_constant: That with which it reaches its command against inertia alone (s).
        continuous: Whether the engine is ``cenic``, which takes a velocity target with the wrong sign: the velocity is
            then given as a far position, with a stiffness that has almost no effect of its own.
    """
    damping = max(
        load.inertia / time_constant,
        load.gravity / _VELOCITY_ERROR_UNDER_GRAVITY,
        load.contact / _VELOCITY_ERROR_UNDER_CONTACT,
        load.damping / _RELATIVE_ERROR_UNDER_DAMPING,
    )
    return _following_velocity(damping, continuous=continuous)


def _following_velocity(damping: float, *, continuous: bool) -> PdControllerGains:
    return PdControllerGains(p=damping / VELOCITY_AS_POSITION if continuous else 0.0, d=damping)


def position_gains(
    load: JointLoad, time_constant: float, effort_limit: float = inf, stiffest: float = inf
) -> PdControllerGains:
    """Return the gains of a joint that moves to a position or holds one, at a velocity of error / T.

    This is the servo of gz_ros2_control, which writes such a velocity to Gazebo's physics. With Kd = Kp · T it is
    overdamped whenever Kp ≥ 4 · inertia / T²; 16 leaves room for a varying inertia.

    Args:
        load: The joint's load.
        time_constant: T (s).
        effort_limit: The effort limit (N·m or N).
        stiffest: The largest Kp (N·m/rad or N/m), but for what bears the load. Where it leaves too little, T is longer.
    """
    T = time_constant
    bears = max(load.gravity / _SAG_UNDER_GRAVITY, load.contact / _YIELD_UNDER_CONTACT)
    moves = 16.0 * load.inertia / T**2
    effort = effort_limit / (_FULL_EFFORT_VELOCITY * T) if np.isfinite(effort_limit) else 0.0
    stiffness = max(bears, moves, min(effort, _STIFFEST * moves))
    if stiffness > stiffest:
        stiffness = max(stiffest, bears)
        T = max(T, 2.0 * sqrt(load.inertia / stiffness))
    return PdControllerGains(p=stiffness, d=stiffness * T)


def brake_gains(load: JointLoad, effort_limit: float) -> PdControllerGains:
    """Return the gains of a joint that comes to rest.

    Args:
        load: The joint's load, which sets the braking of a joint without an effort limit.
        effort_limit: The effort limit (N·m or N).
    """
    if np.isfinite(effort_limit):
        return PdControllerGains(p=0.0, d=max(effort_limit / REST_VELOCITY, _LEAST_DAMPING))
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
    damping = max(effort_limit / (_OVER_VELOCITY_LIMIT * velocity_limit), _LEAST_DAMPING)
    return _following_velocity(damping, continuous=continuous)


# In a continuous plant a velocity v is commanded as the position v · this (s).
VELOCITY_AS_POSITION = 1e7

# How a joint is driven: its position is held, one of its command interfaces is written, or nothing holds it. It brakes
# until it can be held, or rests where its position is too large a number to be held exactly. A far position is
# approached at the joint's velocity limit, up or down.
HOLD, POSITION, VELOCITY, EFFORT, FREE = "hold", "position", "velocity", "effort", "free"
BRAKE, REST, UP, DOWN = "brake", "rest", "up", "down"
MODES = (HOLD, POSITION, VELOCITY, EFFORT, FREE, BRAKE, REST, UP, DOWN)

# Drake ends the process if both gains are zero. This damping has no effect.
_LEAST_DAMPING = 1e-9
_NO_GAINS = PdControllerGains(p=0.0, d=_LEAST_DAMPING)


@dataclass(frozen=True)
class ServoGains:
    """The gains of one actuator in each mode.

    Attributes:
        position: For a commanded or held position.
        velocity: For a commanded velocity, or a position that is approached at the velocity limit.
        brake: For a joint that comes to rest.
        effort: For a commanded effort.
        effort_limit: The largest effort of the actuator (N·m or N).
        limits_velocity: Whether a far position is approached at the joint's velocity limit; a plugin's own PD does not.
    """

    position: PdControllerGains
    velocity: PdControllerGains
    brake: PdControllerGains
    effort: PdControllerGains
    effort_limit: float
    limits_velocity: bool = True

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
    loads = joint_loads(plant, new, servos, plant.CreateDefaultContext() if context is None else context)
    for (plan, actuator), load in zip(servos, loads, strict=True):
        if not np.isfinite((load.inertia, load.gravity, load.contact)).all():
            raise InputError(
                f"robot {plan.name!r}: joint {actuator.joint().name()!r} cannot be driven: within the joints' limits"
                " its inertia or load is too large for a floating-point number",
                file=plan.description.file,
            )
    gains = {
        actuator.index(): ServoGains(
            _position_gains(plan, actuator, load),
            _velocity_gains(plan, actuator, load, continuous=continuous),
            _brake_gains(plan, actuator, load),
            effort_gains(
                actuator.effort_limit(),
                velocity_limit(plan.description, actuator.joint().name()),
                continuous=continuous,
            ),
            actuator.effort_limit(),
            limits_velocity=_own_pd(plan, actuator) is None,
        )
        for (plan, actuator), load in zip(servos, loads, strict=True)
    }
    return {
        plan.name: known.get(plan.name) or tuple(gains.get(index) for index in plant.GetJointActuatorIndices(instance))
        for plan, instance, _ in robots
    }


def _idle_gains(plan: RobotPlan, actuator: JointActuator) -> PdControllerGains | None:
    """Return the gains of an MJCF robot's motor or velocity servo without a motion: MuJoCo's has no others."""
    joint = actuator.joint().name()
    controlled = plan.description.controlled_joints.get(joint)
    if not plan.follows_mujoco or controlled is None or (joint, "position") in plan.joints.servos:
        return None
    return PdControllerGains(p=0.0, d=max(float(controlled.parameters["kv"]), _LEAST_DAMPING))


def _brake_gains(plan: RobotPlan, actuator: JointActuator, load: JointLoad) -> PdControllerGains:
    return _idle_gains(plan, actuator) or brake_gains(load, actuator.effort_limit())


def _position_gains(plan: RobotPlan, actuator: JointActuator, load: JointLoad) -> PdControllerGains:
    own = _own_pd(plan, actuator) or _idle_gains(plan, actuator)
    if own is not None:
        return own
    at_once = (actuator.joint().name(), "position") in plan.joints.servos
    T = _AT_ONCE if at_once else plan.joints.position_time_constant
    return position_gains(load, T, actuator.effort_limit(), load.stiffest)


def _own_pd(plan: RobotPlan, actuator: JointActuator) -> PdControllerGains | None:
    """Return the gains that a plugin gives the position of a joint; None if it leaves them to the twin."""
    servo = plan.joints.servos.get((actuator.joint().name(), "position"))
    if servo is None or servo.proportional is None:
        return None
    return PdControllerGains(p=max(servo.proportional, 0.0), d=max(servo.derivative, _LEAST_DAMPING))


def _velocity_gains(
    plan: RobotPlan, actuator: JointActuator, load: JointLoad, *, continuous: bool
) -> PdControllerGains:
    servo = plan.joints.servos.get((actuator.joint().name(), "velocity"))
    if servo is None:
        return velocity_gains(load, continuous=continuous)
    if servo.proportional is None and not servo.time_constant:
        return velocity_gains(load, time_constant=_VELOCITY_AT_ONCE, continuous=continuous)
    damping = load.inertia / servo.time_constant if servo.proportional is None else servo.proportional
    return _following_velocity(max(damping, _LEAST_DAMPING), continuous=continuous)


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
