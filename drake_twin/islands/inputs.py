"""What the systems of the whole diagram let act on its robots, carried to the islands."""

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np
from pydrake.multibody.plant import ExternallyAppliedSpatialForce
from pydrake.multibody.tree import BodyIndex
from pydrake.systems.framework import BusValue, Context

from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.islands.island import Island
from drake_twin.islands.mover import Mover


class Known(NamedTuple):
    """What `Inputs` have read."""

    servos: tuple[tuple[np.ndarray, np.ndarray], ...]
    forces: Mapping[int, list[ExternallyAppliedSpatialForce]]
    generalized_forces: np.ndarray | None
    speeds: BusValue | None
    have_forces: bool
    moved_motors: frozenset[str]


class Inputs:
    """The inputs of the plant that holds the state, read at the start of a frame.

    Args:
        built: The diagram.
        plant_context: Its plant's context.
        movers: All movers.

    Attributes:
        have_forces: Whether forces act that may follow the state, so that they are read before each step.
        moved_motors: The robots whose motors have other gains than when they were last read.
    """

    def __init__(self, built: TwinDiagram, plant_context: Context, movers: Sequence[Mover]):
        plant = built.plant
        self._plant, self._context, self._movers = plant, plant_context, movers
        self._ports = [
            (number, plant.get_desired_state_input_port(instance), plant.get_actuation_input_port(instance))
            for number, mover in enumerate(movers)
            for instance in mover.places.instances
            if plant.num_actuators(instance)
        ]
        self._wrenches = plant.get_applied_spatial_force_input_port()
        self._generalized = plant.get_applied_generalized_force_input_port()
        has_surfaces = hasattr(plant, "get_surface_speeds_input_port")  # from Drake 1.56 on
        self._surfaces = plant.get_surface_speeds_input_port() if has_surfaces else None
        self._known: list[tuple[np.ndarray, np.ndarray]] = [(np.empty(0), np.empty(0))] * len(movers)
        servos = {name: parts.servo for name, parts in built.parts.items()}
        self._limited = {name for name, servo in servos.items() if servo is not None and servo.moves_limits}
        self._owners = {int(body): number for number, mover in enumerate(movers) for body in mover.places.bodies}
        self._forces: Mapping[int, list[ExternallyAppliedSpatialForce]] = {}
        self._generalized_forces: np.ndarray | None = None
        self._speeds: BusValue | None = None
        self.have_forces = False
        self.moved_motors: set[str] = set()

    def read(self) -> set[int]:
        """Read the inputs; return the movers whose inputs have changed."""
        changed: set[int] = set()
        context = self._context
        for number, desired_port, actuation_port in self._ports:
            desired = desired_port.Eval(context)
            actuation = (
                actuation_port.Eval(context) if actuation_port.HasValue(context) else np.zeros(len(desired) // 2)
            )
            known, name = self._known[number], self._movers[number].name
            if (
                known[0].tobytes() != desired.tobytes()
                or known[1].tobytes() != actuation.tobytes()
                or name in self._limited
                or name in self.moved_motors
            ):
                self._known[number] = desired, actuation
                changed.add(number)
        self.moved_motors.clear()
        return changed | self._read_forces()

    def known(self) -> Known:
        """Return what was read."""
        acting = self._forces, self._generalized_forces, self._speeds, self.have_forces
        return Known(tuple(self._known), *acting, frozenset(self.moved_motors))

    def remember(self, known: Known) -> None:
        """Have read what `known` returned."""
        self._known, self.moved_motors = list(known.servos), set(known.moved_motors)
        self._forces, self._generalized_forces, self._speeds, self.have_forces = known[1:5]

    def _read_forces(self) -> set[int]:
        context = self._context
        has_wrenches, has_generalized = self._wrenches.HasValue(context), self._generalized.HasValue(context)
        if not (has_wrenches or has_generalized or self.have_forces) and self._surfaces is None:
            return set()
        before = set(self._forces)
        forces: dict[int, list[ExternallyAppliedSpatialForce]] = {}
        self._forces, self._generalized_forces, self._speeds = forces, None, None
        changed: set[int] = set()
        for force in self._wrenches.Eval(context) if has_wrenches else ():
            number = self._owners.get(int(force.body_index))
            if number is not None:
                forces.setdefault(number, []).append(force)
        if has_generalized:
            self._generalized_forces = self._generalized.Eval(context)
            changed |= set(range(len(self._movers)))
        if self._surfaces is not None and self._surfaces.HasValue(context):
            self._speeds = self._surfaces.Eval(context)
            changed |= set(range(len(self._movers)))
        self.have_forces = has_wrenches or has_generalized or self._speeds is not None
        return changed | set(self._forces) | before

    def give(self, islands: Iterable[Island], changed: set[int] | None) -> None:
        """Set the inputs of islands.

        Args:
            islands: The islands.
            changed: The movers whose inputs differ from what their island has; None for all.
        """
        if changed is not None and not (changed or self.have_forces):
            return
        for island in islands:
            is_changed = changed is None
            for place, number in enumerate(island.members):
                if changed is not None and number not in changed:
                    continue
                is_changed = True
                if len(island.places[place].actuators):
                    is_moved = island.follow_motors(place, self._plant, self._movers[number].places)
                    island.command(place, *self._known[number], is_moved=is_moved)
            if is_changed:
                island.push(self._pushes(island))
            if self._generalized_forces is not None:
                island.drive(
                    self._generalized_forces,
                    self._plant.num_positions(),
                    [self._movers[number].places for number in island.members],
                )
            if self._speeds is not None:
                island.move_surfaces(self._named_speeds(island, self._speeds))

    def _pushes(self, island: Island) -> list[tuple[BodyIndex, ExternallyAppliedSpatialForce]]:
        found: list[tuple[BodyIndex, ExternallyAppliedSpatialForce]] = []
        for number, places in zip(island.members, island.places, strict=True):
            if number in self._forces:
                here = dict(zip(map(int, self._movers[number].places.bodies), places.bodies, strict=True))
                found += [(here[int(force.body_index)], force) for force in self._forces[number]]
        return found

    def _named_speeds(self, island: Island, speeds: BusValue) -> Mapping[str, float]:
        """Return the speed of each surface under the name that its body has in an island."""
        found = {}
        for number, places in zip(island.members, island.places, strict=True):
            for there, here in zip(self._movers[number].places.bodies, places.bodies, strict=True):
                value = speeds.Find(self._plant.get_body(there).scoped_name().get_full())
                if value is not None:
                    found[island.plant.get_body(here).scoped_name().get_full()] = value.get_value()
        return found
