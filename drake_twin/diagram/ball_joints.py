"""Ball joints, which turn every way for ever.

Drake's own ball joint counts its orientation in roll, pitch and yaw, and ends the run where the pitch comes to 90°.
Here the orientation is a quaternion: the child hangs on a joint of six degrees of freedom, and a constraint holds its
centre. Only the discrete engine has such constraints.
"""

from collections.abc import Iterable

from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    BallRpyJoint,
    ModelInstanceIndex,
    QuaternionFloatingJoint,
    SpatialInertia,
    default_model_instance,
)

from drake_twin.errors import InputError
from drake_twin.scenario import CENIC, DISCRETE


def ball_joints(plant: MultibodyPlant, instances: Iterable[ModelInstanceIndex]) -> list[BallRpyJoint]:
    """Drake's own ball joints of some model instances."""
    joints = [plant.get_joint(index) for instance in instances for index in plant.GetJointIndices(instance)]
    return [joint for joint in joints if isinstance(joint, BallRpyJoint)]


def hold_ball_joints(plant: MultibodyPlant, instances: Iterable[ModelInstanceIndex]) -> None:
    """Puts joints that turn every way in the place of Drake's own ball joints; names, frames and damping stay.

    Args:
        plant: the plant, not yet finalized; it is changed.
        instances: the model instances whose ball joints are meant.

    Raises:
        InputError: the engine is ``cenic``, and there is a ball joint: the error's ``value`` is its name.
    """
    for joint in ball_joints(plant, instances):
        name, damping = joint.name(), float(joint.default_damping())
        if plant.time_step() == 0.0:
            raise InputError(
                f"the engine {CENIC} has no ball joints, and {name!r} is one: use the engine {DISCRETE}, or make the"
                " joint fixed, revolute or universal",
                value=name,
            )
        F, M = joint.frame_on_parent(), joint.frame_on_child()
        plant.RemoveJoint(joint)
        plant.AddJoint(QuaternionFloatingJoint(name, F, M, damping, 0.0))
        p_PF, p_CM = (frame.GetFixedPoseInBodyFrame().translation() for frame in (F, M))
        parent = F.body()
        if parent.index() == plant.world_body().index():  # a constraint to which crashes Drake 1.51
            called = f"{plant.GetModelInstanceName(M.model_instance())}.{name}"
            parent = plant.AddRigidBody(called, default_model_instance(), SpatialInertia.Zero())
            plant.WeldFrames(plant.world_frame(), parent.body_frame())
        plant.AddBallConstraint(parent, p_PF, M.body(), p_CM)
