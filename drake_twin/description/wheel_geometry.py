"""The positions and radii of a robot's wheels, for plugins that take both from the model."""

from collections.abc import Sequence

import numpy as np

from drake_twin.description.robot_description import RobotDescription
from drake_twin.description.xml_reader import XmlReader


def link_poses(description: RobotDescription) -> dict[str, np.ndarray]:
    """Compute each link's pose in the root link, as a homogeneous 4×4 matrix (m), with all joints at zero."""
    poses = {description.root_link: np.eye(4)}
    waiting = [*description.joints]
    while waiting:
        placed = [joint for joint in waiting if joint.parent in poses]
        for joint in placed:
            origin, child_origin = (pose.transform().GetAsMatrix4() for pose in (joint.origin, joint.child_origin))
            poses[joint.child] = poses[joint.parent] @ origin @ child_origin
        waiting = [joint for joint in waiting if joint not in placed] if placed else []
    return poses


def wheel_centers(description: RobotDescription, joints: Sequence[str]) -> tuple[np.ndarray, ...]:
    """Compute the origins of joints' child links in the root link (m), with all joints at zero."""
    poses = link_poses(description)
    return tuple(poses[description.joints_by_name[name].child][:3, 3] for name in joints)


def wheel_radius(description: RobotDescription, joint: str) -> float | None:
    """Return the radius (m) of the first cylinder or sphere of a joint's child link; None without one."""
    link = description.joints_by_name[joint].child
    for element in XmlReader(description.text).root.iter("link"):
        if element.get("name") == link:
            for shape in element.iterfind("collision/geometry/*"):
                radius = shape.get("radius") or shape.findtext("radius")  # URDF's form, then SDF's
                if shape.tag in ("cylinder", "sphere") and radius:
                    return float(radius)
    return None
