"""Forces on links that follow from their motion and from commands: what air, water and propellers do.

A kind of them is two classes in one file: a `ForceController`, one for each robot, with its parameters and topics, and
its `BodyForces`, which computes in NumPy what all controllers of the kind exert, in one call for each evaluation. One
system of the diagram, `drake_twin.controllers.applied_forces.AppliedForces`, reads the motion of the bodies once for
all kinds, and Drake's own `Propeller` applies the sums.
"""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from functools import cached_property
from typing import Any, ClassVar

import numpy as np
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, ModelInstanceIndex, RigidBody
from pydrake.systems.framework import Context

from drake_twin.controllers.base_controller import ControllerSetup
from drake_twin.dataclass import dataclass
from drake_twin.description.drake_urdf import drake_link_name
from drake_twin.description.robot_description import RobotDescription


@dataclass(frozen=True)
class RobotBody:
    """A robot in the plant, as forces on its links are built from it.

    Attributes:
        plant: The finalized plant.
        instance: The robot's model instance.
    """

    plant: MultibodyPlant
    instance: ModelInstanceIndex

    def link(self, name: str) -> RigidBody:
        """Return a link's body."""
        return self.plant.GetBodyByName(drake_link_name(name), self.instance)

    def joint(self, name: str) -> Joint:
        """Return a joint."""
        return self.plant.GetJointByName(name, self.instance)

    def pose(self, body: RigidBody, relative_to: RigidBody) -> RigidTransform:
        """Return the pose of a body in another one's frame, with all joints at their initial positions."""
        context = self.plant.CreateDefaultContext()
        frames = relative_to.body_frame(), body.body_frame()
        pose: RigidTransform = self.plant.CalcRelativeTransform(context, *frames)
        return pose

    def place_of(self, index: int) -> int:
        """Return the index in the plant's ``[q; v]`` of a generalized velocity."""
        return int(self.plant.num_positions() + index)

    @cached_property
    def gravity(self) -> np.ndarray:
        """The acceleration of free fall in the world frame (m/s²)."""
        return np.array(self.plant.gravity_field().gravity_vector())


class Motion:
    """How bodies move at one time. What is not asked for is not gathered; what is asked for twice is gathered twice.

    Args:
        time: The time (s); of a plant with steps the middle of the step, since forces are constant in it.
        state: The plant's ``[q; v]``.
        rotations: The orientation R_WB of each body that forces act on (m×3×3).
        origins: The place of its origin in the world frame (m×3, m).
        velocities: Its velocity, in its own axes (m×6): angular (rad/s), then that of its origin (m/s).
        places: The index there of each body that is meant (n), or a slice.
        applied: The wrenches that the kinds before this one exert on each, about its origin and in its own axes (m×6);
            None for no such wrenches.
        wind: The velocity of the air in the world frame (m/s); None for still air.

    Attributes:
        time: The time (s).
        state: The plant's ``[q; v]``.
        wind: The velocity of the air in the world frame (m/s); None for still air.
    """

    __slots__ = ("_applied", "_origins", "_places", "_rotations", "_velocities", "state", "time", "wind")

    def __init__(
        self,
        time: float,
        state: np.ndarray,
        rotations: np.ndarray,
        origins: np.ndarray,
        velocities: np.ndarray,
        places: np.ndarray | slice,
        applied: np.ndarray | None = None,
        wind: np.ndarray | None = None,
    ):
        self.time, self.state, self.wind = time, state, wind
        self._rotations, self._origins, self._velocities = rotations, origins, velocities
        self._places, self._applied = places, applied

    @property
    def R_WB(self) -> np.ndarray:
        """The orientation of each body, shape (n, 3, 3)."""
        rotations: np.ndarray = self._rotations[self._places]
        return rotations

    @property
    def origins(self) -> np.ndarray:
        """The place of its origin in the world frame (n×3, m)."""
        origins: np.ndarray = self._origins[self._places]
        return origins

    @property
    def V_B(self) -> np.ndarray:
        """Its velocity, in its own axes (n×6): angular (rad/s), then that of its origin (m/s)."""
        velocities: np.ndarray = self._velocities[self._places]
        return velocities

    @property
    def applied(self) -> np.ndarray:
        """The wrenches that the kinds before this one exert on it, about its origin and in its own axes (n×6)."""
        if self._applied is None:
            return np.zeros_like(self.V_B)
        applied: np.ndarray = self._applied[self._places]
        return applied


class BodyForces(ABC):
    """The forces that all controllers of one kind exert.

    Args:
        sources: The controllers and their robots.

    Attributes:
        bodies: The bodies whose motion is needed and on which the forces act; one may be there more than once.
        is_last: Whether the forces follow from those of all kinds that are not last.
    """

    bodies: Sequence[RigidBody]
    is_last: ClassVar[bool] = False

    @abstractmethod
    def __init__(self, sources: "Sequence[tuple[ForceController, RobotBody]]"):
        """Prepare what does not change; `bodies` has to be set."""

    def follow(self, plant_context: Context) -> None:
        """Follow masses and inertias that differ from those as built; without effect on forces that have none.

        Args:
            plant_context: The plant's context.
        """
        del plant_context

    @abstractmethod
    def wrenches(self, motion: Motion, signals: np.ndarray) -> np.ndarray:
        """Return the wrench on each of the `bodies` about its origin, in its own axes (n×6): N·m, then N.

        Args:
            motion: How the `bodies` move, in their order.
            signals: The controllers' ports ``signals``, one after the other.
        """


class ForceController:
    """What a controller has beside its base that exerts forces on the robot's links.

    Its output port ``signals`` is a vector: what the forces follow from beside the motion.

    Attributes:
        Forces: The class that computes them.
        setup: What the controller was built from; a controller has it.
        body: The robot in the plant; None in a controller that stands alone.
    """

    Forces: ClassVar[type[BodyForces]]
    setup: ControllerSetup
    body: RobotBody | None = None

    @classmethod
    def links(cls, parameters: Any) -> Sequence[str]:
        """Return the links that a controller with these parameters needs."""
        return (parameters.link_name,)

    @classmethod
    def problem(cls, parameters: Any, description: RobotDescription) -> str | None:
        """Return which link the robot does not have; None if it has all."""
        missing = next((link for link in cls.links(parameters) if link not in description.links), None)
        return None if missing is None else f"the robot has no link {missing!r}"

    def attach(self, body: RobotBody) -> None:
        """Note the robot in the plant, before the first event or output."""
        self.body = body
