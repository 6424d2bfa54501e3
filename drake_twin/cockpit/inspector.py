"""What the page shows of the thing that is selected: labelled values in sections, the same form for every kind."""

from collections.abc import Iterable, Iterator
from math import isfinite
from pathlib import PurePath

import numpy as np
from pydrake.geometry import HalfSpace, Shape
from pydrake.math import RollPitchYaw
from pydrake.multibody.tree import RigidBody

from drake_twin.cockpit.world_tree import GROUND, JOINT, LIGHT, LINK, MODEL, ROBOT, SENSOR, Node, instances_of, place_of
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.robot_description import Joint, Vector3
from drake_twin.diagram.contact import TouchingShape
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.shared_viewer.shared_scene import WORLD
from drake_twin.twin.twin import Twin

_DIGITS = 6


@dataclass(frozen=True)
class Row:
    """A labelled value.

    Attributes:
        label: What it is.
        values: Numbers.
        unit: Their unit.
        text: A text, in place of numbers or after them.
    """

    label: str
    values: tuple[float, ...] = ()
    unit: str = ""
    text: str = ""


@dataclass(frozen=True)
class Section:
    """Rows below a heading."""

    title: str
    rows: tuple[Row, ...]


@dataclass(frozen=True)
class Details:
    """What is shown of a node of the world's tree.

    Attributes:
        id: The node's.
        kind: The node's.
        name: The node's.
        entity: Its name in methods of the twin; of a joint or sensor its robot's.
        owner: The robot or model that it belongs to.
        edits: What can be done to the owner: ``Place``, ``Duplicate``, ``Remove``; and to the entity: ``Push``.
        xyz: Where the owner is in the world (m); zero of what cannot be placed.
        rpy: Its roll, pitch and yaw (rad).
        sections: The values.
    """

    id: str
    kind: str
    name: str
    entity: str
    owner: str
    edits: tuple[str, ...]
    xyz: Vector3
    rpy: Vector3
    sections: tuple[Section, ...]


def details(twin: Twin, node: Node) -> Details:
    """Return what there is to know about a node at the present time."""
    found = [section for section in _SECTIONS[node.kind](twin, node) if section.rows]
    edits = _edits(twin, node)
    xyz, rpy = pose_of(twin, node.owner) if edits else ((0.0, 0.0, 0.0), (0.0, 0.0, 0.0))
    return Details(node.id, node.kind, node.name, node.entity, node.owner, edits, xyz, rpy, tuple(found))


def _edits(twin: Twin, node: Node) -> tuple[str, ...]:
    plan = next((plan for plan in twin.built.plans if plan.name == node.owner), None)
    if plan is None and "::" in node.owner:
        return ()  # a sensor of a model inside another
    if plan is None:
        moves = node.owner != WORLD and bool(instances_of(twin, node.owner))
        return ("Place", "Duplicate", "Remove", *(("Push",) if moves else ())) if node.owner != WORLD else ()
    can_stand_elsewhere = not plan.description.base_joints
    return (*(("Place",) if can_stand_elsewhere else ()), "Duplicate", "Remove", "Push")


def pose_of(twin: Twin, entity: str) -> tuple[Vector3, Vector3]:
    """Return position (m) and roll, pitch, yaw (rad) of a robot or a model of the world, static ones included."""
    from pydrake.common.eigen_geometry import Quaternion

    models = () if twin.built.world_file is None else twin.built.world_file.models
    static = next((item.pose for item in models if item.name == entity and item.is_static), None)
    if static is not None:
        return static.xyz, static.rpy
    state = twin.entities.state(entity)
    w, x, y, z = np.array(state.orientation) / np.linalg.norm(state.orientation)
    roll, pitch, yaw = RollPitchYaw(Quaternion(w, x, y, z)).vector()
    return state.position, (float(roll), float(pitch), float(yaw))


