"""A scenario's diagram with its simulator, and the state of its plant.

A plant cannot change once it is finalized. When a robot is added or deleted, or the step changes, the diagram is
rebuilt, every state is transferred by name, and the old diagram is released, so that its memory is freed.
"""

from collections.abc import Iterable, Mapping, Sequence
from math import inf
from typing import TYPE_CHECKING, Any, NoReturn

import numpy as np
from pydrake.geometry import Meshcat
from pydrake.multibody.math import SpatialForce
from pydrake.multibody.plant import ExternallyAppliedSpatialForce, MultibodyPlant
from pydrake.multibody.tree import QuaternionFloatingJoint
from pydrake.systems.analysis import ApplySimulatorConfig, InitializeParams, Simulator, SimulatorConfig
from pydrake.systems.framework import Context

from drake_twin.controllers.stateful_controller import StatefulController
from drake_twin.diagram.applied_forces import follow_masses, wrench_port
from drake_twin.diagram.gyroscopic_moments import follow_inertias
from drake_twin.diagram.release import release
from drake_twin.diagram.servo_gains import ServoGains, servo_gains
from drake_twin.diagram.twin_diagram import Extension, TwinDiagram, build_twin_diagram
from drake_twin.diagram.world_in_plant import changing_wind
from drake_twin.errors import RunError
from drake_twin.planning.robot_plan import RobotPlan, is_same_robot
from drake_twin.scenario import CENIC, LONGEST_STEP, Scenario
from drake_twin.twin.detachable_joints import DetachableJoints
from drake_twin.twin.entity_state import Wrench, find_body
from drake_twin.twin.extension_state import ExtensionState
from drake_twin.twin.failure import ABSURD, Moment
from drake_twin.twin.late_measurements import LateMeasurements
from drake_twin.twin.plain_data import from_plain, to_plain
from drake_twin.twin.plant_parameters import PlantParameters
from drake_twin.twin.pull import Pull
from drake_twin.twin.pushes import settled_pushes
from drake_twin.twin.state import read_robot_state
from drake_twin.twin.varied_parameters import varied_parameters

if TYPE_CHECKING:
    from drake_twin.islands.island_simulator import IslandSimulator

# Longer than the longest grid (s): a limit that is met except for rounding leaves a step of 1e-16 s. In such a step the
# velocity that CENIC gives a mimic joint, its position error divided by the step, is unbounded.
_LONGEST_STEP_OF_CENIC = 1.1 * LONGEST_STEP
_SAME_TIME = 1e-9  # s


def _island_simulator(built: TwinDiagram, scenario: Scenario) -> "IslandSimulator":
    from drake_twin.twin.island_physics import island_simulator

    return island_simulator(built, scenario)


