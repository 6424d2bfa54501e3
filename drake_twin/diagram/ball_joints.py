"""Models with ball joints, whose orientation is unlimited.

Drake's own ball joint has roll, pitch and yaw as coordinates, and the run ends at a pitch of 90°. Here the orientation
is a quaternion: the child moves on a joint with six degrees of freedom, and a constraint holds its center. The engine
``cenic`` has such constraints since Drake 1.56.
"""

from lxml import etree
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import (
    FixedOffsetFrame,
    ModelInstanceIndex,
    QuaternionFloatingJoint,
    SpatialInertia,
    default_model_instance,
)

from drake_twin.diagram.cenic_constraints import cenic_has_constraints
from drake_twin.errors import InputError
from drake_twin.scenario import CENIC, DISCRETE

_ON_PARENT = ".on_parent"


def add_sdf_models(plant: MultibodyPlant, text: str) -> list[ModelInstanceIndex]:
    """Parse SDF into a plant, as Drake's parser does except for ball joints.

    Joints cannot be removed from a plant that has constraints. So each ball joint is replaced in the text by two frames
    at its pose.

    Args:
        plant: The plant, not yet finalized; it is changed.
        text: The document.

    Returns:
        The model instances of the outermost models.

    Raises:
        InputError: If there is a ball joint and ``cenic`` does not support it; ``value`` is the joint's name.
        RuntimeError: If Drake refuses the text.
    """
    root = etree.fromstring(text.encode())
    balls = [joint for joint in root.iter("joint") if joint.get("type") == "ball"]
    if not balls:
        return list(Parser(plant).AddModelsFromString(text, "sdf"))
    if plant.time_step() == 0.0 and not cenic_has_constraints("AddBallConstraint"):
        name = balls[0].get("name", "")
        what = f"the engine {CENIC} of this Drake does not support the ball joint {name!r} (Drake 1.56 and later do)"
        raise InputError(
            f"{what}: use the engine {DISCRETE}, or make the joint fixed, revolute or universal", value=name
        )
    places = [(_scope(joint), joint.get("name", ""), _damping(joint)) for joint in balls]
    for joint in balls:
        _leave_frames(joint)
    instances = list(Parser(plant).AddModelsFromString(etree.tostring(root, encoding="unicode"), "sdf"))
    for scope, name, damping in places:
        _add_ball_joint(plant, plant.GetModelInstanceByName(scope), name, damping)
    return instances


def _scope(joint: etree._Element) -> str:
    """Return the name of the model that a joint belongs to, as in Drake."""
    return "::".join([model.get("name", "") for model in joint.iterancestors("model")][::-1])


def _damping(joint: etree._Element) -> float:
    return float(joint.findtext("axis/dynamics/damping") or 0.0)


def _leave_frames(joint: etree._Element) -> None:
    """Replace a joint by a frame on its child link, and one at the same pose on its parent link."""
    model, name = joint.getparent(), joint.get("name", "")
    assert model is not None
    child, parent = ((joint.findtext(end) or "").strip() for end in ("child", "parent"))
    frame = etree.SubElement(model, "frame", name=name, attached_to=child)
    pose = joint.find("pose")
    if pose is not None:
        frame.append(pose)
    if parent != "world":
        on_parent = etree.SubElement(model, "frame", name=f"{name}{_ON_PARENT}", attached_to=parent)
        etree.SubElement(on_parent, "pose", relative_to=name).text = "0 0 0 0 0 0"
    model.remove(joint)


def _add_ball_joint(plant: MultibodyPlant, instance: ModelInstanceIndex, name: str, damping: float) -> None:
    M = plant.GetFrameByName(name, instance)
    child = M.body()
    if plant.HasFrameNamed(f"{name}{_ON_PARENT}", instance):
        F = plant.GetFrameByName(f"{name}{_ON_PARENT}", instance)
        parent = F.body()
    else:  # on the world: Drake 1.51 crashes on a constraint with the world
        called = f"{plant.GetModelInstanceName(instance)}.{name}"
        parent = plant.AddRigidBody(called, default_model_instance(), SpatialInertia.Zero())
        plant.WeldFrames(plant.world_frame(), parent.body_frame())
        X_WM = plant.GetDefaultFloatingBaseBodyPose(child) @ M.GetFixedPoseInBodyFrame()
        F = plant.AddFrame(FixedOffsetFrame(f"{name}{_ON_PARENT}", parent.body_frame(), X_WM, instance))
    plant.AddJoint(QuaternionFloatingJoint(name, F, M, damping, 0.0))
    p_PF, p_CM = (frame.GetFixedPoseInBodyFrame().translation() for frame in (F, M))
    plant.AddBallConstraint(parent, p_PF, child, p_CM)
