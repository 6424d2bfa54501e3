"""The positions and radii of a robot's wheels, for plugins that take both from the model."""

from collections.abc import Sequence

import numpy as np

from drake_twin.description.robot_description import Pose, RobotDescription
from drake_twin.description.xml_reader import XmlReader


def wheel_centers(description: RobotDescription, joints: Sequence[str]) -> tuple[np.ndarray, ...]:
    """Compute the origins of joints' child links in the root link (m), with all joints at zero."""
    joint_of = {joint.child: joint for joint in description.joints}
    centers = []
    for name in joints:
        pose = np.eye(4)
        link = description.joints_by_name[name].child
        while link in joint_of:
            joint = joint_of[link]
            pose = _matrix(joint.origin) @ _matrix(joint.child_origin) @ pose
            link = joint.parent
        centers.append(pose[:3, 3])
    return tuple(centers)


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


def _matrix(pose: Pose) -> np.ndarray:
    (roll, pitch, yaw), matrix = pose.rpy, np.eye(4)
    (cr, cp, cy), (sr, sp, sy) = np.cos([roll, pitch, yaw]), np.sin([roll, pitch, yaw])
    matrix[:3, :3] = [
        [cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr],
        [sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr],
        [-sp, cp * sr, cp * cr],
    ]
    matrix[:3, 3] = pose.xyz
    return matrix
