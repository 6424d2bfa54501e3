"""What is in a twin's world: robots, models and links are read, spawned, deleted, put elsewhere, pushed and dragged."""

import logging
from collections.abc import Iterable, Mapping
from dataclasses import replace

import numpy as np

from drake_twin.diagram.contact_shapes import reach_of
from drake_twin.errors import InputError
from drake_twin.kinematics.state_layout import StateLayout
from drake_twin.messages import shortened
from drake_twin.planning.robot_plan import RobotPlan
from drake_twin.planning.sensor_plan import SensorPlan
from drake_twin.scenario import LONGEST_TIME, Robot, Scenario
from drake_twin.scenario.absolute_files import robot_with_files_found
from drake_twin.scenario.names import LONGEST_NAME
from drake_twin.systems.plant_reading import physics_step
from drake_twin.twin.entity_state import (
    EntityState,
    Wrench,
    entity_state,
    find_body,
    finite_numbers,
    make_wrench,
    set_entity_state,
    set_joint_positions,
)
from drake_twin.twin.group import Group
from drake_twin.twin.owner import any_thread
from drake_twin.twin.pull import PERIOD, make_pull
from drake_twin.twin.recording import recorded
from drake_twin.twin.session import Session
from drake_twin.values import is_number

_log = logging.getLogger(__name__)

_STILL = (0.0, 0.0, 0.0)


