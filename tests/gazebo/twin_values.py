"""What the twin makes of a robot's or a world's file, in the form in which ``read_values.cc`` prints Gazebo's."""

import numpy as np
from lxml import etree
from pydrake.geometry import Role, SceneGraph
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex

from drake_twin.description.drake_urdf import drake_link_name, urdf_link_name
from drake_twin.description.fixed_joint_lumping import lumped_links
from drake_twin.diagram.ball_joints import add_sdf_models
from drake_twin.sensors.collision_names import collision_geometries, collision_names

MODEL = "__model__"


def numbers(X):
    return [*X.translation().tolist(), *X.rotation().ToQuaternion().wxyz().tolist()]


def transform(pose):
    return RigidTransform(RollPitchYaw(*pose.rpy), list(pose.xyz))


def parsed(text, kind):
    plant, scene_graph = MultibodyPlant(0.001), SceneGraph()
    plant.RegisterAsSourceForSceneGraph(scene_graph)
    if kind == "sdf":
        add_sdf_models(plant, text)
    else:
        Parser(plant).AddModelsFromString(text, kind)
    plant.Finalize()
    context = plant.CreateDefaultContext()
    positions = plant.GetPositions(context)
    for joint in map(plant.get_joint, plant.GetJointIndices()):
        if joint.num_positions() == 1:
            positions[joint.position_start()] = 0.0
    plant.SetPositions(context, positions)
    return plant, scene_graph.model_inspector(), context


def values_of_robot(model):
    """Return the values of a loaded robot; poses are in its model's frame."""
    description = model.description
    plant, inspector, context = parsed(model.drake_text, model.drake_format)
    root = plant.GetBodyByName(model.root_body)
    X_MR = transform(description.root_pose)
    poses = {}
    for body in map(plant.get_body, plant.GetBodyIndices(root.model_instance())):
        X_RB = plant.CalcRelativeTransform(context, root.body_frame(), body.body_frame())
        poses[urdf_link_name(body.name())] = X_MR @ X_RB
    document = etree.fromstring(description.text.encode())
    lumped = lumped_links(document) if document.tag == "robot" else {}
    said = [finding.what for finding in model.findings]
    is_lost = any("left out" in text for text in said)
    sliding = {joint.child for joint in description.joints if f"joint {joint.name}: its caster ball" in " ".join(said)}
    links = []
    for link in (each for each in description.links if each not in lumped):
        names = collision_names(description, link)
        owners = list(dict.fromkeys((link, *(own for own, _ in names))))
        own = {owner: poses[link].inverse() @ poses[owner] for owner in owners}
        instance = root.model_instance()
        collisions = [
            {"name": names.get(place, "?"), **shape(inspector, geometry, own[place[0]])}
            for geometry, place in collision_geometries(description, owners, plant, instance, inspector)
        ]
        sensors = [
            {
                "name": item.name,
                "type": item.kind,
                "topic": item.topic,
                "rate": item.update_rate,
                "pose": numbers(sensor_pose(item, link, poses, plant, context)),
            }
            for item in description.sensors
            if item.link and item.gazebo_link == link
        ]
        links.append({"name": link, "pose": numbers(poses[link]), "collisions": collisions, "sensors": sensors})
        links[-1]["lost"] = is_lost
        if model.drake_format == "urdf":  # of an SDF it is not used, and a finding says so
            links[-1]["self_collide"] = bool(link in description.surfaces and description.surfaces[link].self_collide)
    joints = []
    for joint in (each for each in description.joints if not (each.type == "fixed" and each.child in lumped)):
        X_MJ = poses[joint.parent] @ transform(joint.origin)
        limits = joint.limits
        joints.append(
            {
                "name": joint.name,
                "type": joint.type,
                "parent": lumped.get(joint.parent, joint.parent),
                "child": joint.child,
                "pose": numbers(X_MJ),
                "axis": (X_MJ.rotation() @ np.array(joint.axis)).tolist(),
                "limits": [limits.lower, limits.upper, limits.velocity, limits.effort],
                "damping": joint.damping,
                "friction": joint.friction,
            }
        )
    return {"name": description.name, "links": links, "joints": joints, "casters": sliding}


def sensor_pose(sensor, link, poses, plant, context):
    """Return the pose of a sensor in the link that has it in Gazebo; see `SensorSetup.pose`."""
    own = transform(sensor.pose)
    if not sensor.pose_frame or sensor.pose_frame == sensor.link:
        return poses[link].inverse() @ poses[sensor.link] @ own
    body = plant.GetBodyByName(drake_link_name(link)).body_frame()
    return plant.CalcRelativeTransform(context, body, plant.GetFrameByName(sensor.pose_frame)) @ own


def shape(inspector, geometry, X_LB):
    properties = inspector.GetProximityProperties(geometry)
    friction = 1.0
    if properties.HasProperty("material", "coulomb_friction"):
        friction = properties.GetProperty("material", "coulomb_friction").dynamic_friction()
    return {"pose": numbers(X_LB @ inspector.GetPoseInFrame(geometry)), "mu": friction}


def values_of_world(world):
    """Return the models of a world that was read; poses are in the world."""
    found = []
    for model in world.models:
        root = etree.fromstring(model.text)
        for tag in ("plane", "mesh"):  # the twin has its own way with those of static models
            for geometry in root.iterfind(f".//geometry/{tag}"):
                piece = geometry.getparent().getparent()
                piece.getparent().remove(piece)
        plant, inspector, context = parsed(etree.tostring(root, encoding="unicode"), "sdf")
        for instance in map(ModelInstanceIndex, range(2, plant.num_model_instances())):
            links = []
            for body in map(plant.get_body, plant.GetBodyIndices(instance)):
                frame = plant.GetBodyFrameIdOrThrow(body.index())
                collisions = [
                    {
                        "name": inspector.GetName(each).rpartition("::")[2].partition("|")[0],
                        **shape(inspector, each, RigidTransform()),
                    }
                    for each in inspector.GetGeometries(frame, Role.kProximity)
                ]
                pose = numbers(plant.EvalBodyPoseInWorld(context, body))
                links.append({"name": body.name(), "pose": pose, "collisions": collisions, "sensors": [], "lost": True})
            found.append({"name": plant.GetModelInstanceName(instance), "links": links, "joints": []})
    return found
