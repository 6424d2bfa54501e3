"""The one MultibodyPlant and SceneGraph of a twin: the world, the robots, their actuators and start positions."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import TYPE_CHECKING

import numpy as np
from pydrake.geometry import SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlant, MultibodyPlantConfig
from pydrake.multibody.tree import BodyIndex, ModelInstanceIndex, PrismaticSpring, RevoluteSpring
from pydrake.systems.framework import DiagramBuilder

from drake_twin.controllers.base_controller import MovesSurfaces
from drake_twin.controllers.registry import controller_class
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_log import DRAKE_RAISES, captured_warnings, reason_of, without_literal
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.fixed_joint_lumping import lumped_links
from drake_twin.description.gazebo_drive import ROLLER_WHEELS
from drake_twin.description.robot_description import Joint, Pose
from drake_twin.description.xml_reader import XmlReader
from drake_twin.diagram.ball_joints import add_sdf_models
from drake_twin.diagram.contact import TouchingShape, give_contact
from drake_twin.diagram.contact_models import ContactModel
from drake_twin.diagram.detachable_joints import JointInPlant, add_detachable_joints
from drake_twin.diagram.joint_friction import FRICTION_SUFFIX, Brake, add_brake, can_have_brake, isolate_brakes
from drake_twin.diagram.lumped_masses import with_lumped_masses
from drake_twin.diagram.planar_base import add_planar_joints, limit_planar_efforts, planar_base
from drake_twin.diagram.servo_gains import ServoGains, servo_gains
from drake_twin.diagram.world_in_plant import add_world, remove_actuators
from drake_twin.errors import InputError
from drake_twin.findings import Finding, Kind
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.progress import told
from drake_twin.scenario import CENIC, Scenario, World
from drake_twin.systems.plant_reading import PlantPorts, held

if TYPE_CHECKING:
    from drake_twin.control.submerged import Solid
    from drake_twin.description.world_file import WorldFile

# A sticking contact creeps at a fraction of this (m/s). With Drake's 1e-4 a box creeps 1.4 mm in 5 s at 0.95 of the
# angle of friction.
_STICTION_TOLERANCE = 1e-5


@dataclass(frozen=True)
class RobotInPlant:
    """A robot in the plant.

    Attributes:
        instance: Its model instance.
        layout: The indices of its joints in its model instance's state.
        layout_in_plant: The indices of its joints in the plant's state.
        gains: The gains of its actuators; None for one that models joint friction.
        places: The index in `Reading.with_efforts` of each element of its state, then of its efforts, then of NaN
            and 0.
    """

    instance: ModelInstanceIndex
    layout: StateLayout
    layout_in_plant: StateLayout
    gains: tuple[ServoGains | None, ...]
    places: tuple[int, ...]


@dataclass(frozen=True)
class PlantOfTwin:
    """The finalized plant, everything needed to wire robots to it, and the warnings of Drake's parser.

    ``world_models`` are the model instances of each moving model of the world that is not a robot, ``anchors`` the
    poses in the world of the frames of each static one that has sensors, ``shapes`` the contact of all collision
    shapes, ``detachable_joints`` the joints that come and go, ``solids`` the collision shapes of each body that have
    a volume, where plugins of the world need them.
    """

    plant: MultibodyPlant
    scene_graph: SceneGraph
    robots: dict[str, RobotInPlant]
    findings: tuple[Finding, ...]
    world_models: dict[str, tuple[ModelInstanceIndex, ...]]
    anchors: dict[str, dict[str, RigidTransform]]
    shapes: tuple[TouchingShape, ...]
    detachable_joints: tuple[JointInPlant, ...]
    ports: PlantPorts
    solids: "Mapping[BodyIndex, tuple[Solid, ...]]"

    def has_model(self, name: str) -> bool:
        """Tell whether a model of the world, or one inside another, is not left out."""
        return name in self.anchors or self.plant.HasModelInstanceNamed(name)


def add_plant(
    builder: DiagramBuilder,
    scenario: Scenario,
    plans: Sequence[RobotPlan],
    world_file: "WorldFile | None" = None,
    known_gains: Mapping[str, tuple[ServoGains | None, ...]] | None = None,
    *,
    sampled_output_ports: bool = False,
    holds_state: bool = False,
) -> PlantOfTwin:
    """Add the plant (named ``plant``) and the scene graph (named ``scene_graph``) to a diagram.

    Args:
        builder: The root diagram's builder.
        scenario: The world and the step.
        plans: The robots, in the scenario's order.
        world_file: The content of the scenario's world file.
        known_gains: Robot → the gains of its actuators, if they were calculated before.
        sampled_output_ports: Whether the plant's ports keep the values of the last step, as is Drake's default. Then
            every step is an unrestricted update, for which Drake copies the state of all systems twice and asks each
            for its witness functions: a tenth to a fifth of a step with 8 robots. A port that is computed from the
            present state shares its solution with the step that follows.
        holds_state: Whether the plant only holds the state of robots that are stepped elsewhere.

    Raises:
        InputError: If a robot has the name of a model of the world, or Drake refuses a robot (with Drake's reason).
    """
    step = 0.0 if scenario.engine == CENIC else scenario.time_step
    config = MultibodyPlantConfig(
        time_step=held(step) if holds_state else step,
        use_sampled_output_ports=(sampled_output_ports or holds_state) and scenario.engine != CENIC,
        contact_model="hydroelastic_with_fallback",
        contact_surface_representation="polygon",
        discrete_contact_approximation=scenario.contact_approximation,
        stiction_tolerance=_STICTION_TOLERANCE,
    )
    plant, scene_graph = AddMultibodyPlant(config, builder)
    findings: list[Finding] = []
    world_models, anchors = add_world(plant, scenario, world_file, findings)
    instances = {}
    for plan in told("adding", plans, lambda plan: plan.name):
        with _drakes_refusal(f"robot {plan.name!r}", plan):
            instances[plan.name] = _add_robot(plant, plan, findings)
    layouts = {}
    with _drakes_refusal(f"to simulate {', '.join(repr(plan.name) for plan in plans)}"):
        models = _contact_models(plans, instances, scenario.world, world_models)
        warnings: list[str] = []
        solids: Mapping[BodyIndex, tuple[Solid, ...]] = {}
        if world_file is not None and world_file.forces:
            from drake_twin.diagram.solids import solids_of

            solids = solids_of(plant, scene_graph)
        shapes = give_contact(plant, scene_graph, models, scenario.world.contact, warnings)
        findings += [Finding(Kind.WARNING, warning) for warning in warnings]
        detachable = add_detachable_joints(plant, plans, instances, world_models, findings)
        brakes = [brake for plan in plans for brake in _add_brakes(plant, plan, instances[plan.name])]
        plant.Finalize()
        isolate_brakes(scene_graph, brakes)
        for plan in plans:
            layouts[plan.name] = _state_layout(plant, instances[plan.name], plan)
            _set_start(plant, instances[plan.name], plan, layouts[plan.name])
            if plan.description.base_joints:
                limit_planar_efforts(plant, scene_graph, instances[plan.name], _grip(plan))
        gains = servo_gains(plant, [(plan, instances[plan.name], layouts[plan.name]) for plan in plans], known_gains)
    robots = {
        name: RobotInPlant(
            instance,
            layout,
            layout.within(_state_indices(plant, instance)),
            gains[name],
            _places_in_readings(plant, instance),
        )
        for (name, instance), layout in zip(instances.items(), layouts.values(), strict=True)
    }
    elsewhere = None
    if holds_state:
        from drake_twin.systems.steps_elsewhere import StepsElsewhere

        elsewhere = builder.AddNamedSystem("steps_elsewhere", StepsElsewhere(plant, instances))
        builder.Connect(plant.get_state_output_port(), elsewhere.GetInputPort("state"))
    ports = PlantPorts(plant, elsewhere)
    return PlantOfTwin(
        plant, scene_graph, robots, tuple(findings), world_models, anchors, shapes, detachable, ports, solids
    )


@contextmanager
def _drakes_refusal(what: str, plan: RobotPlan | None = None) -> Iterator[None]:
    """Convert what Drake raises to an error for the user; some of its checks raise SystemExit."""
    try:
        yield
    except DRAKE_RAISES as error:
        refused = InputError(
            f"Drake refuses {what}: {reason_of(error)}", file=None if plan is None else plan.description.file
        )
        if plan is not None and plan.model.drake_format == "sdf":
            from drake_twin.description.sdf_values import with_place

            refused = with_place(refused, XmlReader(plan.description.text, plan.description.file))
        raise refused from None


def _add_robot(plant: MultibodyPlant, plan: RobotPlan, findings: list[Finding]) -> ModelInstanceIndex:
    with captured_warnings() as messages:
        (instance,) = parse_robot(plant, plan)
    texts = [*map(without_literal, messages), *_of_ball_joints(plan)]
    _give_surfaces(plant, plan, instance)
    remove_actuators(plant, [instance])  # here only commanded joints have one
    plant.set_gravity_enabled(instance, plan.model.falls)
    bodies = [plant.get_body(index) for index in plant.GetBodyIndices(instance)]
    stays = plan.model.is_fixed or not plan.model.falls
    if not stays and not any(plant.GetCollisionGeometriesForBody(body) for body in bodies):
        texts.append("the robot has no collision shape: it falls through the ground")
    for text in texts:
        is_lost = plan.model.drake_format == "xml" and "will be ignored" in text  # words of Drake's parser
        kind = Kind.IGNORED if is_lost else Kind.WARNING
        findings.append(Finding(kind, text, robot=plan.name, file=str(plan.description.file or "")))
    if plan.description.base_joints:
        add_planar_joints(plant, plant.GetBodyByName(plan.model.root_body, instance), plan.spawn_pose)
    for joint in plan.description.actuated_joints:
        moved = plant.GetJointByName(joint.name, instance)
        actuator = plant.AddJointActuator(joint.name, moved, joint.limits.effort)
        if joint.armature:
            actuator.set_default_rotor_inertia(joint.armature)
    for joint in plan.description.movable_joints:
        if joint.stiffness:
            spring = PrismaticSpring if joint.type == "prismatic" else RevoluteSpring
            moved = plant.GetJointByName(joint.name, instance)
            plant.AddForceElement(spring(moved, joint.rest_position, joint.stiffness))
    for joint in plan.friction_joints:
        if not _is_braked(plant, plan, instance, joint):
            name = f"{joint.name}{FRICTION_SUFFIX}"
            brake = plant.AddJointActuator(name, plant.GetJointByName(joint.name, instance), joint.friction)
            if joint.armature and joint in plan.description.actuated_joints:
                brake.set_default_rotor_inertia(joint.armature)  # Drake uses that of a joint's last actuator alone
    if plan.model.is_fixed:
        root = plant.GetBodyByName(plan.model.root_body, instance)
        plant.WeldFrames(plant.world_frame(), root.body_frame(), plan.spawn_pose.transform())
    return instance


def _give_surfaces(plant: MultibodyPlant, plan: RobotPlan, instance: ModelInstanceIndex) -> None:
    """Give a robot's links the surfaces that its controllers move."""
    for item in plan.controllers:
        kind = None if item.problem is not None else controller_class(item.type)
        if kind is None or not issubclass(kind, MovesSurfaces):
            continue
        for link, axis in kind.surfaces(item.parameters).items():
            plant.SetSurfaceVelocityAxis(plant.GetBodyByName(drake_link_name(link), instance), np.array(axis))


def _is_braked(plant: MultibodyPlant, plan: RobotPlan, instance: ModelInstanceIndex, joint: Joint) -> bool:
    """Return whether a joint with dry friction has a brake; else it has an actuator for it."""
    has_motor = joint in plan.description.actuated_joints
    return plant.time_step() == 0.0 and has_motor and can_have_brake(plant.GetJointByName(joint.name, instance))


def _add_brakes(plant: MultibodyPlant, plan: RobotPlan, instance: ModelInstanceIndex) -> list[Brake]:
    return [
        add_brake(plant, plant.GetJointByName(joint.name, instance), joint.friction)
        for joint in plan.friction_joints
        if _is_braked(plant, plan, instance, joint)
    ]


def parse_robot(plant: MultibodyPlant, plan: RobotPlan) -> list[ModelInstanceIndex]:
    """Add a robot as Drake's parser reads its model."""
    model, description = plan.model, plan.description
    if model.drake_format != "sdf":
        is_lumped = model.drake_format == "urdf" and plant.time_step() == 0.0
        text = with_lumped_masses(model.drake_text) if is_lumped else model.drake_text
        return list(Parser(plant).AddModelsFromString(text, model.drake_format))
    try:
        return add_sdf_models(plant, model.drake_text)
    except InputError as error:
        reader = XmlReader(description.text, description.file)
        lines = (reader.place(joint).line for joint in reader.root.iter("joint") if joint.get("name") == error.value)
        what = f"robot {plan.name!r}: {error.message}"
        raise InputError(what, file=description.file, line=next(lines, None)) from None


def _of_ball_joints(plan: RobotPlan) -> Iterator[str]:
    """Yield the features that do not work with a robot's ball joints."""
    balls = [joint.name for joint in plan.description.joints if joint.type == "ball"]
    if plan.model.drake_format != "sdf":
        for name in balls:
            yield f"ball joint {name}: the run ends at a pitch of 90°, because the joint does not come from an SDF file"
    for sensor in plan.description.sensors:
        if sensor.joint in balls:
            yield f"sensor {sensor.name}: it cannot measure in the ball joint {sensor.joint}"


def _contact_models(
    plans: Sequence[RobotPlan],
    instances: Mapping[str, ModelInstanceIndex],
    world: World,
    world_models: Mapping[str, tuple[ModelInstanceIndex, ...]],
) -> list[ContactModel]:
    """Return the models that touch: the robots and the world's moving models."""
    robots = [
        ContactModel(
            plan.name,
            (instances[plan.name],),
            plan.robot.contact,
            plan.spawn_pose.transform(),
            colliding := _colliding_links(plan),
            plan.robot.friction,
            folded={} if colliding == set() else _folded(plan),
        )
        for plan in plans
    ]
    return [*robots, *(ContactModel(name, every, world.contact) for name, every in world_models.items())]


def _folded(plan: RobotPlan) -> dict[str, str]:
    """Return body → the body into which Gazebo folds it."""
    if plan.model.drake_format != "urdf":
        return {}
    folded = lumped_links(XmlReader(plan.description.text).root)
    return {drake_link_name(link): drake_link_name(into) for link, into in folded.items()}


def _colliding_links(plan: RobotPlan) -> set[str] | None:
    """Return the links of a robot that touch others of it, as Drake calls them; None for all."""
    if plan.robot.self_collision is not None:
        return None if plan.robot.self_collision else set()
    return {drake_link_name(link) for link, surface in plan.description.surfaces.items() if surface.self_collide}


def _state_indices(plant: MultibodyPlant, instance: ModelInstanceIndex) -> list[int]:
    """Return the index in the plant's state of each element of an instance's ``[q; v]``."""
    positions = plant.GetPositionsFromArray(instance, np.arange(plant.num_positions()))
    velocities = plant.GetVelocitiesFromArray(instance, np.arange(plant.num_velocities()))
    return [*positions.astype(int).tolist(), *(plant.num_positions() + velocities.astype(int)).tolist()]


def _places_in_readings(plant: MultibodyPlant, instance: ModelInstanceIndex) -> tuple[int, ...]:
    first, last = plant.num_multibody_states(), plant.num_multibody_states() + plant.num_actuators()
    actuators = [plant.get_joint_actuator(index) for index in plant.GetJointActuatorIndices(instance)]
    return (*_state_indices(plant, instance), *(first + item.input_start() for item in actuators), last, last + 1)


def _grip(plan: RobotPlan) -> float | None:
    """Return how strongly a base on wheels with friction in one direction grips, relative to its weight."""
    rollers = [controller for controller in plan.controllers if controller.type == ROLLER_WHEELS]
    if not rollers:
        return None
    parameters = rollers[0].parameters
    sides = [abs(x) + abs(y) for x, y in zip(parameters.direction_x, parameters.direction_y, strict=True)]
    return float(parameters.friction * 0.5 * np.mean(sides))


def _state_layout(plant: MultibodyPlant, instance: ModelInstanceIndex, plan: RobotPlan) -> StateLayout:
    places = {index: place for place, index in enumerate(_state_indices(plant, instance))}
    nq = plant.num_positions()
    named = (*plan.description.movable_joints, *plan.description.base_joints)
    joints = {joint.name: plant.GetJointByName(joint.name, instance) for joint in named}
    actuators = [plant.get_joint_actuator(index) for index in plant.GetJointActuatorIndices(instance)]
    root = plant.GetBodyByName(plan.model.root_body, instance)
    floats = root.is_floating_base_body()
    return StateLayout(
        size=len(places),
        positions={name: places[joint.position_start()] for name, joint in joints.items()},
        velocities={name: places[nq + joint.velocity_start()] for name, joint in joints.items()},
        efforts={
            actuator.joint().name(): index
            for index, actuator in enumerate(actuators)
            if not actuator.name().endswith(FRICTION_SUFFIX)
        },
        num_actuators=len(actuators),
        base_position=places[root.floating_positions_start()] if floats else None,
        base_velocity=places[nq + root.floating_velocities_start_in_v()] if floats else None,
        planar_base=planar_base(plant, instance, plan.spawn_pose) if plan.description.base_joints else None,
    )


def _set_start(plant: MultibodyPlant, instance: ModelInstanceIndex, plan: RobotPlan, layout: StateLayout) -> None:
    """Make the spawn pose and the start positions the defaults of every new context."""
    q = plant.GetDefaultPositions(instance)
    for name, position in plan.joints.start_positions.items():
        q[layout.positions[name]] = position
    free = {} if layout.base_position is None else {layout.base_position: plan.spawn_pose}
    every = plant.GetPositionsFromArray(instance, np.arange(plant.num_positions())).tolist()
    for link, pose in plan.description.loose_links.items():
        start = plant.GetBodyByName(drake_link_name(link), instance).floating_positions_start()
        free[every.index(start)] = Pose(plan.robot.xyz, plan.robot.rpy).compose(pose)
    for position, pose in free.items():
        X_WB = pose.transform()
        q[position:][:4] = X_WB.rotation().ToQuaternion().wxyz()
        q[position:][4:7] = X_WB.translation()
    plant.SetDefaultPositions(instance, q)
