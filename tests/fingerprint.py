"""What a twin simulates, aspect by aspect, as text: two twins of one fingerprint are the same robots in one world."""

import dataclasses
import re
from collections.abc import Mapping

import numpy as np
from pydrake.geometry import Role
from pydrake.multibody.tree import ModelInstanceIndex

from drake_twin.planning.controller_plan import UNLOADED

STEPS = 10
_NOT_THE_ROBOT = ("place", "text", "places", "file", "findings", "error", "sources", "ros_parameters")


def fingerprint(twin):
    """Aspect → what the twin has of it; it steps the twin, so that what no other aspect shows is in its state."""
    plant, scenario = twin.plant, twin.scenario
    context = plant.GetMyContextFromRoot(twin.context)
    found = {
        "bodies": [_body(plant, context, plant.get_body(index)) for index in _bodies(plant)],
        "joints": [_joint(plant.get_joint(index)) for index in plant.GetJointIndices()],
        "actuators": [_actuator(plant.get_joint_actuator(index)) for index in plant.GetJointActuatorIndices()],
        "gravity": [_numbers(plant.gravity_field().gravity_vector())],
        "shapes": list(_shapes(twin.diagram.GetSubsystemByName("scene_graph").model_inspector())),
        "contact": [
            f"{item.model} {item.touches} {item.friction:.6g} {_pose(item.X_BG)}" for item in twin.built.shapes
        ],
        "topics": _topics(twin),
        "sensors": [_plain(item) for item in twin.entities.sensors],
        "scenario": [_plain((scenario.time_step, scenario.world, scenario.static_transforms))],
        "programs": [_plain((scenario.commands, [(node.package, node.executable) for node in scenario.nodes]))],
        "surroundings": [_plain(twin.built.world_file and twin.built.world_file.surroundings)],
    }
    for plan in twin.built.plans:
        found[f"controllers of {plan.name}"] = [_plain(item) for item in plan.controllers if item.state != UNLOADED]
        found[f"plan of {plan.name}"] = [
            _plain(
                (
                    plan.manager.update_rate,
                    plan.manager.enforce_command_limits,
                    plan.joints.are_held,
                    plan.joints.position_time_constant,
                )
            ),
            _plain(
                (
                    plan.frame_prefix,
                    plan.joints.start_positions,
                    plan.joints.servos,
                    plan.hardware_states,
                    plan.manager.strictness,
                )
            ),
            _plain((plan.model.is_fixed, plan.spawn_pose, plan.description.root_link)),
            _plain((plan.description.systems, plan.description.joints)),
        ]
    twin.step(STEPS)
    now = plant.GetMyContextFromRoot(twin.context)
    found["motion"] = [_numbers(plant.GetPositionsAndVelocities(now))]
    return {aspect: sorted(lines) for aspect, lines in found.items()}


def _topics(twin):
    """The topics without those of controllers that are not loaded: nothing publishes or hears them."""
    unloaded = {item.name for plan in twin.built.plans for item in plan.controllers if item.state == UNLOADED}
    topics = {**twin.graph.topics(), **twin.graph.actions()}
    return [f"{topic} {kind}" for topic, kind in topics.items() if unloaded.isdisjoint(topic.split("/"))]


def difference(before, after):
    """The aspects that differ, each with its first lines that the other has not."""
    for aspect in {**before, **after}:
        old, new = before.get(aspect, []), after.get(aspect, [])
        if old != new:
            lost = next((line for line in old if line not in new), "")
            gained = next((line for line in new if line not in old), "")
            yield f"{aspect}: {lost} -> {gained}"


def _bodies(plant):
    instances = map(ModelInstanceIndex, range(1, plant.num_model_instances()))  # without the world
    return [index for instance in instances for index in plant.GetBodyIndices(instance)]


def _body(plant, context, body):
    inertia = body.default_spatial_inertia()
    pose = _pose(plant.EvalBodyPoseInWorld(context, body))
    numbers = _numbers([inertia.get_mass(), *inertia.get_com(), *inertia.CalcRotationalInertia().get_moments()])
    products = _numbers(inertia.CalcRotationalInertia().get_products())
    return f"{body.scoped_name()} {numbers} {products} {pose}"


def _joint(joint):
    limits = (joint.position_lower_limits(), joint.position_upper_limits(), joint.velocity_upper_limits())
    frames = [_pose(frame.GetFixedPoseInBodyFrame()) for frame in (joint.frame_on_parent(), joint.frame_on_child())]
    axis = next((_numbers(getattr(joint, name)()) for name in _AXES if hasattr(joint, name)), "")
    between = f"{joint.parent_body().scoped_name()} {joint.child_body().scoped_name()}"
    numbers = " | ".join(map(_numbers, (*limits, joint.default_damping_vector(), joint.default_positions())))
    return f"{joint.model_instance()} {joint.name()} {joint.type_name()} {between} {frames} {axis} {numbers}"


_AXES = ("revolute_axis", "translation_axis", "screw_axis")


def _actuator(actuator):
    gains = actuator.get_controller_gains() if actuator.has_controller() else None
    numbers = [actuator.effort_limit(), actuator.default_rotor_inertia(), actuator.default_gear_ratio()]
    numbers += [gains.p, gains.d] if gains else []
    return f"{actuator.name()} {actuator.joint().name()} {_numbers(numbers)}"


def _shapes(inspector):
    for identity in inspector.GetAllGeometryIds():
        shape = re.sub(r"0x\w+", "", repr(inspector.GetShape(identity)))
        name = inspector.GetName(inspector.GetFrameId(identity))  # the shape's own is a label
        looks = inspector.GetIllustrationProperties(identity)
        colour = "" if looks is None else looks.GetPropertyOrDefault("phong", "diffuse", "")
        rgba = "" if colour == "" else _numbers([colour.r(), colour.g(), colour.b(), colour.a()])
        roles = [str(role) for role in _ROLES if inspector.GetProperties(identity, role) is not None]
        yield f"{name} {shape} {_pose(inspector.GetPoseInFrame(identity))} {rgba} {roles}"


_ROLES = (Role.kProximity, Role.kPerception, Role.kIllustration)


def _pose(pose):
    return _numbers(pose.GetAsMatrix34().ravel())


def _numbers(values):
    return " ".join(f"{value + 0.0:.7g}" for value in np.round(np.asarray(values, dtype=float).ravel(), 9))


def _plain(value):
    """Text of a value without what says where it was written, and without addresses in memory."""
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        items = ((item.name, getattr(value, item.name)) for item in dataclasses.fields(value))
        inner = ", ".join(f"{name}={_plain(item)}" for name, item in items if name not in _NOT_THE_ROBOT)
        return f"{type(value).__name__}({inner})"
    if isinstance(value, Mapping):
        return "{" + ", ".join(f"{_plain(key)}: {_plain(item)}" for key, item in value.items()) + "}"
    if isinstance(value, (list, tuple)):
        return "[" + ", ".join(map(_plain, value)) + "]"
    return re.sub(r" at 0x\w+", "", repr(value))
