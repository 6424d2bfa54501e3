"""MoveIt's constraints as an error that vanishes where they are met.

Source: moveit_core (ros2), kinematic_constraints/src/kinematic_constraint.cpp and utils.cpp.
"""

from collections.abc import Callable, Iterable
from math import asin, atan2
from typing import Any

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform, RotationMatrix

from drake_twin.nodes.motion.arm_model import ArmModel

_MET = 0.9  # of a tolerance, at which the error is zero
_ROTATION_VECTOR = 1  # OrientationConstraint.parameterization; else three angles about x, y, z

Error = Callable[[ArmModel, np.ndarray], np.ndarray]
Place = Callable[[str], RigidTransform]  # a frame's name → its pose in the robot's root link


class ConstraintError(ValueError):
    """A constraint names what does not exist, or has a region that is not supported."""


def constraint_error(constraints: Any, place: Place, model: ArmModel) -> Error:
    """Return the error of a ``moveit_msgs/Constraints``: all elements within ±1 where they are met.

    Raises:
        ConstraintError: If it names a joint or a link that the robot lacks, or a region that is not one sphere or
            box.
    """
    if constraints.visibility_constraints:
        raise ConstraintError("visibility constraints are not supported")
    parts = [
        *(_joint_error(item, model) for item in constraints.joint_constraints),
        *(_position_error(item, place, model) for item in constraints.position_constraints),
        *(_orientation_error(item, place, model) for item in constraints.orientation_constraints),
    ]

    def error(model: ArmModel, positions: np.ndarray) -> np.ndarray:
        values = [part(model, positions) for part in parts]
        return np.concatenate(values) if values else np.zeros(0)

    return error


def pose_error(link: str, target: RigidTransform, tolerances: tuple[float, float], *, turns: bool = True) -> Error:
    """Return the error of a link's pose in the root link, with tolerances (m, rad); of its position alone if not."""

    def error(model: ArmModel, positions: np.ndarray) -> np.ndarray:
        pose = model.pose(positions, link)
        off = np.asarray(pose.translation() - target.translation()) / tolerances[0]
        if not turns:
            return _beyond(off)
        turn = _rotation_vector(target.rotation().inverse() @ pose.rotation()) / tolerances[1]
        return _beyond(np.concatenate([off, turn]))

    return error


def to_pose(message: Any) -> RigidTransform:
    """Return the transform of a ``geometry_msgs/Pose``; a quaternion of zeros means the identity, as in MoveIt."""
    place, turn = message.position, message.orientation
    wxyz = np.array([turn.w, turn.x, turn.y, turn.z])
    norm = np.linalg.norm(wxyz)
    quaternion = Quaternion(wxyz / norm) if norm > 1e-6 else Quaternion.Identity()
    return RigidTransform(quaternion, [place.x, place.y, place.z])


def fill_pose(message: Any, pose: RigidTransform) -> None:
    """Set a ``geometry_msgs/Pose``."""
    message.position.x, message.position.y, message.position.z = map(float, pose.translation())
    turn, wxyz = message.orientation, pose.rotation().ToQuaternion().wxyz()
    turn.w, turn.x, turn.y, turn.z = map(float, wxyz)


def _joint_error(item: Any, model: ArmModel) -> Error:
    if item.joint_name not in model.joints:
        raise ConstraintError(f"joint {item.joint_name!r} does not exist; there are {', '.join(model.joints)}")
    index = model.joints.index(item.joint_name)
    middle = item.position + 0.5 * (item.tolerance_above - item.tolerance_below)
    reach = max(0.5 * (item.tolerance_above + item.tolerance_below), 1e-4)
    return lambda _, positions: _beyond(np.array([(positions[index] - middle) / reach]))


def _position_error(item: Any, place: Place, model: ArmModel) -> Error:
    _check_link(item.link_name, model)
    region = item.constraint_region
    pairs = list(zip(region.primitives, region.primitive_poses, strict=False))
    if len(pairs) != 1 or region.meshes or pairs[0][0].type not in (1, 2):
        raise ConstraintError("a position constraint must have one region, a box or a sphere")
    shape, pose = pairs[0]
    center = place(item.header.frame_id) @ to_pose(pose)
    sides = np.array(shape.dimensions) * (0.5 if shape.type == 1 else 1.0)
    reach = np.maximum(sides if sides.size == 3 else np.full(3, sides[0] / np.sqrt(3)), 1e-5)
    offset = np.array([item.target_point_offset.x, item.target_point_offset.y, item.target_point_offset.z])
    link = item.link_name

    def error(model: ArmModel, positions: np.ndarray) -> np.ndarray:
        point = center.inverse() @ (model.pose(positions, link) @ offset)
        return _beyond(np.asarray(point).ravel() / reach)

    return error


def _orientation_error(item: Any, place: Place, model: ArmModel) -> Error:
    _check_link(item.link_name, model)
    turn = item.orientation
    wanted = place(item.header.frame_id).rotation() @ RotationMatrix(
        Quaternion(np.array([turn.w, turn.x, turn.y, turn.z]) / np.linalg.norm([turn.w, turn.x, turn.y, turn.z]))
    )
    tolerances = (item.absolute_x_axis_tolerance, item.absolute_y_axis_tolerance, item.absolute_z_axis_tolerance)
    reach = np.maximum(np.array(tolerances), 1e-4)
    angles = _rotation_vector if item.parameterization == _ROTATION_VECTOR else _angles_xyz
    link = item.link_name

    def error(model: ArmModel, positions: np.ndarray) -> np.ndarray:
        return _beyond(angles(wanted.inverse() @ model.pose(positions, link).rotation()) / reach)

    return error


def _check_link(name: str, model: ArmModel) -> None:
    if not model.has_link(name):
        raise ConstraintError(f"link {name!r} does not exist")


def joint_goals(constraints: Iterable[Any]) -> dict[str, float]:
    """Return the positions (rad or m) that joint constraints ask for, by the joints' names."""
    return {item.joint_name: item.position for item in constraints}


def _beyond(values: np.ndarray) -> np.ndarray:
    """Return how far values are outside of ±0.9, in tenths, so that they are within ±1 where they are met."""
    return np.asarray((values - np.clip(values, -_MET, _MET)) / (1.0 - _MET))


def _rotation_vector(rotation: RotationMatrix) -> np.ndarray:
    turn = rotation.ToAngleAxis()
    angle = turn.angle()
    return np.asarray(turn.axis() * (angle if angle <= np.pi else angle - 2 * np.pi))


def _angles_xyz(rotation: RotationMatrix) -> np.ndarray:
    """Return the angles of turns about x, the new y, and the new z (rad)."""
    matrix = rotation.matrix()
    return np.array(
        [
            atan2(-matrix[1, 2], matrix[2, 2]),
            asin(float(np.clip(matrix[0, 2], -1.0, 1.0))),
            atan2(-matrix[0, 1], matrix[0, 0]),
        ]
    )
