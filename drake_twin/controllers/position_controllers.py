"""The controllers of ROS 2's package position_controllers."""

from drake_twin.controllers.gripper_action_controller import GripperActionController
from drake_twin.controllers.joint_group_controller import JointGroupController
from drake_twin.controllers.registry import controller


@controller("position_controllers/JointGroupPositionController")
class JointGroupPositionController(JointGroupController):
    """Implement ``position_controllers/JointGroupPositionController``."""

    interface = "position"


@controller("position_controllers/GripperActionController")
class PositionGripperActionController(GripperActionController):
    """Implement ``position_controllers/GripperActionController``: the goal's position is commanded."""
