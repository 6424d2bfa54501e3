"""A hand that is lifted by a velocity, and squeezes with two fingers by efforts."""

CONTROLLERS = """
controller_manager:
  ros__parameters:
    update_rate: 100
    lift: {type: forward_command_controller/ForwardCommandController}
    grip: {type: forward_command_controller/ForwardCommandController}
lift: {ros__parameters: {joints: [lift_joint], interface_name: velocity}}
grip: {ros__parameters: {joints: [left_joint, right_joint], interface_name: effort}}
"""

_HAND = """<robot name="gripper"><link name="world"/>
<link name="hand"><inertial><mass value="1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lift_joint" type="prismatic"><parent link="world"/><child link="hand"/><axis xyz="0 0 1"/>
<origin xyz="0 0 {z}"/><limit lower="-1" upper="1" effort="500" velocity="1"/></joint>
{fingers}
<ros2_control name="c" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="lift_joint"><command_interface name="velocity"/><state_interface name="position"/></joint>
<joint name="left_joint"><command_interface name="effort"/><state_interface name="position"/></joint>
<joint name="right_joint"><command_interface name="effort"/><state_interface name="position"/></joint>
</ros2_control></robot>"""


def hand(fingers: str, z: float) -> str:
    """URDF of a hand at a height (m), with links and joints called left and right below its link ``hand``."""
    return _HAND.format(fingers=fingers, z=z)
