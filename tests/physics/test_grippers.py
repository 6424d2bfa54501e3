"""Light fingers that squeeze hard: they stop at what they grip, at any step, and carry it."""

import numpy as np
import pytest
from scenes import Scene, box, every_engine, plane, position, static

FINGER = """<link name="{name}"><inertial><mass value="0.015"/>
<inertia ixx="2e-6" iyy="2e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.02 0.01 0.02"/></geometry></collision></link>
<joint name="{name}_joint" type="prismatic"><parent link="hand"/><child link="{name}"/><axis xyz="0 {inwards} 0"/>
<origin xyz="0 {y} 0"/><limit lower="0" upper="0.05" effort="{force}" velocity="0.2"/></joint>"""
HAND = """<robot name="gripper"><link name="world"/>
<link name="hand"><inertial><mass value="0.7"/>
<inertia ixx="0.001" iyy="0.001" izz="0.001" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="lift_joint" type="prismatic"><parent link="world"/><child link="hand"/><axis xyz="0 0 1"/>
<origin xyz="0 0 {z}"/><limit lower="-1" upper="1" effort="500" velocity="1"/></joint>
{fingers}
<ros2_control name="c" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>
<joint name="lift_joint"><command_interface name="velocity"/><state_interface name="position"/></joint>
<joint name="left_joint"><command_interface name="effort"/><state_interface name="position"/></joint>
<joint name="right_joint"><command_interface name="effort"/><state_interface name="position"/></joint>
</ros2_control></robot>"""
CONTROLLERS = """
controller_manager:
  ros__parameters:
    update_rate: 100
    lift: {type: forward_command_controller/ForwardCommandController}
    grip: {type: forward_command_controller/ForwardCommandController}
lift: {ros__parameters: {joints: [lift_joint], interface_name: velocity}}
grip: {ros__parameters: {joints: [left_joint, right_joint], interface_name: effort}}
"""
GAP = 0.01  # m, from each pad to the cube
DENSITY = 300.0  # kg/m³


def hand_around(folder, engine, width, force, floor=None):
    """A scene with a hand whose pads are beside what has a width (m)."""
    (folder / "controllers.yaml").write_text(CONTROLLERS)
    y = width / 2 + GAP + 0.005
    fingers = "".join(
        FINGER.format(name=name, y=side * y, inwards=-side, force=force) for name, side in (("left", 1), ("right", -1))
    )
    urdf = HAND.format(fingers=fingers, z=max(width / 2, 0.011))
    return Scene(folder, engine, floor).add("gripper", urdf, (0, 0, 0), controllers=folder / "controllers.yaml")


@pytest.mark.parametrize("force", [5.0, 20.0, 70.0])
@pytest.mark.parametrize("width", [0.01, 0.04, 0.08])
@every_engine
def test_light_fingers_hold_a_cube_while_the_hand_moves(tmp_path, engine, width, force):
    scene = hand_around(tmp_path, engine, width, force)
    twin = scene.add("cube", box((width,) * 3, DENSITY * width**3), (0, 0, width / 2)).build()
    twin.publish("/gripper/grip/commands", [force, force])
    twin.advance_to(0.5)
    hand, *_ = before = twin.robot_state("gripper").positions
    height = position(twin, "cube")[2] - hand
    for speed in (*np.linspace(0, 0.1, 26)[1:], *np.linspace(0.1, -0.1, 51), *np.linspace(-0.1, 0, 26)):  # up and down
        twin.publish("/gripper/lift/commands", [float(speed)])
        twin.advance_to(twin.time + 0.02)
    hand, *fingers = twin.robot_state("gripper").positions
    assert position(twin, "cube")[2] - hand == pytest.approx(height, abs=1e-3)
    assert fingers == pytest.approx([GAP, GAP], abs=max(2e-3, 0.05 * width))
    assert fingers == pytest.approx(before[1:], abs=5e-4)


@pytest.mark.parametrize("force", [5.0, 70.0])
@every_engine
def test_a_light_fingertip_stops_at_a_wall(tmp_path, engine, force):
    wall = static("<box><size>0.5 0.02 0.5</size></box>", (0, 0, 0.25, 0, 0, 0), name="wall")
    twin = hand_around(tmp_path, engine, 0.02, force, wall + plane()).build()
    twin.publish("/gripper/grip/commands", [force, force])
    for time in np.arange(0.02, 1.0, 0.02):
        twin.advance_to(float(time))
        assert max(twin.robot_state("gripper").positions[1:]) < GAP + 2e-3
    assert twin.robot_state("gripper").positions[1:] == pytest.approx([GAP, GAP], abs=2e-4)


@pytest.mark.parametrize("effort", [2.0, 20.0, -20.0])
@every_engine
def test_an_effort_drives_a_joint_up_to_its_velocity_limit(tmp_path, engine, effort):
    twin = hand_around(tmp_path, engine, 0.08, 20.0).build()
    twin.set_joint_positions("gripper", {"left_joint": 0.02}) if effort < 0 else None
    twin.publish("/gripper/grip/commands", [effort, 0.0])
    twin.advance_to(0.05)
    velocities = twin.robot_state("gripper").velocities
    assert velocities[1] == pytest.approx(np.copysign(0.2, effort), rel=0.02)
    assert velocities[2] == pytest.approx(0.0, abs=1e-9)