class Entities(Group, path="twin.entities"):
    """What is in the world: robots, its models, and their links (``robot_1::base_link``); `Twin.entities`."""

    @recorded("spawn", outside_callbacks="spawn")
    def spawn(self, robot: Robot, *, plan: RobotPlan | None = None) -> None:
        """Add a robot to the world; all others keep their state.

        Args:
            robot: The robot, as a scenario has it. Its controllers are active at once.
            plan: Its plan, if that was made before.

        Raises:
            InputError: If there is one of its name already, or its files cannot be used; nothing is changed then.
        """
        session = self._session
        if not isinstance(robot, Robot):
            raise InputError(f"{shortened(robot)} is not a Robot: make one with Robot(name, model)")
        if any(known.name == robot.name for known in session.scenario.robots):
            raise InputError(f"Entity [{robot.name}] already exists.")
        found = robot_with_files_found(robot, session.scenario.package_paths)
        scenario = replace(session.scenario, robots=(*session.scenario.robots, found))
        session.rebuild(scenario, () if plan is None else (plan,))
        session.sunk |= {robot.name: ()} | session.find_sunk((robot.name,))
        for finding in session.sunk[robot.name]:
            _log.warning("%s", finding)

    @recorded("delete", outside_callbacks="delete")
    def delete(self, robot: str) -> None:
        """Remove a robot with its topics and commands, or a model of the world; all others keep their state.

        Args:
            robot: The name of the robot or model.

        Raises:
            InputError: If the robot or model is unknown, or the robot is the last one.
        """
        session, scenario = self._session, self._session.scenario
        pushes = tuple(push for push in scenario.pushes if push.entity.partition("::")[0] != robot)
        if robot not in session.robots:
            _check_model(session, robot)
            world = scenario.world
            poses = {name: pose for name, pose in world.model_poses.items() if name != robot}
            if robot in world.model_copies:
                copies = {name: model for name, model in world.model_copies.items() if name != robot}
                world = replace(world, model_copies=copies, model_poses=poses)
            else:
                world = replace(world, without_models=(*world.without_models, robot), model_poses=poses)
            session.rebuild(replace(scenario, world=world, pushes=pushes))
            return
        kept = tuple(item for item in scenario.robots if item.name != robot)
        if not (kept or scenario.nodes or scenario.world.file):
            raise InputError(f"Entity [{robot}] is the last one: a twin needs at least one robot or a world.")
        commanded = session.built.commanded.values()
        own = {item.topic for item in commanded if item.robot == robot}
        own -= {item.topic for item in commanded if item.robot != robot}
        commands = tuple(command for command in scenario.commands if command.topic not in own)
        values = {name: value for name, value in scenario.values.items() if name.partition(".")[0] != robot}
        session.rebuild(replace(scenario, robots=kept, commands=commands, values=values, pushes=pushes))

    @property
    @any_thread
    def first_robots(self) -> tuple[str, ...]:
        """The names of the robots that the twin started with; the others have been spawned since."""
        return self._session.first_robots

    @property
    def sensors(self) -> tuple[tuple[str, SensorPlan], ...]:
        """The sensors that are simulated, each with its robot's name, or with that of its model of the world."""
        built = self._session.built
        of_robots = [(plan.name, item) for plan in built.plans for item in plan.sensors]
        return (*of_robots, *((model.name, item) for model in built.sensing_models for item in model.sensors))

    def state(self, entity: str, reference: str = "world") -> EntityState:
        """Return pose and twist of a robot, a model of the world, or a link (``robot_1::base_link``).

        Args:
            entity: Its name.
            reference: ``world``, or the entity whose frame they are in.

        Raises:
            InputError: If an entity is unknown.
        """
        return entity_state(self._session.built, self._session.physics.plant_context, entity, reference)

    @recorded("set_entity_state")
    def set_state(
        self,
        entity: str,
        position: Iterable[float] | None = None,
        orientation: Iterable[float] | None = None,
        linear: Iterable[float] | None = None,
        angular: Iterable[float] | None = None,
        reference: str = "world",
    ) -> None:
        """Move a robot or a moving model of the world at once and without forces; what is not given stays.

        Args:
            entity: Its name.
            position: x, y, z of its root link (m).
            orientation: Quaternion w, x, y, z.
            linear: Velocity (m/s).
            angular: Angular velocity (rad/s).
            reference: ``world``, or the entity whose frame all of it is in.

        Raises:
            InputError: If the entity is unknown or cannot be moved, or a value is invalid.
        """
        built, context = self._session.built, self._session.physics.plant_context
        set_entity_state(built, context, entity, position, orientation, linear, angular, reference)
        self._session.physics.detachable_joints.moved(entity)

    @recorded("place", outside_callbacks="rearrange")
    def place(self, entity: str, xyz: Iterable[float], rpy: Iterable[float] = (0.0, 0.0, 0.0)) -> None:
        """Put a robot or a model of the world elsewhere, at rest; also what is welded to the world or never moves.

        Joints keep their positions, and all others their state.

        Args:
            entity: Its name.
            xyz: The position of its root link, or of a static model, in the world (m).
            rpy: Roll, pitch and yaw (rad).

        Raises:
            InputError: If the entity is unknown or moves on driven joints, or a value is invalid.
        """
        from pydrake.math import RollPitchYaw

        session = self._session
        x, y, z = map(float, finite_numbers(xyz, 3, "position"))
        roll, pitch, yaw = map(float, finite_numbers(rpy, 3, "roll, pitch and yaw"))
        robots = {plan.name: plan for plan in session.built.plans}
        if entity not in robots:
            _check_model(session, entity)
        is_welded = entity in robots and robots[entity].model.is_fixed and not robots[entity].description.base_joints
        if is_welded or not (entity in robots or entity in session.built.world_models):
            session.rebuild(_moved(session.scenario, entity, (x, y, z), (roll, pitch, yaw)))
        else:
            orientation = RollPitchYaw(roll, pitch, yaw).ToQuaternion().wxyz()
            context = session.physics.plant_context
            set_entity_state(session.built, context, entity, (x, y, z), orientation, _STILL, _STILL)
        session.physics.detachable_joints.moved(entity)

    @recorded("copy_model", outside_callbacks="rearrange")
    def copy_model(self, model: str, name: str, xyz: Iterable[float], rpy: Iterable[float] = (0.0, 0.0, 0.0)) -> None:
        """Add a model like one of the world.

        Args:
            model: The name of a model of the world.
            name: The name of the new one.
            xyz: Its position in the world (m).
            rpy: Its roll, pitch and yaw (rad).

        Raises:
            InputError: If the model is unknown, the name is taken or no name, or a value is invalid.
        """
        session, world = self._session, self._session.scenario.world
        pose = (*finite_numbers(xyz, 3, "position"), *finite_numbers(rpy, 3, "roll, pitch and yaw"))
        _check_model(session, model)
        assert session.built.world_file is not None
        if not isinstance(name, str) or "::" in name or not (0 < len(name) <= LONGEST_NAME and name.isprintable()):
            text = f"{shortened(name)} cannot name a model: use 1 to {LONGEST_NAME} printable characters without '::'"
            raise InputError(text)
        if name in (*session.robots, *(item.name for item in session.built.world_file.models), *world.without_models):
            raise InputError(f"Entity [{name}] already exists.")
        x, y, z, roll, pitch, yaw = map(float, pose)
        copies = {**world.model_copies, name: world.model_copies.get(model, model)}
        poses = {**world.model_poses, name: (x, y, z, roll, pitch, yaw)}
        session.rebuild(replace(session.scenario, world=replace(world, model_copies=copies, model_poses=poses)))

    @recorded("apply_wrench")
    def apply_wrench(
        self,
        entity: str,
        force: Iterable[float] = (0.0, 0.0, 0.0),
        torque: Iterable[float] = (0.0, 0.0, 0.0),
        duration: float = 0.0,
        reference: str = "world",
        at: Iterable[float] = (0.0, 0.0, 0.0),
    ) -> None:
        """Push a link for a while; force times duration is the impulse (N·s).

        Args:
            entity: A link, or a robot or model for its root link.
            force: N, in the axes that ``reference`` has now.
            torque: N·m, likewise.
            duration: How long (simulated s); one step at least.
            reference: ``world``, or an entity.
            at: The point of the link at which the force acts, in the link's frame (m).

        Raises:
            InputError: If an entity is unknown, or a value is invalid.
        """
        session, until = self._session, self._end(duration)
        context = session.physics.plant_context
        wrench = make_wrench(session.built, context, entity, force, torque, until, reference, at)
        if (what := _passes_walls(session, wrench)) is not None:
            _log.warning("%s", what)
        session.wrenches.drop_ended(session.clock.time)
        session.wrenches.put((*session.wrenches.items, wrench))

    @recorded("drag")
    def drag(
        self,
        entity: str,
        target: Iterable[float],
        at: Iterable[float] = (0.0, 0.0, 0.0),
        duration: float = LONGEST_TIME,
        stiffness: float | None = None,
    ) -> None:
        """Draw a point of a link to a point of the world with a damped spring, in place of the one that draws it now.

        The spring's force follows the motion every 5 ms of simulated time, and is constant in between.

        Args:
            entity: A link, or a robot or model for its root link.
            target: Where to draw it to, in the world (m).
            at: The point of the link, in the link's frame (m).
            duration: How long (simulated s); until `release` by default.
            stiffness: N/m. By default the spring and the robot's or model's whole mass have 10 rad/s, or less where the
                link is so light that this would be unstable. The damping is critical.

        Raises:
            InputError: If the entity is unknown or fixed to the world, or a value is invalid.
        """
        session, until = self._session, self._end(duration)
        clock, wrenches, context = session.clock, session.wrenches, session.physics.plant_context
        known = next((item for item in wrenches.pulls if item.entity == str(entity)), None)
        period = clock.steps(PERIOD) * clock.time_step
        pull = make_pull(session.built, context, entity, target, at, until, stiffness, period, known)
        wrenches.drop_ended(clock.time)
        wrenches.put([*(item for item in wrenches.items if item is not known), pull])

    @recorded("release")
    def release(self, entity: str) -> None:
        """End what `drag` began; nothing happens if nothing draws the entity."""
        self._session.wrenches.release(str(entity))

    @recorded("set_joint_positions")
    def set_joint_positions(self, robot: str, positions: Mapping[str, float]) -> None:
        """Set joint positions at once, without forces: servos hold them, mimic joints follow, velocities stay.

        Args:
            robot: The robot's name.
            positions: Joint name → position (rad or m).

        Raises:
            InputError: If the robot or a joint is unknown, or a position is not a finite number.
        """
        session = self._session
        set_joint_positions(session.built, session.physics.plant_context, session.plan(robot), positions)
        session.physics.detachable_joints.moved(robot)
        session.controls[robot].release(positions)

    @recorded("set_values", outside_callbacks="change")
    def set_values(self, values: Mapping[str, float]) -> None:
        """Set parameters of the plant at once, as the scenario would with these ``values`` beside its own.

        `Twin.reset` takes them back; all other parameters become the scenario's. Servo gains stay as they are.

        Args:
            values: Name → value, as in `Scenario`.

        Raises:
            InputError: If a value is unknown or invalid; nothing is changed then.
        """
        self._session.physics.set_values({**self._session.scenario.values, **values})

    def start_positions(self, robot: str) -> Mapping[str, float]:
        """Return the position of each movable joint at the start (rad or m).

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.plan(robot).joints.start_positions

    def state_layout(self, robot: str) -> StateLayout:
        """Return where joints and base stand in `state_vector`; it lives as long as `Twin.diagram`.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.built.robots[self._session.plan(robot).name].layout

    def state_vector(self, robot: str) -> np.ndarray:
        """Return a robot's positions and velocities ``[q; v]``, as Drake has them: the fastest way to read them.

        Raises:
            InputError: If the robot is unknown.
        """
        return self._session.physics.robot_state(self._session.plan(robot).name)

    def _end(self, duration: float) -> float:
        if not is_number(duration) or duration < 0:
            raise InputError(f"invalid duration {duration!r} s: it must be a number from zero up")
        clock = self._session.clock
        return min(clock.time + max(float(duration), clock.time_step), LONGEST_TIME)


