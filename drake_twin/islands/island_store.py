"""Prepared islands, by what they have places for."""

from collections.abc import Callable, Hashable, Iterable, Mapping, Sequence
from dataclasses import replace
from typing import Any

from pydrake.systems.framework import DiagramBuilder

from drake_twin.diagram.plant import add_plant
from drake_twin.diagram.release import release
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.islands.island import Island, build_island, cloned
from drake_twin.islands.mover import Mover
from drake_twin.scenario import Scenario

# Sets those parameters of an island that differ from the files', by the names that they have in the whole diagram.
Parameterize = Callable[[Island, Mapping[str, Sequence[Any]]], None]

_MOST_SPARE = 3  # islands of one composition that are kept though nobody is in them


class IslandStore:
    """Builds islands, and keeps those that are left for the next movers of the same kinds.

    Args:
        built: The diagram of all.
        scenario: Its scenario.
        movers: All movers.
        parameterize: Sets parameters of an island.

    Attributes:
        kinds: The number of each mover's kind: movers of one kind take each other's places.
    """

    def __init__(self, built: TwinDiagram, scenario: Scenario, movers: Sequence[Mover], parameterize: Parameterize):
        self._built, self._scenario = built, scenario
        self._movers, self._parameterize = movers, parameterize
        self._spare: dict[tuple[str, ...], list[Island]] = {}
        self._first: dict[tuple[str, ...], Island] = {}  # of which the next ones are clones
        self._parameters: Mapping[str, Sequence[Any]] = {}
        self.kinds: list[int] = []
        self._of_kind: dict[int, list[Mover]] = {}
        self._find_kinds()

    def follow(self, parameters: Mapping[str, Sequence[Any]]) -> None:
        """Build islands with these parameters, other than the files', from now on; drop those that are spare."""
        self.discard()
        self._parameters = parameters
        self._find_kinds()

    def _find_kinds(self) -> None:
        numbers: dict[Hashable, int] = {}
        self._of_kind = {}
        own: dict[str, list[Hashable]] = {}
        for name, values in self._parameters.items():
            head, _, tail = name.partition("::")
            what, _, model = head.rpartition(" ")
            own.setdefault(model, []).append((what, tail.replace(model, ""), tuple(map(str, values))))
        self.kinds = []
        for mover in self._movers:
            kind = mover.kind, tuple(own.get(mover.name, ()))
            self.kinds.append(numbers.setdefault(kind, len(numbers)))
            self._of_kind.setdefault(self.kinds[-1], []).append(mover)

    def take(self, members: Sequence[int]) -> Island:
        """Return an island with a place for each of some movers, which are ordered by their kinds."""
        taken: dict[int, int] = {}
        models = []
        for kind in (self.kinds[number] for number in members):
            models.append(self._of_kind[kind][taken.setdefault(kind, 0)])
            taken[kind] += 1
        spare = self._spare.get(_composition(models))
        return spare.pop() if spare else self._new(models)

    def give_back(self, islands: Iterable[Island]) -> None:
        """Keep islands that nobody is in any more, or drop them."""
        for island in islands:
            spare = self._spare.setdefault(_composition(island.models), [])
            if len(spare) < _MOST_SPARE or island is self._first.get(_composition(island.models)):
                spare.append(island)
            else:
                island.discard()

    def _new(self, models: Sequence[Mover]) -> Island:
        first = self._first.get(_composition(models))
        island = None if first is None else cloned(first)
        if island is None:
            island = self._build(models)
            self._first[_composition(models)] = island
        if self._parameters:
            self._parameterize(island, self._parameters)
        return island

    def _build(self, models: Sequence[Mover]) -> Island:
        built, names = self._built, {mover.name for mover in models}
        plans = [plan for plan in built.plans if plan.name in names]
        world_file = built.world_file
        if world_file is not None:
            kept = tuple(model for model in world_file.models if model.is_static or model.name in names)
            world_file = replace(world_file, models=kept)
        builder = DiagramBuilder()
        try:
            gains = {plan.name: built.robots[plan.name].gains for plan in plans}
            island = build_island(builder, add_plant(builder, self._scenario, plans, world_file, gains), models)
        except BaseException:
            release([builder, *builder.GetSystems()])
            raise
        return island

    def discard(self) -> None:
        """Release the spare islands, so that their memory can be freed."""
        for spare in self._spare.values():
            for island in spare:
                island.discard()
        self._spare.clear()
        self._first.clear()


def _composition(models: Sequence[Mover]) -> tuple[str, ...]:
    return tuple(mover.name for mover in models)
