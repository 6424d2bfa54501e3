"""A ``<pose>`` of SDF."""

import numpy as np
from lxml import etree


def pose_transform(pose: etree._Element):  # type: ignore[no-untyped-def]  # pydrake types stay in this module
    """A ``<pose>`` as Drake's transform, whatever the format of its rotation.

    Raises:
        ValueError: it is no pose.
    """
    from pydrake.common.eigen_geometry import Quaternion
    from pydrake.math import RigidTransform, RollPitchYaw

    values = np.array([float(part) for part in (pose.text or "").split()])
    if not len(values):
        return RigidTransform()
    if not np.all(np.isfinite(values)):
        raise ValueError("not finite")
    if pose.get("rotation_format") == "quat_xyzw":
        if len(values) != 7:
            raise ValueError("seven numbers are needed")
        quaternion = np.roll(values[3:], 1)
        return RigidTransform(Quaternion(quaternion / np.linalg.norm(quaternion)), values[:3])
    if len(values) != 6:
        raise ValueError("six numbers are needed")
    angles = np.radians(values[3:]) if pose.get("degrees", "").lower() in ("1", "true") else values[3:]
    return RigidTransform(RollPitchYaw(*angles), values[:3])
