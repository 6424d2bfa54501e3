"""The islands of a twin's physics, with the parameters that its plant has."""

from collections.abc import Mapping, Sequence
from typing import Any

from drake_twin.diagram.gyroscopic_moments import follow_inertias
from drake_twin.diagram.twin_diagram import TwinDiagram
from drake_twin.islands.island import Island
from drake_twin.islands.island_simulator import IslandSimulator
from drake_twin.scenario import Scenario
from drake_twin.twin.plant_parameters import PlantParameters


def island_simulator(built: TwinDiagram, scenario: Scenario) -> IslandSimulator:
    """Return the simulator of a diagram whose robots are in islands."""

    def parameterize(island: Island, parameters: Mapping[str, Sequence[Any]]) -> None:
        own = PlantParameters(island.plant, island.scene_graph, island.context)
        own.put(island.context, parameters, leave_out_unknown=True)
        follow_inertias(island.diagram, island.plant, island.context)

    return IslandSimulator(built, scenario, parameterize)
