"""The controller of ROS 2's package velocity_controllers."""

from drake_twin.controllers.joint_group_controller import JointGroupController
from drake_twin.controllers.registry import controller


@controller("velocity_controllers/JointGroupVelocityController")
class JointGroupVelocityController(JointGroupController):
    """Implement ``velocity_controllers/JointGroupVelocityController``."""

    interface = "velocity"
