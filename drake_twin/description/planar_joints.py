"""The joints between world and root link of a robot that Gazebo moves over the plane without any.

They are commanded like the robot's own joints, by the controller that replaces the plugin, but are not joints of the
robot: ``joint_states``, ``/tf`` and the robot's text do not have them.
"""

from drake_twin.description.robot_description import Joint

# A slash would make them another controller's references.
LINEAR_X, LINEAR_Y, LINEAR_Z, ANGULAR_Z = "base.linear.x", "base.linear.y", "base.linear.z", "base.angular.z"

_COMMANDED = {
    LINEAR_X: ("prismatic", (1.0, 0.0, 0.0)),
    LINEAR_Y: ("prismatic", (0.0, 1.0, 0.0)),
    ANGULAR_Z: ("continuous", (0.0, 0.0, 1.0)),
}


def commanded_planar_joints(root_link: str) -> tuple[Joint, ...]:
    """Return the commanded joints: along x and y, and about z; along z the base is free to rest on the ground."""
    return tuple(Joint(name, kind, "world", root_link, axis=axis) for name, (kind, axis) in _COMMANDED.items())
