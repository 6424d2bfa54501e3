"""Forces of the world on all that moves in it: what plugins of a world become, and the registry of them.

A kind is one class in one file, with the decorator `world_forces`. It computes in NumPy what it exerts on all bodies,
as the `BodyForces` of robots do.
"""

from abc import abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import Any, ClassVar, TypeVar

import numpy as np
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody

from drake_twin.control.submerged import Solid
from drake_twin.controllers.body_forces import BodyForces
from drake_twin.dataclass import dataclass
from drake_twin.extensions import Registry


@dataclass(frozen=True)
class MovingBody:
    """A body on which the world may exert forces.

    Attributes:
        body: The body.
        name: Its model, the models in that and the link, as gz-sim has them: ``MODEL::LINK``.
        solids: Its collision shapes that have a volume.
        feels_wind: Whether it has ``<enable_wind>``.
    """

    body: RigidBody
    name: str
    solids: Sequence[Solid]
    feels_wind: bool = False


@dataclass(frozen=True)
class WorldBodies:
    """What moves in a world.

    Attributes:
        plant: The finalized plant.
        moving: The bodies of robots and moving models that are not welded to the world.
    """

    plant: MultibodyPlant
    moving: Sequence[MovingBody]

    @cached_property
    def gravity(self) -> np.ndarray:
        """The acceleration of free fall in the world frame (m/s²)."""
        return np.array(self.plant.gravity_field().gravity_vector())


class WorldForces(BodyForces):
    """The forces of a plugin of the world.

    Args:
        parameters: Its parameters.
        world: What moves.

    Attributes:
        has_wind_signal: Whether its one signal is whether the world's wind blows; else it has none.
    """

    has_wind_signal: ClassVar[bool] = False

    @abstractmethod
    def __init__(self, parameters: Any, world: WorldBodies):
        """Prepare what does not change; `bodies` has to be set."""


WORLD_FORCES: Registry[type[WorldForces]] = Registry(
    "force of a world", "world_forces", "drake_twin.world_forces", ["drake_twin.controllers"]
)

_T = TypeVar("_T", bound=type[WorldForces])


def world_forces(name: str) -> Callable[[_T], _T]:
    """Register a class of forces under the type that a plugin of the world asks for."""

    def register(kind: _T) -> _T:
        WORLD_FORCES.add(name, kind, kind)
        return kind

    return register
