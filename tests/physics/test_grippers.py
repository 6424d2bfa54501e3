"""Light fingers that squeeze hard: they stop at what they grip, at any step, and carry it."""

import numpy as np
import pytest
from hands import CONTROLLERS, hand
from scenes import ENGINES, Scene, box, every_engine, plane, position, static

FINGER = """<link name="{name}"><inertial><mass value="0.015"/>
<inertia ixx="2e-6" iyy="2e-6" izz="1e-6" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.02 0.01 0.02"/></geometry></collision></link>
<joint name="{name}_joint" type="prismatic"><parent link="hand"/><child link="{name}"/><axis xyz="0 {inwards} 0"/>
<origin xyz="0 {y} 0"/><limit lower="0" upper="0.05" effort="{force}" velocity="0.2"/></joint>"""
GAP = 0.01  # m, from each pad to the cube
DENSITY = 300.0  # kg/m³


def hand_around(folder, engine, width, force, floor=None):
    """A scene with a hand whose pads are beside what has a width (m)."""
    (folder / "controllers.yaml").write_text(CONTROLLERS)
    y = width / 2 + GAP + 0.005
    fingers = "".join(
        FINGER.format(name=name, y=side * y, inwards=-side, force=force) for name, side in (("left", 1), ("right", -1))
    )
    urdf = hand(fingers, z=max(width / 2, 0.011))
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
    twin.entities.set_joint_positions("gripper", {"left_joint": 0.02})
    twin.publish("/gripper/grip/commands", [effort, 0.0])
    twin.advance_to(0.05)
    velocities = twin.robot_state("gripper").velocities
    assert velocities[1] == pytest.approx(np.copysign(0.2, effort), rel=0.02)
    assert velocities[2] == pytest.approx(0.0, abs=1e-9)


@every_engine
def test_an_effort_that_changes_acts_from_the_next_step_on(tmp_path, engine):
    twin = hand_around(tmp_path, engine, 0.08, 20.0).build()
    step, speed = ENGINES[engine]["time_step"], 0.0
    for number, effort in enumerate((0.02, 0.05, 0.01, -0.03), 1):
        twin.publish("/gripper/grip/commands", [effort, 0.0])
        twin.advance_to(number * step)
        speed += effort / 0.015 * step
        assert twin.robot_state("gripper").velocities[1] == pytest.approx(speed, rel=1e-9)