def _robot(twin: Twin, node: Node) -> Iterator[Section]:
    plan = _plan(twin, node)
    yield _motion(twin, node.entity)
    mass = twin.plant.CalcTotalMass(twin.plant.GetMyContextFromRoot(twin.context), instances_of(twin, node.owner))
    base = "welded to the world" if plan.model.is_fixed else "free"
    yield Section(
        "Robot",
        (
            _number("Mass", "kg", mass),
            Row("Base", text=base),
            Row("File", text=plan.robot.model),
            *(Row(name, text=value) for name, value in plan.robot.xacro_args.items()),
        ),
    )
    states = twin.control.manager(plan.name).states
    yield Section(
        "Controllers",
        tuple(Row(item.name, text=f"{states.get(item.name) or 'unloaded'}, {item.type}") for item in plan.controllers),
    )
    own = (item for item in twin.graph.endpoints if item.robot == plan.name)
    yield Section("Topics and actions", tuple(Row(item.name, text=f"{item.kind}, {item.type}") for item in own))
    about = (finding for finding in twin.findings if finding.robot == plan.name)
    yield Section("Findings", tuple(Row(str(finding.kind), text=finding.sentence) for finding in about))


def _link(twin: Twin, node: Node) -> Iterator[Section]:
    yield _motion(twin, node.entity)
    body = _body(twin, node)
    context = twin.plant.GetMyContextFromRoot(twin.context)
    mass = body.get_mass(context)
    rows = [_number("Mass", "kg", mass)]
    if mass > 0 and isfinite(mass):
        inertia = body.CalcSpatialInertiaInBodyFrame(context)
        rows.append(_numbers("Center of mass", "m", inertia.get_com()))
        about_com = inertia.Shift(inertia.get_com()).CalcRotationalInertia()
        rows.append(_numbers("Moments of inertia", "kg·m²", about_com.get_moments()))
    yield Section("Mass", tuple(rows))
    yield _contact(item for item in twin.built.shapes if item.body == body.index())


def _joint(twin: Twin, node: Node) -> Iterator[Section]:
    plan = _plan(twin, node)
    joint = plan.description.joints_by_name[node.name]
    units = ("m", "m/s", "N") if joint.type == "prismatic" else ("rad", "rad/s", "N·m")
    state = twin.robot_state(plan.name)
    if joint.name in state.joints:
        index = state.joints.index(joint.name)
        values = (state.positions[index], state.velocities[index], state.efforts[index])
        labels = ("Position", "Velocity", "Effort")
        rows = (_number(label, unit, value) for label, unit, value in zip(labels, units, values, strict=True))
        yield Section("State", tuple(rows))
    yield Section("Joint", tuple(_joint_rows(joint, units)))
    claiming = [item for item in plan.controllers for claim in item.claims if claim.joint == joint.name]
    states = twin.control.manager(plan.name).states
    names = dict.fromkeys(item.name for item in claiming)
    yield Section("Controllers", tuple(Row(name, text=states.get(name) or "unloaded") for name in names))


def _joint_rows(joint: Joint, units: tuple[str, str, str]) -> Iterator[Row]:
    yield Row("Type", text=joint.type)
    yield Row("Links", text=f"{joint.parent} → {joint.child}")
    if not joint.is_movable:
        return
    yield _numbers("Axis", "", joint.axis)
    position, velocity, effort = units
    limits = joint.limits
    yield _number("Lowest position", position, limits.lower)
    yield _number("Highest position", position, limits.upper)
    yield _number("Greatest velocity", velocity, limits.velocity)
    yield _number("Greatest effort", effort, limits.effort)
    yield _number("Damping", f"{effort}·s/{position}", joint.damping)
    yield _number("Friction", effort, joint.friction)
    if joint.mimic is not None:
        yield Row("Follows", text=f"{joint.mimic.multiplier:g} · {joint.mimic.joint} + {joint.mimic.offset:g}")


def _sensor(twin: Twin, node: Node) -> Iterator[Section]:
    simulated = next(
        (item for owner, item in twin.entities.sensors if (owner, item.place) == (node.owner, node.name)), None
    )
    if simulated is None:
        sensor = next(item for item in _plan(twin, node).description.sensors if place_of(item) == node.name)
    else:
        sensor = simulated.sensor
    yield Section(
        "Sensor",
        (
            Row("Kind", text=sensor.kind),
            Row("Attached to", text=sensor.link or sensor.joint),
            _numbers("Position", "m", sensor.pose.xyz),
            _numbers("Roll, pitch, yaw", "rad", sensor.pose.rpy),
            Row("Rate", text="every step") if not sensor.update_rate else _number("Rate", "Hz", sensor.update_rate),
            Row("Simulated", text="no" if simulated is None else "yes"),
        ),
    )
    topics = () if simulated is None else simulated.topics
    yield Section("Topics", tuple(Row(item.topic or item.in_gazebo, text=item.type) for item in topics))


