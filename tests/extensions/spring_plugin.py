"""A Gazebo plugin of somebody else's, in one file: it holds a joint at an angle."""

from drake_twin.description.gazebo_drive import GazeboDrive, gazebo_plugin


@gazebo_plugin("libothers_spring.so")
def spring(plugin):
    joints = plugin.joints("joint")
    return GazeboDrive(
        plugin.plugin,
        plugin.controller("position_controllers/JointGroupPositionController", {"joints": list(joints)}),
        interfaces=tuple((joint, "position") for joint in joints),
        start={joint: plugin.number("angle", 0.0) for joint in joints},
    )
