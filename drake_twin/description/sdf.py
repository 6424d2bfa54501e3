"""SDF robots: Drake parses the file, and the description is read back from the parsed model."""

from collections.abc import Iterator
from math import inf, isfinite
from pathlib import Path

from lxml import etree

from drake_twin.description.meshes import collision_mesh, mesh_address, visual_mesh
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_description import Joint, JointLimits, Pose, RobotDescription, Vector3
from drake_twin.description.xml_reader import XmlReader
from drake_twin.errors import InputError


def prepare_sdf(text: str, file: Path, model_name: str | None, packages: PackageIndex) -> tuple[str, bool, str]:
    """SDF text of one model as Drake is given it: under the twin's name, with meshes that Drake reads.

    Returns:
        The text without the model's own weld to the world, whether there was one (or ``<static>``), and the model's
        name in the file.

    Raises:
        InputError: not an SDF file with one model, or a mesh that is missing.
    """
    reader = XmlReader(text, file)
    models = reader.root.findall("model")
    if reader.root.tag != "sdf" or len(models) != 1:
        what = "a world" if reader.root.find("world") is not None else f"{len(models)} models"
        raise reader.error(reader.root, f"a robot is an SDF file with one <model>, but this holds {what}")
    (model,) = models
    nested = model.find("model")
    if nested is not None:
        raise reader.error(nested, "a model inside a model is not supported")
    own_name = reader.text(model, "name")
    model.set("name", model_name or own_name)
    for plugin in model.findall("plugin"):
        model.remove(plugin)
    is_fixed = False
    for static in model.findall("static"):
        is_fixed = is_fixed or (static.text or "").strip().lower() in ("1", "true")
        model.remove(static)
    for joint in model.findall("joint"):
        if (joint.findtext("parent") or "").strip() == "world":
            if joint.get("type") != "fixed":
                raise reader.error(joint, "a joint to the world is supported when it is fixed")
            is_fixed = True
            model.remove(joint)
    for uri in model.iter("uri"):
        parent = uri.getparent()
        if parent is not None and parent.tag == "mesh":
            for_drake = visual_mesh if next(uri.iterancestors("visual"), None) is not None else collision_mesh
            uri.text = mesh_address(for_drake(packages.resolve((uri.text or "").strip(), file)))
    return etree.tostring(reader.root, encoding="unicode"), is_fixed, own_name


def describe_sdf(prepared: str, text: str, file: Path, name: str) -> RobotDescription:
    """The description of a prepared SDF model.

    Args:
        prepared: what `prepare_sdf` made of the file.
        text: the file's own text, which is published as ``robot_description``.
        file: the file.
        name: the robot's name in the file.

    Raises:
        InputError: Drake refuses the model, with Drake's reason.
    """
    from pydrake.multibody.parsing import Parser
    from pydrake.multibody.plant import MultibodyPlant

    plant = MultibodyPlant(time_step=0.001)
    try:
        (instance,) = Parser(plant).AddModelsFromString(prepared, "sdf")
    except RuntimeError as error:
        raise InputError(f"Drake cannot read this SDF: {error}", file=file) from None
    links = tuple(plant.get_body(index).name() for index in plant.GetBodyIndices(instance))
    joints = tuple(_joints(plant, instance))
    children = {joint.child for joint in joints}
    roots = [link for link in links if link not in children]
    if len(roots) != 1:
        raise InputError(f"the links must form one tree, but {', '.join(roots)} have no parent", file=file)
    return RobotDescription(name=name, links=links, joints=joints, text=text, file=file)


def _joints(plant, instance) -> Iterator[Joint]:  # type: ignore[no-untyped-def]  # pydrake types stay in this module
    for index in plant.GetJointIndices(instance):
        joint = plant.get_joint(index)
        kind = {"weld": "fixed"}.get(joint.type_name(), joint.type_name())
        if kind not in ("fixed", "revolute", "prismatic", "planar"):
            kind = "floating"
        axis: Vector3 = (1.0, 0.0, 0.0)
        limits = JointLimits()
        if kind in ("revolute", "prismatic"):
            x, y, z = joint.revolute_axis() if kind == "revolute" else joint.translation_axis()
            axis = (x, y, z)
            lower, upper = joint.position_lower_limits()[0], joint.position_upper_limits()[0]
            if kind == "revolute" and not isfinite(lower) and not isfinite(upper):
                kind = "continuous"
            limits = JointLimits(lower, upper, joint.velocity_upper_limits()[0], inf)
        yield Joint(
            name=joint.name(),
            type=kind,
            parent=joint.parent_body().name(),
            child=joint.child_body().name(),
            origin=_pose(joint.frame_on_parent().GetFixedPoseInBodyFrame()),
            axis=axis,
            limits=limits,
            damping=float(joint.default_damping_vector()[0]) if joint.num_velocities() else 0.0,
            child_origin=_pose(joint.frame_on_child().GetFixedPoseInBodyFrame().inverse()),
        )


def _pose(transform) -> Pose:  # type: ignore[no-untyped-def]
    from pydrake.math import RollPitchYaw

    x, y, z = transform.translation()
    roll, pitch, yaw = RollPitchYaw(transform.rotation()).vector()
    return Pose((x, y, z), (roll, pitch, yaw))
