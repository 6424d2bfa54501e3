"""The control law of admittance_controller: a mass, a damper and a spring between a reference and a measured wrench."""

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.controllers.chain_kinematics import ChainKinematics
from drake_twin.dataclass import dataclass
from drake_twin.saved import saved

_ZERO = (0.0,) * 6
_IDENTITY = (0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0)


@saved("AdmittanceState")
@dataclass(frozen=True)
class AdmittanceState:
    """The state of the control law; vectors of six have three linear components and three angular ones.

    Attributes:
        joint_positions: The offset of each joint from its reference (rad or m).
        joint_velocities: Its velocity (rad/s or m/s).
        joint_accelerations: Its acceleration (rad/s² or m/s²).
        wrench_world: The filtered wrench in the world's axes (N, N·m).
        wrench_base: The same in the base's axes.
        velocity: The sensor frame's velocity in the base, of the offset alone (m/s, rad/s).
        acceleration: Its acceleration.
        offset: The sensor frame's pose relative to its reference, in the base's axes: x, y, z, qw, qx, qy, qz (m).
        reference: The pose of the sensor frame in the base at the reference, likewise.
        control: The orientation of the control frame in the base, as a pose without translation.
    """

    joint_positions: tuple[float, ...]
    joint_velocities: tuple[float, ...]
    joint_accelerations: tuple[float, ...]
    wrench_world: tuple[float, ...] = _ZERO
    wrench_base: tuple[float, ...] = _ZERO
    velocity: tuple[float, ...] = _ZERO
    acceleration: tuple[float, ...] = _ZERO
    offset: tuple[float, ...] = _IDENTITY
    reference: tuple[float, ...] = _IDENTITY
    control: tuple[float, ...] = _IDENTITY

    @classmethod
    def at_rest(cls, joints: int) -> "AdmittanceState":
        """Return the state without an offset."""
        return cls((0.0,) * joints, (0.0,) * joints, (0.0,) * joints)


@dataclass(frozen=True, kw_only=True)
class AdmittanceRule:
    """``mass · a = wrench - damping · v - stiffness · x``, at the force/torque sensor's frame.

    As in upstream's ``AdmittanceRule``, the offset ``x`` is that of the measured joints from the reference, stiffness
    and damping are along the axes of the control frame, the mass along those of the base, and accelerations become
    those of joints by the damped inverse of the Jacobian.

    Attributes:
        kinematics: The kinematics of the joints.
        sensor_frame: The link of the force/torque sensor.
        control_frame: The link whose axes stiffness, damping and selected axes have.
        world_frame: The link in which gravity is along negative z.
        gravity_frame: The link in which the centre of gravity is given.
        center_of_gravity: The end effector's centre of gravity, shape (3,) (m).
        weight: The end effector's weight (N).
        filter_coefficient: The share of a new wrench in the filtered one.
        selected_axes: The axes in which a wrench has an effect, shape (6,).
        mass: Shape (6,) (kg, kg·m²).
        damping: Shape (6,) (N·s/m, N·m·s/rad).
        stiffness: Shape (6,) (N/m, N·m/rad).
        joint_damping: The deceleration of each joint's offset by its velocity (1/s).
    """

    kinematics: ChainKinematics
    sensor_frame: str
    control_frame: str
    world_frame: str
    gravity_frame: str
    center_of_gravity: np.ndarray
    weight: float
    filter_coefficient: float
    selected_axes: np.ndarray
    mass: np.ndarray
    damping: np.ndarray
    stiffness: np.ndarray
    joint_damping: float

    def update(
        self, state: AdmittanceState, measured: np.ndarray, reference: np.ndarray, wrench: np.ndarray, dt: float
    ) -> AdmittanceState:
        """Make one step of semi-implicit Euler.

        Args:
            state: The state after the last step.
            measured: The joints' positions (rad or m).
            reference: Their reference positions.
            wrench: The wrench on the sensor frame in its own axes, force first, shape (6,) (N, N·m).
            dt: The time since the last step (s).
        """
        pose = self.kinematics.pose
        X_sensor, X_reference = pose(measured, self.sensor_frame), pose(reference, self.sensor_frame)
        R_world_base = pose(measured, self.world_frame).rotation().inverse()
        R_gravity = R_world_base @ pose(measured, self.gravity_frame).rotation()
        new = self._without_weight(_rotated(R_world_base @ X_sensor.rotation(), wrench), R_gravity)
        share = self.filter_coefficient
        filtered = share * new + (1.0 - share) * np.array(state.wrench_world)
        wrench_base = _rotated(R_world_base.inverse(), filtered)

        R = pose(measured, self.control_frame).rotation()
        turned = X_sensor.rotation() @ X_reference.rotation().inverse()
        offset = RigidTransform(turned, X_sensor.translation() - X_reference.translation())
        turn = turned.ToAngleAxis()
        x = np.concatenate([offset.translation(), turn.angle() * turn.axis()])
        back = R.inverse()
        resistance = self.damping * _rotated(back, np.array(state.velocity)) + self.stiffness * _rotated(back, x)
        force = _rotated(R, self.selected_axes * _rotated(back, wrench_base) - resistance)
        accelerations = self.kinematics.joint_deltas(measured, force / self.mass, self.sensor_frame)
        accelerations = accelerations - self.joint_damping * np.array(state.joint_velocities)
        velocities = np.array(state.joint_velocities) + accelerations * dt
        positions = np.array(state.joint_positions) + velocities * dt
        deltas = self.kinematics.cartesian_deltas
        return AdmittanceState(
            joint_positions=tuple(positions.tolist()),
            joint_velocities=tuple(velocities.tolist()),
            joint_accelerations=tuple(accelerations.tolist()),
            wrench_world=tuple(filtered.tolist()),
            wrench_base=tuple(wrench_base.tolist()),
            velocity=tuple(deltas(measured, velocities, self.sensor_frame).tolist()),
            acceleration=tuple(deltas(measured, accelerations, self.sensor_frame).tolist()),
            offset=_numbers(offset),
            reference=_numbers(X_reference),
            control=_numbers(RigidTransform(R, np.zeros(3))),
        )

    def _without_weight(self, wrench: np.ndarray, R_gravity: RotationMatrix) -> np.ndarray:
        """Return a wrench in the world's axes without what the end effector's weight adds."""
        weight = np.array([0.0, 0.0, -self.weight])
        moment = np.cross(R_gravity.matrix() @ self.center_of_gravity, weight)
        return np.asarray(wrench - np.concatenate([weight, moment]))


def _rotated(rotation: RotationMatrix, six: np.ndarray) -> np.ndarray:
    """Return six components in other axes."""
    return np.asarray((rotation.matrix() @ six.reshape(2, 3).T).T.ravel())


def _numbers(pose: RigidTransform) -> tuple[float, ...]:
    """Return x, y, z, qw, qx, qy, qz."""
    return (*pose.translation().tolist(), *pose.rotation().ToQuaternion().wxyz().tolist())