def _model(twin: Twin, node: Node) -> Iterator[Section]:
    assert twin.built.world_file is not None
    model = next(item for item in twin.built.world_file.models if item.name == node.name)
    if model.is_static:
        rows = (_numbers("Position", "m", model.pose.xyz), _numbers("Roll, pitch, yaw", "rad", model.pose.rpy))
        yield Section("Pose", rows)
        yield Section("Model", (Row("Moves", text="never: it is static"), Row("File", text=str(model.place))))
        own = (item for item in twin.built.shapes if not item.model and f"{model.name}/" in item.name)
        yield _contact(own)
    elif instances := instances_of(twin, node.owner):
        yield _motion(twin, node.entity)
        mass = twin.plant.CalcTotalMass(twin.plant.GetMyContextFromRoot(twin.context), instances)
        yield Section("Model", (_number("Mass", "kg", mass), Row("File", text=str(model.place))))
        bodies = {index for instance in instances for index in twin.plant.GetBodyIndices(instance)}
        yield _contact(item for item in twin.built.shapes if item.body in bodies)
    file = PurePath(twin.built.world_file.file or "").name
    about = [item for item in twin.findings if PurePath(item.file).name == file and model.name in item.what]
    yield Section("Findings", tuple(Row(str(finding.kind), text=finding.sentence) for finding in about))


def _light(twin: Twin, node: Node) -> Iterator[Section]:
    assert twin.built.world_file is not None
    light = twin.built.world_file.surroundings.lights[int(node.name.rpartition(" ")[2]) - 1]
    rows = [Row("Kind", text=light.kind), _numbers("Color", "", light.color), _number("Intensity", "", light.intensity)]
    if light.kind != "directional":
        rows.append(_numbers("Position", "m", light.position))
    if light.kind != "point":
        rows.append(_numbers("Direction", "", light.direction))
    yield Section("Light", tuple(rows))


def _ground(twin: Twin, _node: Node) -> Iterator[Section]:
    yield _contact(item for item in twin.built.shapes if isinstance(item.shape, HalfSpace))


_SECTIONS = {
    ROBOT: _robot,
    LINK: _link,
    JOINT: _joint,
    SENSOR: _sensor,
    MODEL: _model,
    LIGHT: _light,
    GROUND: _ground,
}


def _motion(twin: Twin, entity: str) -> Section:
    state = twin.entities.state(entity)
    xyz, rpy = pose_of(twin, entity)
    return Section(
        "Pose and twist in the world",
        (
            _numbers("Position", "m", xyz),
            _numbers("Roll, pitch, yaw", "rad", rpy),
            _numbers("Velocity", "m/s", state.linear),
            _numbers("Angular velocity", "rad/s", state.angular),
        ),
    )


def _contact(shapes: Iterable[TouchingShape]) -> Section:
    rows = (Row(_shape(item.shape), text=f"touches: {item.touches}; friction {item.friction:g}") for item in shapes)
    return Section("Collision shapes", tuple(rows))


def _shape(shape: Shape) -> str:
    """Return a shape in words, with its sizes (m)."""
    name = type(shape).__name__
    sizes = [size for size in ("width", "depth", "height", "radius", "length", "a", "b", "c") if hasattr(shape, size)]
    return f"{name} {' × '.join(f'{getattr(shape, size)():.4g}' for size in sizes)} m" if sizes else name


def _plan(twin: Twin, node: Node) -> RobotPlan:
    return next(plan for plan in twin.built.plans if plan.name == node.owner)


def _body(twin: Twin, node: Node) -> RigidBody:
    plant = twin.plant
    own = drake_link_name(node.name)
    return next(
        plant.GetBodyByName(own, instance)
        for instance in instances_of(twin, node.owner)
        if plant.HasBodyNamed(own, instance)
    )


def _number(label: str, unit: str, value: float) -> Row:
    return _numbers(label, unit, (value,)) if isfinite(value) else Row(label, text="none")


def _numbers(label: str, unit: str, values: Iterable[float]) -> Row:
    return Row(label, tuple(round(float(value), _DIGITS) + 0.0 for value in values), unit)
