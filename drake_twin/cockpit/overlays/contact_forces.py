"""An arrow for each contact force."""

from collections.abc import Iterator

from pydrake.common.value import AbstractValue
from pydrake.geometry import GeometryId, Meshcat, Role, SceneGraphInspector
from pydrake.multibody.meshcat import ContactVisualizer, ContactVisualizerParams
from pydrake.multibody.plant import MultibodyPlant

from drake_twin.cockpit.overlays import PATH
from drake_twin.diagram.joint_friction import is_brake
from drake_twin.twin import Twin

_NEWTONS_PER_METER = 100.0  # a rover's wheel that carries 20 N has an arrow of 0.2 m


class ContactForces:
    """Drake's contact visualizer, outside of the diagram: it is given the results when it is to draw.

    It cannot leave out a contact, so the arrows of the brakes in joints are taken off again.
    """

    def __init__(self, meshcat: Meshcat, twin: Twin):
        self._meshcat = meshcat
        self._twin = twin
        parameters = ContactVisualizerParams(
            prefix=f"{PATH}/contact", newtons_per_meter=_NEWTONS_PER_METER, force_threshold=0.05, radius=0.006
        )
        self._visualizer = ContactVisualizer(meshcat, parameters)
        self._context = self._visualizer.CreateDefaultContext()
        self._brakes = list(_brake_arrows(twin))

    def draw(self) -> None:
        """Draws the present forces."""
        results = self._twin.evaluate(self._twin.plant.get_contact_results_output_port())
        self._visualizer.contact_results_input_port().FixValue(self._context, AbstractValue.Make(results))
        self._context.SetTime(self._twin.time)
        self._visualizer.ForcedPublish(self._context)
        for path in self._brakes:
            self._meshcat.Delete(path)

    def remove(self) -> None:
        """Takes the arrows off the page."""
        self._visualizer.Delete()
        self._meshcat.Delete(f"{PATH}/contact")


def _brake_arrows(twin: Twin) -> Iterator[str]:
    """Where the visualizer draws the forces of brakes; a shoe is registered right before its plate."""
    inspector = twin.diagram.GetSubsystemByName("scene_graph").model_inspector()
    geometries = sorted(inspector.GetAllGeometryIds(Role.kProximity), key=GeometryId.get_value)
    brakes = [geometry for geometry in geometries if is_brake(inspector, geometry)]
    for shoe, plate in zip(brakes[::2], brakes[1::2], strict=True):
        yield f"{PATH}/contact/point/{_name(twin.plant, inspector, shoe)}+{_name(twin.plant, inspector, plate)}"


def _name(plant: MultibodyPlant, inspector: SceneGraphInspector, geometry: GeometryId) -> str:
    """What the visualizer calls a geometry (multibody/plant/internal_geometry_names.cc)."""
    body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
    is_unique = plant.NumBodiesWithName(body.name()) == 1
    is_sole = len(plant.GetCollisionGeometriesForBody(body)) == 1
    model = "" if is_unique else f"{plant.GetModelInstanceName(body.model_instance())}."
    return f"{model}{body.name()}" + ("" if is_sole else f".Id({geometry.get_value()})")
