"""Whether Drake has surfaces that move along their body, as those of belts and tracks."""

from functools import cache

# Its first release with them has no wheel for an older Python.
NEEDS = "a moving surface needs Drake 1.56 or newer, which needs Python 3.12 or newer"


@cache
def has_surface_velocity() -> bool:
    """Ask Drake for the method that gives a body such a surface."""
    from pydrake.multibody.plant import MultibodyPlant

    return hasattr(MultibodyPlant, "SetSurfaceVelocityAxis")