class Physics:
    """A scenario's diagram with its simulator.

    Args:
        scenario: The scenario to run.
        meshcat: The page to draw on.
        known: A diagram that was built before; parts that both have are not read again.
        plans: Plans of robots, if made before.
        extensions: Functions that add a user's own systems to the diagram.

    Attributes:
        built: The diagram.
        simulator: Its simulator.
        islands: The simulator, if robots are in islands.
        context: The root context.
        plant_context: The plant's context.
        gains: Robot → the gains of its servos; those of its file unless the scenario retunes them.
        pushes: The scenario's pushes with their forces.
        detachable_joints: The joints that come and go.
        is_handed_out: Whether a user has had the context, and may have changed parameters by Drake's own methods.
        new_events: The controllers that have added an event, which the simulator does not know yet.
    """

    def __init__(
        self,
        scenario: Scenario,
        meshcat: Meshcat | None = None,
        known: TwinDiagram | None = None,
        plans: Iterable[RobotPlan] = (),
        extensions: Sequence[Extension] = (),
    ):
        self.built = build_twin_diagram(scenario, meshcat, known, plans, extensions)
        self.islands = _island_simulator(self.built, scenario) if scenario.most_in_an_island else None
        self.simulator = self.islands or Simulator(self.built.diagram)
        if scenario.engine == CENIC:
            configuration = SimulatorConfig(
                integration_scheme="cenic", accuracy=scenario.accuracy, max_step_size=_LONGEST_STEP_OF_CENIC
            )
            ApplySimulatorConfig(configuration, self.simulator)
        self.context: Context = self.simulator.get_mutable_context()
        self.plant_context: Context = self.built.plant.GetMyMutableContextFromRoot(self.context)
        self._parameters = PlantParameters(self.built.plant, self.built.scene_graph, self.context)
        self._followed: Mapping[str, Sequence[Any]] = {}  # the parameters that the islands have
        self.is_handed_out = False
        self._time_step = scenario.time_step
        self.use(scenario)
        self.gains = (
            self._retuned_gains()
            if scenario.retune
            else {name: robot.gains for name, robot in self.built.robots.items()}
        )
        keepers = [
            item
            for parts in self.built.parts.values()
            for item in parts.controllers.values()
            if isinstance(item, StatefulController)
        ]
        self._keepers = [(item, item.GetMyMutableContextFromRoot(self.context)) for item in keepers]
        self.new_events: list[str] = []
        for item in keepers:
            item.new_events = self.new_events
        self._extensions = ExtensionState(self.built, self.context)
        self._wind = changing_wind(self.built.diagram)
        self._late = LateMeasurements(self.built, self.context)
        self._late.start()
        self.detachable_joints = DetachableJoints(self.built, self.context)
        if self.islands is not None:
            self.islands.archipelago.attachments = self.detachable_joints.attachments
        joints = map(self.built.plant.get_joint, self.built.plant.GetJointIndices())
        starts = [joint.position_start() for joint in joints if joint.type_name() == QuaternionFloatingJoint.kTypeName]
        self._quaternions = np.add.outer(np.array(starts, dtype=int), np.arange(4))
        self._turns = self._quaternions.ravel()
        self._longest = 4.0 * max(1, len(starts))  # the sum of squares below which no quaternion is near to overflow
        self._updates: set[tuple[float, float]] = set()
        if scenario.engine == CENIC:
            self._updates = {(item.setup.update_period, item.setup.update_offset) for item in keepers}

    def check(self) -> bool:
        """Return whether the state is possible, and settle it before it overflows: mostly two sums tell all."""
        state = self.built.plant.GetPositionsAndVelocities(self.plant_context)
        turns = state[self._turns]
        return bool(np.vdot(state, state) < ABSURD**2 and np.vdot(turns, turns) < self._longest) or self.settle()

    def settle(self) -> bool:
        """Halve the quaternions of free bodies, as often as their lengths allow.

        Each of Drake's discrete steps lengthens a quaternion by (h ω)² / 8: at 20 rad/s and a step of 10 ms it would
        overflow after eight seconds. Drake's plant accepts a quaternion of any length, and a power of two changes no
        digit, so that the run continues to the same bit whenever this is called.

        Returns:
            Whether the state is possible.
        """
        plant = self.built.plant
        state = plant.GetPositionsAndVelocities(self.plant_context)
        if len(self._quaternions):
            squares = np.add.reduce(state[self._quaternions] ** 2, axis=1)
            if 4.0 <= np.maximum.reduce(squares) < inf:
                halvings = np.maximum(np.frexp(np.sqrt(squares))[1] - 1, 0)
                state[self._quaternions] = np.ldexp(state[self._quaternions], -halvings[:, np.newaxis])
                plant.SetPositions(self.plant_context, state[: plant.num_positions()])
        return bool(np.maximum.reduce(np.abs(state), initial=0.0) < ABSURD)  # false for NaN

    def initialize(self) -> None:
        """Initialize the simulator at the context's time and state.

        Raises:
            RunError: If Drake cannot.
        """
        try:
            self.simulator.Initialize()
        except (RuntimeError, SystemExit) as error:
            raise RunError(f"the simulation cannot start: {' '.join(str(error).split())}") from error

    def meet_new_events(self) -> None:
        """Let the simulator know the updates of controllers that have become active."""
        self.new_events.clear()
        self.simulator.Initialize(InitializeParams(suppress_initialization_events=True))

    def moment(self) -> Moment:
        """Return the present moment, for `go_back`. It is called before each advance, so it copies one vector only."""
        state = self.built.plant.GetPositionsAndVelocities(self.plant_context)
        samples = [item.sample(context) if item.is_updated else None for item, context in self._keepers]
        past = self._late.past() if self._late.contexts else ()
        memory = None if self.islands is None else self.islands.archipelago.memory()
        return Moment(self.context.get_time(), state, samples, past, memory)

    def go_back(self, moment: Moment) -> None:
        """Return to a moment of this diagram, for all that steps have changed."""
        self.context.SetTime(moment.time)
        self.built.plant.SetPositionsAndVelocities(self.plant_context, moment.state)
        for (item, context), sample in zip(self._keepers, moment.samples, strict=True):
            if sample is not None:
                item.set_sample(context, sample)
        self._late.go_back(moment.past)
        if self.islands is not None:
            self.islands.remember(moment.islands)
        self.detachable_joints.follow()
        self.initialize()

    def time_of(self, step: int) -> float:
        """Return the end time of a step (s), or the time of an update that differs from it only by rounding.

        With CENIC a controller's update just beside a step's end would leave a step of 1e-16 s between the two.
        """
        time = step * self._time_step
        if not self._updates:
            return time
        updates = [offset + round((time - offset) / period) * period for period, offset in self._updates]
        return max((update for update in updates if abs(update - time) < _SAME_TIME), default=time)

    def start_at_rest(self) -> None:
        """Set the context to its default state at time zero."""
        self.built.diagram.SetDefaultContext(self.context)
        self.context.SetTime(0.0)
        if self._start_parameters:
            self._put(self._start_parameters)
        self._late.start()
        self.detachable_joints.forget()
        if self.islands is not None:
            self.islands.remember(None)
            self.look_at_parameters()

    def use(self, scenario: Scenario) -> None:
        """Start with the values and pushes of a scenario from now on.

        Raises:
            ScenarioError: If a value or the link of a push is unknown or invalid.
        """
        parameters = varied_parameters(self.built, scenario.values)
        self.pushes = settled_pushes(self.built, scenario)
        self._start_parameters = parameters

    def _retuned_gains(self) -> dict[str, tuple[ServoGains | None, ...]]:
        """Return the gains that follow from the values of the scenario."""
        built, root = self.built, self.built.diagram.CreateDefaultContext()
        self._parameters.put(root, self._start_parameters)
        robots = [(plan, built.robots[plan.name].instance, built.robots[plan.name].layout) for plan in built.plans]
        return servo_gains(built.plant, robots, context=built.plant.GetMyContextFromRoot(root))

    def set_values(self, values: Mapping[str, float]) -> None:
        """Set these values of a scenario at once, and all other parameters to those as built.

        Raises:
            ScenarioError: If a value is unknown or invalid.
        """
        self._put(varied_parameters(self.built, values))

    def _put(self, parameters: Mapping[str, Sequence[Any]], *, leave_out_unknown: bool = False) -> None:
        if self._parameters.put(self.context, parameters, leave_out_unknown=leave_out_unknown):
            follow_inertias(self.built.diagram, self.built.plant, self.context)
            follow_masses(self.built.diagram, self.built.plant, self.context)
            self.look_at_parameters()

    def look_at_parameters(self) -> None:
        """Let the islands have the parameters of the context."""
        if self.islands is not None and (now := self._parameters.changed(self.context)) != self._followed:
            self._followed = now
            self.islands.archipelago.follow_parameters(now)

    def stepped(self) -> list[tuple[MultibodyPlant, Context]]:
        """Return the plants that are stepped, each with the root context of its diagram in the present state."""
        islands = [] if self.islands is None else self.islands.present()
        return [(island.plant, island.context) for island in islands] or [(self.built.plant, self.context)]

    def set_robot_state(self, robot: str, state: np.ndarray) -> None:
        """Set a robot's ``[q; v]``."""
        self.built.plant.SetPositionsAndVelocities(self.plant_context, self.built.robots[robot].instance, state)

    def robot_state(self, robot: str) -> np.ndarray:
        """Return a robot's ``[q; v]``."""
        instance = self.built.robots[robot].instance
        return np.array(self.built.plant.GetPositionsAndVelocities(self.plant_context, instance))

    def state(self) -> dict[str, Any]:
        """Return the entries of a snapshot that this part keeps, as plain data.

        For each robot these are its vector ``[q; v]`` and, for readers, the same by joint and the pose of its base.
        """
        self.settle()  # a user may have written the state by Drake's own methods, and parameters
        self.look_at_parameters()
        state = {
            "robots": {plan.name: self._robot_entries(plan) for plan in self.built.plans},
            "models": self._model_states(),
            "parameters": self._parameters.changed(self.context),
        }
        if systems := self._extensions.state():
            state["systems"] = systems
        if self.islands is not None:
            state["islands"] = self.islands.state()
        if self._wind is not None:
            state["wind"] = to_plain(self._wind.state(self._wind.GetMyContextFromRoot(self.context)))
        return state

    def set_state(self, state: Mapping[str, Any]) -> None:
        """Set the entries that `state` returned, of the same robots and models.

        Raises:
            ValueError: If they are those of other robots or models, or are invalid.
        """
        if set(state["robots"]) != {plan.name for plan in self.built.plans}:
            raise ValueError("its robots or models are not those of the twin")
        if set(state["models"]) != set(self.built.world_models):
            raise ValueError("its models of the world are not those of the twin")
        self._set_models(state["models"])
        self._put(state["parameters"])
        for name, saved in state["robots"].items():
            self.set_robot_state(name, np.array(saved["state"], dtype=float))
            self._late.set_state(name, saved)
        if islands := state.get("islands"):
            if self.islands is None:
                raise ValueError("its robots are in islands, and those of the twin are not")
            self.islands.set_state(islands)
        self._set_wind(state)
        self._extensions.set_state(state.get("systems", {}))

    def transfer(self, state: Mapping[str, Any], old: "Physics") -> None:
        """Set the part of another diagram's state that has a place in this one.

        Args:
            state: The result of `state` of the other diagram.
            old: The other diagram.
        """
        known = {plan.name: plan for plan in old.built.plans}
        for plan in self.built.plans:
            if is_same_robot(plan, known.get(plan.name)):
                self.set_robot_state(plan.name, np.array(state["robots"][plan.name]["state"]))
                self._late.set_state(plan.name, state["robots"][plan.name], self._time_step / old._time_step)
                assert self.built.robots[plan.name].layout == old.built.robots[plan.name].layout
        own = old._start_parameters
        since = {name: value for name, value in state["parameters"].items() if value != own.get(name)}
        self._put(self._start_parameters | since, leave_out_unknown=True)
        if self.built.world.file == old.built.world.file:
            self._set_models(
                {name: vectors for name, vectors in state["models"].items() if name in self.built.world_models}
            )
        if self.built.world == old.built.world:
            self._set_wind(state)
        self._extensions.set_state(state.get("systems", {}))

    def _robot_entries(self, plan: RobotPlan) -> dict[str, Any]:
        state = read_robot_state(self.built, self.context, plan, with_efforts=False)
        return {
            "state": self.robot_state(plan.name).tolist(),
            "joints": {
                joint: [position, velocity]
                for joint, position, velocity in zip(state.joints, state.positions, state.velocities, strict=True)
            },
            "base_pose": list(state.base_pose),
            **self._late.state(plan.name),
        }

    def _model_states(self) -> dict[str, list[list[float]]]:
        """Return ``[q; v]`` of each model instance of the world's moving models, by the model's name."""
        plant = self.built.plant
        return {
            name: [plant.GetPositionsAndVelocities(self.plant_context, instance).tolist() for instance in instances]
            for name, instances in self.built.world_models.items()
        }

    def _set_models(self, states: Mapping[str, list[list[float]]]) -> None:
        for name, vectors in states.items():
            for instance, vector in zip(self.built.world_models[name], vectors, strict=True):
                self.built.plant.SetPositionsAndVelocities(self.plant_context, instance, np.array(vector))

    def _set_wind(self, state: Mapping[str, Any]) -> None:
        if "wind" in state:
            if self._wind is None:
                raise ValueError("the world's wind does not change")
            self._wind.set_state(self._wind.GetMyMutableContextFromRoot(self.context), from_plain(state["wind"]))

    def set_wrenches(self, wrenches: Sequence[Wrench | Pull]) -> None:
        """Apply these forces and torques to links, and no others."""
        port = wrench_port(self.built.diagram, self.built.plant)
        context = port.get_system().GetMyMutableContextFromRoot(self.context)
        if not wrenches and not port.HasValue(context):
            return  # an unused port costs nothing
        forces = []
        for wrench in wrenches:
            force = ExternallyAppliedSpatialForce()
            force.body_index = find_body(self.built, wrench.entity).index()
            force.p_BoBq_B = np.array(wrench.at)
            force.F_Bq_W = SpatialForce(tau=np.array(wrench.torque), f=np.array(wrench.force))
            forces.append(force)
        port.FixValue(context, forces)

    @property
    def is_discarded(self) -> bool:
        """Whether the diagram was released."""
        return "simulator" not in self.__dict__

    if not TYPE_CHECKING:

        def __getattr__(self, name: str) -> NoReturn:  # of what is not there: `discard` has deleted it
            if self.is_discarded and not name.startswith("__"):
                raise RunError("the twin is closed")
            raise AttributeError(f"Physics has no attribute {name!r}")

    def discard(self) -> None:
        """Release the diagram, so that its memory can be freed."""
        if self.islands is not None:
            self.islands.discard()
        release([self.simulator, self.built.diagram])
        del self.simulator, self.islands, self.context, self.plant_context, self.built, self._keepers, self._parameters
        del self._extensions, self._late, self._wind, self.detachable_joints
