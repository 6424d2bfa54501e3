"""An arrow for each contact force."""

from pydrake.common.value import AbstractValue
from pydrake.geometry import Meshcat
from pydrake.multibody.meshcat import ContactVisualizer, ContactVisualizerParams

from drake_twin.cockpit.overlays import PATH
from drake_twin.twin import Twin

_NEWTONS_PER_METER = 100.0  # a rover's wheel that carries 20 N has an arrow of 0.2 m


class ContactForces:
    """Drake's contact visualizer, outside of the diagram: it is given the results when it is to draw."""

    def __init__(self, meshcat: Meshcat, twin: Twin):
        self._meshcat = meshcat
        self._twin = twin
        parameters = ContactVisualizerParams(
            prefix=f"{PATH}/contact", newtons_per_meter=_NEWTONS_PER_METER, force_threshold=0.05, radius=0.006
        )
        self._visualizer = ContactVisualizer(meshcat, parameters)
        self._context = self._visualizer.CreateDefaultContext()

    def draw(self) -> None:
        """Draws the present forces."""
        results = self._twin.evaluate(self._twin.plant.get_contact_results_output_port())
        self._visualizer.contact_results_input_port().FixValue(self._context, AbstractValue.Make(results))
        self._context.SetTime(self._twin.time)
        self._visualizer.ForcedPublish(self._context)

    def remove(self) -> None:
        """Takes the arrows off the page."""
        self._visualizer.Delete()
        self._meshcat.Delete(f"{PATH}/contact")
