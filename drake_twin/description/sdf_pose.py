"""A ``<pose>`` of SDF."""

from typing import TYPE_CHECKING

import numpy as np
from lxml import etree

from drake_twin.description.xml_reader import XmlReader
from drake_twin.values import is_true, needed, parse_number

if TYPE_CHECKING:
    from pydrake.math import RigidTransform


def pose_transform(pose: etree._Element) -> "RigidTransform":
    """Read a ``<pose>`` as Drake's transform, whatever the format of its rotation.

    Raises:
        ValueError: If the numbers are not a pose; the message says why.
    """
    from pydrake.common.eigen_geometry import Quaternion
    from pydrake.math import RigidTransform, RollPitchYaw

    values = np.array([parse_number(part) for part in (pose.text or "").split()])
    if not len(values):
        return RigidTransform()
    if pose.get("rotation_format") == "quat_xyzw":
        if len(values) != 7:
            raise ValueError(needed(7))
        quaternion = np.roll(values[3:], 1)
        return RigidTransform(Quaternion(quaternion / np.linalg.norm(quaternion)), values[:3])
    if len(values) != 6:
        raise ValueError(needed(6))
    angles = np.radians(values[3:]) if is_true(pose.get("degrees")) else values[3:]
    return RigidTransform(RollPitchYaw(*angles), values[:3])


def transform_of(pose: etree._Element, reader: XmlReader) -> "RigidTransform":
    """Read a ``<pose>`` as Drake's transform.

    Raises:
        InputError: If the numbers are not a pose.
    """
    try:
        return pose_transform(pose)
    except ValueError as error:
        raise reader.error(pose, f"{pose.text!r} is not a pose ({error})") from None
