"""``<static>`` in the ``<gazebo>`` tag of a URDF, and bounds that are not numbers."""

import pytest

from drake_twin import Twin, TwinBuilder
from drake_twin.findings import Kind

LINK = """<link name="l"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.2 1 2"/></geometry></collision></link>"""


def built(folder, text) -> Twin:
    (folder / "wall.urdf").write_text(f'<robot name="wall">{LINK}{text}</robot>')
    return TwinBuilder().robot("wall", str(folder / "wall.urdf"), xyz=(0, 0, 3)).build()


@pytest.mark.parametrize(("text", "falls"), [("true", False), ("1", False), ("false", True)])
def test_a_static_robot_stays_where_it_is(tmp_path, text, falls):
    twin = built(tmp_path, f"<gazebo><static>{text}</static></gazebo>")
    twin.advance_to(0.5)
    assert (twin.robot_state("wall").base_pose[2] < 2.9) is falls
    assert not [item for item in twin.findings if "static" in item.what]


def test_a_bound_that_is_not_a_number_is_skipped_as_in_ros2_control(tmp_path):
    text = """<link name="arm"><inertial><mass value="1"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
    <joint name="j" type="revolute"><parent link="l"/><child link="arm"/><axis xyz="0 0 1"/>
    <limit lower="-1" upper="1" effort="5" velocity="2"/></joint>
    <ros2_control name="c" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
    <joint name="j"><command_interface name="position"><param name="min">{-2*pi}</param><param name="max">0.5</param>
    </command_interface><state_interface name="position"/></joint></ros2_control>"""
    twin = built(tmp_path, text)
    (interface,) = twin.built.plans[0].description.controlled_joints["j"].command_interfaces
    assert (interface.min, interface.max) == (float("-inf"), 0.5)
    (finding,) = [item for item in twin.findings if "-2*pi" in item.what]
    assert (finding.kind, finding.lines) == (Kind.IGNORED, (8,))
