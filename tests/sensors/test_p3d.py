"""The true pose and twist of a link, against what it was given."""

import pytest
from rig import twin_with, xyz


def test_p3d_is_the_true_pose_and_twist_in_the_world(tmp_path):
    plugin = """<gazebo><plugin name="truth" filename="libgazebo_ros_p3d.so"><body_name>box</body_name>
      <xyz_offset>1 2 3</xyz_offset><ros><remapping>odom:=truth/odom</remapping></ros></plugin></gazebo>"""
    twin = twin_with(tmp_path, plugin, xyz=(0, 0, 50))
    twin.entities.set_state("box", position=(4, 5, 60), linear=(1, 2, 0), angular=(0, 0, 1))
    message = twin.latest("/box/truth/odom")
    assert xyz(message.pose.pose.position) == pytest.approx([5, 7, 63])
    assert xyz(message.twist.twist.linear) == pytest.approx([1, 2, 0])
    assert xyz(message.twist.twist.angular) == pytest.approx([0, 0, 1])
    assert (message.header.frame_id, message.child_frame_id) == ("world", "box/box")