def _moved(
    scenario: Scenario, entity: str, xyz: tuple[float, float, float], rpy: tuple[float, float, float]
) -> Scenario:
    """Return a scenario in which a robot, or a model of the world, starts elsewhere."""
    if any(robot.name == entity for robot in scenario.robots):
        robots = (replace(item, xyz=xyz, rpy=rpy) if item.name == entity else item for item in scenario.robots)
        return replace(scenario, robots=tuple(robots))
    poses = {**scenario.world.model_poses, entity: (*xyz, *rpy)}
    return replace(scenario, world=replace(scenario.world, model_poses=poses))


def _check_model(session: Session, entity: str) -> None:
    """Raise `InputError` if the world has no model of the name."""
    models = [] if session.built.world_file is None else [model.name for model in session.built.world_file.models]
    if entity not in models:
        valid = [*session.robots, *models]
        raise InputError(f"Entity [{entity}] does not exist.", value=str(entity), valid=valid)


def _passes_walls(session: Session, wrench: Wrench) -> str | None:
    """Say so if a force moves a robot or model in a step by more than it is thick: contact does not see that way."""
    built, context = session.built, session.physics.plant_context
    body, step, force = find_body(built, wrench.entity), physics_step(built.plant), float(np.linalg.norm(wrench.force))
    shapes = [shape.shape for shape in built.shapes if shape.body == body.index()]
    mass = built.plant.CalcTotalMass(context, [body.model_instance()])
    if step == 0.0 or not shapes or mass <= 0.0:  # CENIC takes shorter steps
        return None
    way = force / mass * step**2
    thinnest = min(reach_of(shape, axis) + reach_of(shape, -axis) for shape in shapes for axis in np.eye(3))
    if way <= thinnest / 2:
        return None
    moves = f"{force:g} N move {mass:.3g} kg by {1e3 * way:.3g} mm in a step of {1e3 * step:g} ms"
    return f"{wrench.entity}: {moves}: it may pass through walls (a shorter time_step and engine cenic do not let it)"
