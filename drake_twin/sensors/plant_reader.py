"""A system that measures what ports of the plant and of the scene graph carry."""

from collections.abc import Callable
from typing import Any

from pydrake.common.value import AbstractValue, Value
from pydrake.geometry import QueryObject, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.math import SpatialAcceleration, SpatialForce, SpatialVelocity
from pydrake.multibody.plant import ContactResults, MultibodyPlant
from pydrake.systems.framework import InputPort, OutputPort

from drake_twin.systems.plant_reading import PlantPorts
from drake_twin.systems.witnessless_system import WitnesslessSystem

_Port = Callable[[PlantPorts], OutputPort]
_PORTS: dict[str, tuple[Callable[[], AbstractValue], _Port | None]] = {
    "body_poses": (Value[list[RigidTransform]], lambda ports: ports.plant.get_body_poses_output_port()),
    "body_spatial_velocities": (
        Value[list[SpatialVelocity]],
        lambda ports: ports.plant.get_body_spatial_velocities_output_port(),
    ),
    "body_spatial_accelerations": (
        Value[list[SpatialAcceleration]],
        PlantPorts.body_spatial_accelerations,
    ),
    "reaction_forces": (Value[list[SpatialForce]], PlantPorts.reaction_forces),
    "contact_results": (Value[ContactResults], PlantPorts.contact_results),
    "query": (Value[QueryObject], None),  # the scene graph's
}


class PlantReader(WitnesslessSystem):
    """A system with input ports for some of the plant's and the scene graph's output ports.

    Attributes:
        plant_inputs: Name of the port → the input port that takes it.
    """

    def __init__(self) -> None:
        super().__init__()
        self.plant_inputs: dict[str, InputPort] = {}

    def declare_plant_input(self, name: str, value: AbstractValue | None = None) -> InputPort:
        """Declare an input port for a port of the plant, or for ``query`` of the scene graph, or return it.

        Args:
            name: ``body_poses``, ``body_spatial_velocities``, ``body_spatial_accelerations``, ``reaction_forces``,
                ``contact_results`` or ``query``.
            value: What it is declared with, other than Drake's own type.
        """
        if name not in self.plant_inputs:
            self.plant_inputs[name] = self.DeclareAbstractInputPort(name, value or _PORTS[name][0]())
        return self.plant_inputs[name]

    def plant_tickets(self) -> set[Any]:
        """Return the dependency tickets of all ports of the plant that were declared so far."""
        return {self.input_port_ticket(port.get_index()) for port in self.plant_inputs.values()}

    def inputs_from(
        self, plant: MultibodyPlant | PlantPorts, scene_graph: SceneGraph | None = None
    ) -> tuple[tuple[OutputPort, InputPort], ...]:
        """Return pairs of an output port of the plant or the scene graph and the input port that takes it."""
        ports = plant if isinstance(plant, PlantPorts) else PlantPorts(plant)
        found = {name: get(ports) for name, (_, get) in _PORTS.items() if get is not None}
        if scene_graph is not None:
            found["query"] = scene_graph.get_query_output_port()
        return tuple((found[name], port) for name, port in self.plant_inputs.items())
