"""A plant of its own for a few robots and models, with places that any mover of a kind can take."""

from collections.abc import Hashable, Mapping, Sequence

import numpy as np
from pydrake.common.value import Value
from pydrake.geometry import FilterId, GeometryId, SceneGraph, SceneGraphInspector
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.analysis import InitializeParams, Simulator
from pydrake.systems.framework import BusValue, Diagram, DiagramBuilder, FixedInputPortValue

from drake_twin.diagram.applied_forces import join_forces, wrench_port
from drake_twin.diagram.detachable_joints import JointInPlant
from drake_twin.diagram.gyroscopic_moments import add_gyroscopic_moments
from drake_twin.diagram.plant import PlantOfTwin
from drake_twin.diagram.release import release
from drake_twin.islands.mover import Mover, Places, places_of

_QUIET = InitializeParams(suppress_initialization_events=True)


class Island:
    """A plant with a place for each of some movers.

    Args:
        diagram: The diagram of the plant, its scene graph and the moments of tumbling bodies.
        models: The movers that it is built of; each place takes a mover of the same kind.
        places: The place of each.
        detachable_joints: Its joints that come and go.

    Attributes:
        diagram: The diagram.
        plant: Its plant.
        scene_graph: Its scene graph.
        models: The movers that it is built of.
        places: The place of each.
        detachable_joints: Its joints that come and go.
        members: The number of the mover in each place.
    """

    def __init__(
        self,
        diagram: Diagram,
        models: Sequence[Mover],
        places: Sequence[Places],
        detachable_joints: tuple[JointInPlant, ...] = (),
    ):
        plant, scene_graph = (diagram.GetSubsystemByName(name) for name in ("plant", "scene_graph"))
        assert isinstance(plant, MultibodyPlant)
        assert isinstance(scene_graph, SceneGraph)
        self.diagram, self.plant, self.scene_graph = diagram, plant, scene_graph
        self.models, self.places = tuple(models), tuple(places)
        self.detachable_joints = detachable_joints
        self.simulator = Simulator(diagram)
        self.context = self.simulator.get_mutable_context()
        self.plant_context = plant.GetMyMutableContextFromRoot(self.context)
        self._pushes = wrench_port(diagram, plant)
        self.members: tuple[int, ...] = ()
        self._held: dict[tuple[str, str], tuple[tuple[float, ...], FilterId | None]] = {}
        self._state = np.concatenate([places.state for places in self.places])
        self._whole = np.empty(plant.num_multibody_states())
        self._desired: list[FixedInputPortValue | None] = []
        self._actuation: list[FixedInputPortValue | None] = []
        for own in self.places:
            count = len(own.actuators)
            desired = actuation = None
            if count:
                (instance,) = own.instances
                desired = plant.get_desired_state_input_port(instance).FixValue(self.plant_context, np.zeros(2 * count))
                actuation = plant.get_actuation_input_port(instance).FixValue(self.plant_context, np.zeros(count))
            self._desired.append(desired)
            self._actuation.append(actuation)
        self._generalized = plant.get_applied_generalized_force_input_port()
        self._given: dict[Hashable, bytes] = {}  # the values that inputs have
        self.push(())

    def take(self, members: Sequence[int], state: np.ndarray, time: float) -> None:
        """Let movers take the places, in their order.

        Args:
            members: The movers' numbers.
            state: Their ``[q; v]``, one after the other.
            time: The time (s), a multiple of the step.
        """
        self.members = tuple(members)
        self._whole[self._state] = state
        self.plant_context.SetDiscreteState(self._whole)
        self.context.SetTime(time)
        self.simulator.Initialize(_QUIET)

    def state(self) -> np.ndarray:
        """Return the ``[q; v]`` of the members, one after the other."""
        state: np.ndarray = self.plant.GetPositionsAndVelocities(self.plant_context)[self._state]
        return state

    def command(self, place: int, desired: np.ndarray, actuation: np.ndarray, *, is_moved: bool) -> None:
        """Set the set-points of the servos in a place (``[q_d; v_d]``), and the efforts added to them.

        What is as it was is not set: a step would be solved twice, once for who reads its efforts.

        Args:
            place: The place.
            desired: The set-points.
            actuation: The efforts.
            is_moved: Whether the motors have other gains, of which the solution of the step does not know.
        """
        inputs = ("desired", self._desired, desired), ("actuation", self._actuation, actuation)
        for name, ports, values in inputs:
            if (port := ports[place]) is not None and self._is_new((name, place), values, is_moved=is_moved):
                port.GetMutableData().get_mutable_value().SetFromVector(values)

    def push(self, forces: Sequence[tuple[BodyIndex, ExternallyAppliedSpatialForce]]) -> None:
        """Apply forces to bodies, and no others.

        Args:
            forces: The body here, and the force with the body's index elsewhere.
        """
        numbers = [
            (float(index), *given.p_BoBq_B, *given.F_Bq_W.rotational(), *given.F_Bq_W.translational())
            for index, given in forces
        ]
        if not self._is_new("pushes", np.array(numbers)):
            return
        own = []
        for index, given in forces:
            force = ExternallyAppliedSpatialForce()
            force.body_index, force.p_BoBq_B = index, given.p_BoBq_B
            force.F_Bq_W = SpatialForce(tau=given.F_Bq_W.rotational(), f=given.F_Bq_W.translational())
            own.append(force)
        self._pushes.FixValue(self._pushes.get_system().GetMyMutableContextFromRoot(self.context), own)

    def drive(self, forces: np.ndarray, first: int, elsewhere: Sequence[Places]) -> None:
        """Apply generalized forces, given in the order of another plant.

        Args:
            forces: The forces.
            first: The place of the first velocity in that plant's state.
            elsewhere: The members' places there.
        """
        nq, own = self.plant.num_positions(), np.zeros(self.plant.num_velocities())
        for places, there in zip(self.places, elsewhere, strict=True):
            is_velocity = places.state >= nq
            own[places.state[is_velocity] - nq] = forces[there.state[is_velocity] - first]
        if self._is_new("generalized", own):
            self._generalized.FixValue(self.plant_context, own)

    def move_surfaces(self, speeds: Mapping[str, float]) -> None:
        """Move the surfaces of bodies at these speeds (m/s), by their scoped names."""
        if self._is_new("surfaces", np.array(list(speeds.values()))):
            bus = BusValue()
            for name, speed in speeds.items():
                bus.Set(name, Value(speed))
            self.plant.get_surface_speeds_input_port().FixValue(self.plant_context, Value(bus))

    def _is_new(self, what: Hashable, values: np.ndarray, *, is_moved: bool = False) -> bool:
        """Tell whether an input has other values than it was given the last time, and note these."""
        is_same = what in self._given and self._given[what] == values.tobytes()
        self._given[what] = values.tobytes()
        return is_moved or not is_same

    def follow_motors(self, place: int, plant: MultibodyPlant, elsewhere: Places) -> bool:
        """Give the motors in a place the gains and limits that they have in another plant; return if they differ."""
        is_moved = False
        for own_instance, instance in zip(self.places[place].instances, elsewhere.instances, strict=True):
            motors = zip(
                self.plant.GetJointActuatorIndices(own_instance), plant.GetJointActuatorIndices(instance), strict=True
            )
            for number, (own_index, index) in enumerate(motors):
                own, other = self.plant.get_joint_actuator(own_index), plant.get_joint_actuator(index)
                gains = other.get_controller_gains() if other.has_controller() else None
                limit = other.effort_limit()
                values = np.array([limit] if gains is None else [limit, gains.p, gains.d])
                if self._is_new(("motor", int(own_instance), number), values):
                    is_moved = True
                    if gains is not None:
                        own.set_controller_gains(gains)
                    own.set_effort_limit(limit)
        return is_moved

    def attach(self, poses: Mapping[tuple[str, str], tuple[float, ...]]) -> None:
        """Let the joints that come and go hold their children at these poses (3×4, row by row), or let them go."""
        for joint in self.detachable_joints:
            name = joint.robot, joint.controller
            pose, before = poses.get(name, ()), self._held.get(name)
            if before is None or before[0] != pose:
                X_PC = RigidTransform(np.array(pose).reshape(3, 4)) if pose else None
                known = None if before is None else before[1]
                self._held[name] = pose, joint.hold(self.plant, self.scene_graph, self.context, X_PC, known)

    def advance_to(self, time: float) -> None:
        """Step to a time (s)."""
        self.simulator.AdvanceTo(time)

    def discard(self) -> None:
        """Release the diagram, so that its memory can be freed; once, for what is released may be gone."""
        if "diagram" in self.__dict__:
            release([self.simulator, self.diagram])
            self.__dict__.clear()

    def __del__(self) -> None:  # of a twin that was dropped and not closed
        self.discard()

    def bodies(self, plant: MultibodyPlant, elsewhere: Sequence[Places]) -> dict[BodyIndex, BodyIndex]:
        """Return each body here → the same one in another plant, in which the members have these places."""
        found = {
            here: index
            for places, there in zip(self.places, elsewhere, strict=True)
            for here, index in zip(places.bodies, there.bodies, strict=True)
        }
        for body in map(self.plant.get_body, map(BodyIndex, range(self.plant.num_bodies()))):
            if body.index() not in found:  # what does not move: the world, and all of its static shapes
                instance = plant.GetModelInstanceByName(self.plant.GetModelInstanceName(body.model_instance()))
                found[body.index()] = plant.GetBodyByName(body.name(), instance).index()
        return found

    def shapes(
        self, plant: MultibodyPlant, inspector: SceneGraphInspector, bodies: Mapping[BodyIndex, BodyIndex]
    ) -> dict[GeometryId, GeometryId]:
        """Return each shape here → the same one in another plant.

        A shape is registered once for each kind of partner, and here are fewer of those: all stand for the first.

        Args:
            plant: The other plant.
            inspector: Of its shapes.
            bodies: What `bodies` returned for it.
        """
        own, found = self.scene_graph.model_inspector(), {}
        for here, there in bodies.items():
            shapes = {}
            for geometry in reversed(plant.GetCollisionGeometriesForBody(plant.get_body(there))):
                shapes[_short(inspector.GetName(geometry))] = geometry
            for geometry in self.plant.GetCollisionGeometriesForBody(self.plant.get_body(here)):
                found[geometry] = shapes[_short(own.GetName(geometry))]
        return found


def _short(name: str) -> str:
    """Return a shape's name without its model and without the partners that it is for."""
    return name.rpartition("::")[2].partition("|")[0]


def build_island(builder: DiagramBuilder, parts: PlantOfTwin, models: Sequence[Mover]) -> Island:
    """Return an island.

    Args:
        builder: The builder that has the plant.
        parts: The plant.
        models: The movers that it is built of.
    """
    plant = parts.plant
    moments = add_gyroscopic_moments(builder, plant)
    if moments is not None:
        join_forces(builder, plant, [moments])
    places = [
        places_of(plant, (parts.robots[mover.name].instance,) if mover.is_robot else parts.world_models[mover.name])
        for mover in models
    ]
    return Island(builder.Build(), models, places, parts.detachable_joints)


def cloned(island: Island) -> Island | None:
    """Return another island of the same plant, in a thirtieth of the time; None if Drake cannot.

    What Drake does not clone (start positions, gains of motors) is set when movers take their places.
    """
    if island.detachable_joints:
        return None
    try:
        diagram = island.diagram.Clone()
    except RuntimeError:  # of a system that Drake cannot clone
        return None
    assert isinstance(diagram, Diagram)
    return Island(diagram, island.models, island.places)
