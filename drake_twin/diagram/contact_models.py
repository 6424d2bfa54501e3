"""The owners of shapes: robots and moving models of the world."""

from collections.abc import Collection, Mapping
from dataclasses import field

from pydrake.math import RigidTransform
from pydrake.multibody.tree import ModelInstanceIndex

from drake_twin.dataclass import dataclass


@dataclass(frozen=True)
class ContactModel:
    """A robot or a moving model of the world.

    Attributes:
        name: Its name.
        instances: Its model instances.
        contact: ``hydroelastic`` or ``point``.
        root_pose: The pose of its root body in the world at the start; None for the plant's default pose.
        colliding: The bodies that collide with others of the same model; None for all of them.
        friction: The coefficient of friction of all its shapes; None for those of its file.
        folded: Body → the body into which Gazebo folds it, for those of a URDF on fixed joints whose
            links collide with each other.
    """

    name: str
    instances: tuple[ModelInstanceIndex, ...]
    contact: str
    root_pose: RigidTransform | None = None
    colliding: Collection[str] | None = ()
    friction: float | None = None
    folded: Mapping[str, str] = field(default_factory=dict)
