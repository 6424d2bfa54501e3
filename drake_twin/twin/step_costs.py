"""Where the time of a step goes: physics, its contacts, and between what they are."""

import time
from collections.abc import Callable
from statistics import median

from pydrake.multibody.plant import MultibodyPlant
from pydrake.systems.framework import Context

from drake_twin.dataclass import dataclass
from drake_twin.twin.touching import models_of_shapes, touching
from drake_twin.twin.twin import Twin

_TRIALS = 5
_WORLD = "the world"


@dataclass(frozen=True)
class StepCosts:
    """What a step of a discrete twin costs now, measured on a copy of its state.

    Attributes:
        step: Processor time of a step of the plant (s).
        contact: The part of it that finds where shapes touch (s).
        has_faces: Whether shapes touch with their faces.
        pairs: Which models touch → the number of faces' facets and points between them, the most first.
    """

    step: float
    contact: float
    has_faces: bool
    pairs: dict[tuple[str, str], int]


def step_costs(twin: Twin) -> StepCosts:
    """Measure what a step costs; the twin is left as it is.

    Raises:
        RunError: If Drake cannot solve the next step.
    """
    facets, points = touching(twin, models_of_shapes(twin))
    costs = [_costs(plant, root.Clone()) for plant, root in twin._session.physics.stepped()]
    step, contact = map(sum, zip(*costs, strict=True)) if costs else (0.0, 0.0)
    pairs = {(a or _WORLD, b): count for (a, b), count in (facets + points).most_common()}
    return StepCosts(step, contact, bool(facets), pairs)


def _costs(plant: MultibodyPlant, root: Context) -> tuple[float, float]:
    """Return the processor time of a step of a plant, and of its contacts (s)."""
    context = plant.GetMyMutableContextFromRoot(root)
    positions = plant.GetPositions(context)
    query = plant.get_geometry_query_input_port()
    updates = plant.AllocateDiscreteVariables()

    def again(work: Callable[[], object]) -> float:
        spent = []
        for _ in range(_TRIALS):
            plant.SetPositions(context, positions)  # what was computed of them is out of date
            query.Eval(context)
            start = time.process_time()
            work()
            spent.append(time.process_time() - start)
        return median(spent)

    step = again(lambda: plant.CalcForcedDiscreteVariableUpdate(context, updates))
    kind = plant.get_contact_surface_representation()
    return step, again(lambda: query.Eval(context).ComputeContactSurfacesWithFallback(kind))
