"""Which constraints Drake's engine ``cenic`` has: none before Drake 1.56, and then more with each version."""

from collections.abc import Callable
from functools import cache

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph
from pydrake.multibody.tree import SpatialInertia
from pydrake.systems.analysis import ApplySimulatorConfig, Simulator, SimulatorConfig
from pydrake.systems.framework import DiagramBuilder


@cache
def cenic_has_constraints(add: str, *more: float) -> bool:
    """Try a kind of constraint for one step: Drake says only then that its engine has none.

    Args:
        add: The plant's method that adds one between a point of a body and one of another.
        more: Its further arguments.
    """
    builder = DiagramBuilder()
    plant, _ = AddMultibodyPlantSceneGraph(builder, time_step=0.0)
    one, other = (plant.AddRigidBody(name, SpatialInertia.SolidSphereWithMass(1.0, 0.1)) for name in ("one", "other"))
    method: Callable[..., object] = getattr(plant, add)
    method(one, np.zeros(3), other, np.array([0.0, 0.0, sum(more)]), *more)
    plant.Finalize()
    simulator = Simulator(builder.Build())
    ApplySimulatorConfig(SimulatorConfig(integration_scheme="cenic", max_step_size=1e-3), simulator)
    try:
        simulator.AdvanceTo(1e-3)
    except RuntimeError:
        return False
    return True
