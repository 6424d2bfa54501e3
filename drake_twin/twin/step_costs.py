"""Where the time of a step goes: physics, its contacts, and between what they are."""

import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass
from statistics import median

from drake_twin.twin.twin import Twin

_TRIALS = 5


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
    """Measure what a step costs; the twin is left as it is."""
    plant, root = twin.plant, twin.context.Clone()
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
    contact = again(
        lambda: query.Eval(context).ComputeContactSurfacesWithFallback(plant.get_contact_surface_representation())
    )
    return StepCosts(step, contact, *_pairs(twin))


def _pairs(twin: Twin) -> tuple[bool, dict[tuple[str, str], int]]:
    plant = twin.plant
    results = plant.get_contact_results_output_port().Eval(plant.GetMyContextFromRoot(twin.context))
    inspector = twin.diagram.GetSubsystemByName("scene_graph").model_inspector()
    found: Counter[tuple[str, str]] = Counter()

    def model(geometry: object) -> str:
        body = plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        name = str(plant.GetModelInstanceName(body.model_instance()))
        return "the world" if body.index() == plant.world_body().index() else name

    def add(one: object, other: object, count: int) -> None:
        first, second = sorted((model(one), model(other)))
        found[first, second] += count

    for index in range(results.num_hydroelastic_contacts()):
        surface = results.hydroelastic_contact_info(index).contact_surface()
        add(surface.id_M(), surface.id_N(), surface.num_faces())
    for index in range(results.num_point_pair_contacts()):
        pair = results.point_pair_contact_info(index).point_pair()
        add(pair.id_A, pair.id_B, 1)
    return results.num_hydroelastic_contacts() > 0, dict(found.most_common())
