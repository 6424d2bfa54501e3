"""A simulator of a diagram whose plant only holds the state: its robots are stepped in islands."""

from collections.abc import Callable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from math import inf
from typing import Any

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, Role
from pydrake.multibody.math import SpatialAcceleration, SpatialForce
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.analysis import InitializeParams, Simulator, SimulatorStatus
from pydrake.systems.framework import Context, OutputPort

from drake_twin.diagram.release import release
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.islands.archipelago import Archipelago, Memory
from drake_twin.islands.contacts import Contacts, JoinedContacts
from drake_twin.islands.island import Island
from drake_twin.islands.island_store import Parameterize
from drake_twin.islands.mover import Places
from drake_twin.python_process import own_cores
from drake_twin.scenario import Scenario

_SAME = 1e-6  # steps


class IslandSimulator:
    """Advances a diagram as Drake's Simulator does, with its robots in islands.

    The systems of the diagram do what is due, then the islands step to where something is due next, or forces are read
    again; then their state is that of the diagram's plant.

    Args:
        built: The diagram.
        scenario: Its scenario.
        parameterize: Sets parameters of an island.

    Attributes:
        archipelago: The islands.
    """

    def __init__(self, built: TwinDiagram, scenario: Scenario, parameterize: Parameterize):
        self._root = Simulator(built.diagram)
        self._context: Context = self._root.get_mutable_context()
        self._plant, self._scene_graph = built.plant, built.scene_graph
        self._inspector = built.scene_graph.model_inspector()
        self._plant_context = built.plant.GetMyMutableContextFromRoot(self._context)
        self._time_step = scenario.time_step
        self._periods = _periods(built, scenario.time_step)
        self._step = 0
        self._is_ahead = False  # whether the step of the present time is made already
        threads = scenario.threads or own_cores()
        self._pool = ThreadPoolExecutor(threads) if threads > 1 else None
        self.archipelago = Archipelago(built, scenario, self._context, parameterize, self._pool)
        assert built.ports.elsewhere is not None, "the plant holds the state"
        built.ports.elsewhere.ask(self)

    def get_mutable_context(self) -> Context:
        """Return the root context."""
        return self._context

    def Initialize(self, params: InitializeParams | None = None) -> SimulatorStatus:
        """Initialize at the context's time and state."""
        status = self._root.Initialize() if params is None else self._root.Initialize(params)
        self._step = int(self._context.get_time() / self._time_step + _SAME) + self._is_ahead
        self._is_ahead = False
        self.archipelago.begin(self._step)
        return status

    def AdvanceTo(self, time: float) -> SimulatorStatus:
        """Advance to a time (s), or to the event at which a controller ends the advance."""
        last = int(time / self._time_step + _SAME)
        while True:
            status = self._do_events()
            if not status.succeeded():
                self._step_at_once()
                return status
            target = min(last, self._next_stop())
            if target > self._step:
                state = self.archipelago.advance(self._step, target)
                self._plant_context.SetDiscreteState(state)  # also one that is not finite, which the twin tells
                self._step = target
            if target >= last:
                return self._root.AdvanceTo(time)
            status = self._root.AdvanceTo(target * self._time_step)
            if not status.succeeded():
                return status

    def _step_at_once(self) -> None:
        """Make the step of the present time, as Drake's plant does at the event that ends an advance."""
        if self._context.get_time() >= self._step * self._time_step:  # else the step is still to come
            self._plant_context.SetDiscreteState(self.archipelago.advance(self._step, self._step + 1))
            self._is_ahead = True

    def _do_events(self) -> SimulatorStatus:
        """Do what is due at the present time."""
        if self._context.get_time() > 0.0:
            return self._root.AdvancePendingEvents()
        # At time zero even a plant that holds the state makes a step: of nothing, if all is locked and touches nothing.
        plant, own = self._plant, self._plant_context
        state = plant.GetPositionsAndVelocities(own)
        joints = [plant.get_joint(index) for index in plant.GetJointIndices()]
        free = [joint for joint in joints if joint.num_velocities() and not joint.is_locked(own)]
        for joint in free:
            joint.Lock(own)
        for constraint in plant.GetConstraintIds():
            plant.SetConstraintActiveStatus(own, constraint, False)
        own.SetDiscreteState(state)
        shapes = GeometrySet(list(self._inspector.GetAllGeometryIds(Role.kProximity)))
        scene_graph = self._scene_graph.GetMyMutableContextFromRoot(self._context)
        filters = self._scene_graph.collision_filter_manager(scene_graph)
        declared = filters.ApplyTransient(CollisionFilterDeclaration().ExcludeWithin(shapes))
        try:
            return self._root.AdvancePendingEvents()
        finally:
            filters.RemoveDeclaration(declared)
            for joint in free:
                joint.Unlock(own)
            own.SetDiscreteState(state)

    def _next_stop(self) -> int:
        """Return the step at which systems of the diagram are due again, or a frame of the islands ends."""
        if self.archipelago.inputs.have_forces:
            return self._step + 1
        due = [offset + ((self._step - offset) // period + 1) * period for period, offset in self._periods]
        return min([self.archipelago.next_frame(self._step), *due])

    def present(self) -> list[Island]:
        """Return islands of all robots and models in the present state, also of those that rest."""
        return self.archipelago.present(self._step)

    # What follows from the step to come: the `Solutions` of the diagram.

    def net_actuation(self) -> np.ndarray:
        """Return the efforts of all actuators (N·m or N)."""
        efforts = np.zeros(self._plant.num_actuators())
        for island in self.present():
            found = island.plant.get_net_actuation_output_port().Eval(island.plant_context)
            for number, places in zip(island.members, island.places, strict=True):
                efforts[self.archipelago.movers[number].places.actuators] = found[places.actuators]
        return efforts

    def body_spatial_accelerations(self) -> list[SpatialAcceleration]:
        """Return the accelerations of all bodies in the world."""
        found = [SpatialAcceleration.Zero()] * self._plant.num_bodies()
        self._gather(found, MultibodyPlant.get_body_spatial_accelerations_output_port, lambda places: places.bodies)
        return found

    def reaction_forces(self) -> list[SpatialForce]:
        """Return the reactions in all joints."""
        found = [SpatialForce.Zero()] * self._plant.num_joints()
        self._gather(found, MultibodyPlant.get_reaction_forces_output_port, lambda places: places.joints)
        return found

    def _gather(
        self,
        found: list[Any],
        port: Callable[[MultibodyPlant], OutputPort],
        own: Callable[[Places], Sequence[BodyIndex] | Sequence[int]],
    ) -> None:
        """Put what the islands' ports have for each body or joint to its place in a list."""
        for island in self.present():
            values = port(island.plant).Eval(island.plant_context)
            for number, places in zip(island.members, island.places, strict=True):
                for there, here in zip(own(self.archipelago.movers[number].places), own(places), strict=True):
                    found[int(there)] = values[int(here)]

    def contact_results(self) -> JoinedContacts:
        """Return the contacts in all islands."""
        joined = []
        for island in self.present():
            members = [self.archipelago.movers[number].places for number in island.members]
            bodies = island.bodies(self._plant, members)
            results = island.plant.get_contact_results_output_port().Eval(island.plant_context)
            joined.append(Contacts(results, bodies, island.shapes(self._plant, self._inspector, bodies)))
        return JoinedContacts(joined)

    # What it remembers.

    def state(self) -> dict[str, Any]:
        """Return what is remembered between two steps beside the robots' state, as plain data."""
        memory, movers = self.archipelago.memory_with_inputs(), self.archipelago.movers
        names = [mover.name for mover in movers]
        return {
            "groups": [[names[number] for number in group] for group in memory.groups],
            "until": memory.until,
            "rested": {name: time for name, time in zip(names, memory.rested, strict=True) if time > 0.0},
        }

    def remember(self, memory: Memory | None) -> None:
        """Continue with what the archipelago remembered; None to begin without."""
        self._is_ahead = False
        self.archipelago.remember(memory)

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set what `state` returned."""
        names = [mover.name for mover in self.archipelago.movers]
        groups = tuple(tuple(map(names.index, group)) for group in state["groups"])
        rested: Sequence[float] = [state["rested"].get(name, 0.0) for name in names]
        self.remember(Memory(groups, int(state["until"]), tuple(rested)))

    def discard(self) -> None:
        """Release all diagrams, so that their memory can be freed."""
        if self._pool is not None:
            self._pool.shutdown()
        self.archipelago.discard()
        release([self._root])


def _periods(built: TwinDiagram, step: float) -> set[tuple[int, int]]:
    """Return the periods of what systems of the diagram do, and the offsets of the first time, in steps."""
    if built.extensions or any(parts.delays for parts in built.parts.values()):
        return {(1, 0)}
    found: set[tuple[int, int]] = set()
    for parts in built.parts.values():
        setups = [item.setup for item in parts.controllers.values()]
        for setup in setups:
            if setup.update_period < inf:
                steps = max(1, round(setup.update_period / step))
                found.add((steps, round(setup.update_offset / step) % steps))
        if parts.gpios is not None:
            found.add((1, 0))
    return found
