"""What shapes belong to: things that touch each other."""

from collections.abc import Collection
from dataclasses import dataclass

from pydrake.math import RigidTransform
from pydrake.multibody.tree import ModelInstanceIndex


@dataclass(frozen=True)
class ContactModel:
    """A robot, or something that moves in the world.

    Attributes:
        name: Its name.
        instances: Its model instances.
        contact: ``hydroelastic`` or ``point``.
        root_pose: Its root body in the world at the start; None for the default pose that the plant has of it.
        colliding: The bodies that collide with others of the same model; None for all of them.
    """

    name: str
    instances: tuple[ModelInstanceIndex, ...]
    contact: str
    root_pose: RigidTransform | None = None
    colliding: Collection[str] | None = ()
