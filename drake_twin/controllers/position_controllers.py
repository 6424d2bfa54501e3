"""The controllers of ROS 2's package position_controllers."""

from drake_twin.controllers.gripper_action_controller import GripperActionController, GripperActionParameters
from drake_twin.controllers.interface import Interface
from drake_twin.controllers.joint_group_controller import JointGroupController
from drake_twin.controllers.registry import controller
from drake_twin.description.robot_description import RobotDescription


@controller("position_controllers/JointGroupPositionController")
class JointGroupPositionController(JointGroupController):
    """Implement ``position_controllers/JointGroupPositionController``."""

    interface = "position"


@controller("position_controllers/GripperActionController")
class PositionGripperActionController(GripperActionController):
    """Implement ``position_controllers/GripperActionController``: the goal's position is commanded."""

    @classmethod
    def claimed_interfaces(
        cls, parameters: GripperActionParameters, description: RobotDescription
    ) -> tuple[Interface, ...]:
        """Return the joint's position."""
        return (Interface(parameters.joint, "position"),)
