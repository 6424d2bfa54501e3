"""The description of a robot in a format that only Drake's parser reads (SDF, MJCF), from the parsed model."""

from collections.abc import Iterator, Mapping
from math import inf, isfinite
from pathlib import Path

from drake_twin.description.drake_log import DRAKE_RAISES, captured_warnings, without_literal
from drake_twin.description.model_frames import MODEL_FRAME
from drake_twin.description.robot_description import (
    POSED_JOINT_TYPES,
    HardwareSystem,
    Joint,
    JointLimits,
    Pose,
    RobotDescription,
    Vector3,
)
from drake_twin.errors import InputError

_SAME = 1e-12  # m and rad


def describe_model(
    prepared: str,
    drake_format: str,
    text: str,
    file: Path,
    name: str,
    systems: tuple[HardwareSystem, ...] = (),
    efforts: Mapping[str, float] | None = None,
) -> RobotDescription:
    """Describe a prepared model.

    Args:
        prepared: The model as Drake's parser accepts it.
        drake_format: ``sdf``, or ``xml`` for MJCF.
        text: The file's own text, which is published as ``robot_description``.
        file: The file.
        name: The robot's name in the file.
        systems: What of it can be commanded.
        efforts: Joint name → its actuator's largest effort (N·m or N); for MJCF.

    Raises:
        InputError: If Drake refuses the model; with Drake's reason.
    """
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(time_step=0.001)
    try:
        with captured_warnings():  # the twin's own plant repeats them
            (instance,) = Parser(plant).AddModelsFromString(prepared, drake_format)
    except DRAKE_RAISES as error:
        raise InputError(
            f"Drake cannot read this robot: {without_literal(' '.join(str(error).split()))}", file=file
        ) from None
    if drake_format == "sdf":
        actuators = map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
        efforts = {actuator.joint().name(): actuator.effort_limit() for actuator in actuators}
    links = tuple(plant.get_body(index).name() for index in plant.GetBodyIndices(instance))
    joints = tuple(_joints(plant, instance, efforts or {}))
    children = {joint.child for joint in joints}
    roots = [link for link in links if link not in children]
    if len(roots) != 1 and drake_format != "sdf":
        raise InputError(f"the links must form one tree, but {', '.join(roots)} have no parent", file=file)
    poses = dict.fromkeys(roots, Pose())
    if plant.HasFrameNamed(MODEL_FRAME, instance):
        try:
            plant.Finalize()
        except RuntimeError as error:  # such as joints that form a loop
            raise InputError(f"Drake cannot simulate this robot: {' '.join(str(error).split())}", file=file) from None
        context = plant.CreateDefaultContext()
        model = plant.GetFrameByName(MODEL_FRAME, instance)
        for link in roots:
            X_ML = plant.CalcRelativeTransform(context, model, plant.GetBodyByName(link, instance).body_frame())
            poses[link] = Pose() if X_ML.IsNearlyIdentity(_SAME) else Pose.of(X_ML)
    return RobotDescription(
        name=name,
        links=links,
        joints=joints,
        systems=systems,
        text=text,
        file=file,
        root_pose=poses.pop(roots[0]),
        loose_links=poses,
    )


def _joints(plant, instance, efforts: Mapping[str, float]) -> Iterator[Joint]:  # type: ignore[no-untyped-def]  # pydrake types stay in this module
    for index in plant.GetJointIndices(instance):
        joint = plant.get_joint(index)
        kind = {"weld": "fixed", "ball_rpy": "ball"}.get(joint.type_name(), joint.type_name())
        if kind not in ("fixed", "revolute", "prismatic", "planar", *POSED_JOINT_TYPES):
            kind = "floating"
        axis: Vector3 = (1.0, 0.0, 0.0)
        limits = JointLimits()
        if kind in ("revolute", "prismatic"):
            x, y, z = joint.revolute_axis() if kind == "revolute" else joint.translation_axis()
            axis = (x, y, z)
            lower, upper = joint.position_lower_limits()[0], joint.position_upper_limits()[0]
            if kind == "revolute" and not isfinite(lower) and not isfinite(upper):
                kind = "continuous"
            limits = JointLimits(lower, upper, joint.velocity_upper_limits()[0], efforts.get(joint.name(), inf))
        origin = joint.frame_on_parent().GetFixedPoseInBodyFrame()
        if kind == "fixed":  # a weld may hold its pose itself, instead of in its frames
            origin = origin @ joint.X_FM()
        yield Joint(
            name=joint.name(),
            type=kind,
            parent=joint.parent_body().name(),
            child=joint.child_body().name(),
            origin=Pose.of(origin),
            axis=axis,
            limits=limits,
            damping=float(joint.default_damping_vector()[0]) if joint.num_velocities() else 0.0,
            child_origin=Pose.of(joint.frame_on_child().GetFixedPoseInBodyFrame().inverse()),
        )
