"""Bases on wheels with friction in one direction each: they go where Gazebo's go, and where mechanics says."""

import re
from itertools import product
from math import atan2

import numpy as np
import pytest

from drake_twin import TwinBuilder, World
from drake_twin.description.link_surface import Friction

RADIUS, AHEAD, ASIDE = 0.08, 0.25, 0.2
LIGHT = "<inertia><ixx>0.002</ixx><iyy>0.002</iyy><izz>0.002</izz></inertia>"


def wheel(name, x, y, fdir1, *, mu=1.0, mu2=0.0):
    return f"""<link name="{name}"><pose>{x} {y} 0 -1.5707963 0 0</pose><inertial><mass>0.5</mass>{LIGHT}</inertial>
      <collision name="ball"><geometry><sphere><radius>{RADIUS}</radius></sphere></geometry><surface><friction><ode>
        <mu>{mu}</mu><mu2>{mu2}</mu2>{fdir1}</ode></friction></surface></collision></link>
    <joint name="{name}_joint" type="revolute"><parent>chassis</parent><child>{name}</child>
      <axis><xyz>0 0 1</xyz></axis></joint>"""


def mecanum(more="", **friction):
    wheels = "".join(
        wheel(
            f"{end}_{side}",
            x,
            y,
            f'<fdir1 gz:expressed_in="chassis">1 {-1 if x * y > 0 else 1} 0</fdir1>',
            **friction,
        )
        for (end, x), (side, y) in product((("front", AHEAD), ("rear", -AHEAD)), (("left", ASIDE), ("right", -ASIDE)))
    )
    return f"""<sdf version="1.9" xmlns:gz="http://gazebosim.org/schema"><model name="base">
    <pose>0 0 {RADIUS} 0 0 0</pose>
    <link name="chassis"><inertial><mass>8</mass>
      <inertia><ixx>0.1</ixx><iyy>0.2</iyy><izz>0.3</izz></inertia></inertial>
      <collision name="box"><pose>0 0 0.05 0 0 0</pose><geometry><box><size>0.4 0.3 0.08</size></box></geometry>
      </collision>
    </link>{wheels}
    <plugin filename="gz-sim-mecanum-drive-system" name="gz::sim::systems::MecanumDrive">
      <front_left_joint>front_left_joint</front_left_joint><front_right_joint>front_right_joint</front_right_joint>
      <back_left_joint>rear_left_joint</back_left_joint><back_right_joint>rear_right_joint</back_right_joint>
      <wheel_separation>{2 * ASIDE}</wheel_separation><wheelbase>{2 * AHEAD}</wheelbase>
      <wheel_radius>{RADIUS}</wheel_radius></plugin>{more}</model></sdf>"""


def urdf(wheels=("front_left", "front_right", "rear_left", "rear_right"), friction="<mu1>1</mu1><mu2>0</mu2>"):
    """The same base as a URDF with Gazebo's tags; its wheels are driven one by one."""
    text = """<link name="base_footprint"/><joint name="up" type="fixed"><parent link="base_footprint"/>
      <child link="chassis"/><origin xyz="0 0 0.08" rpy="0 0 0"/></joint>
      <link name="chassis"><inertial><mass value="8"/>
        <inertia ixx="0.1" iyy="0.2" izz="0.3" ixy="0" ixz="0" iyz="0"/></inertial></link>"""
    commanded = ""
    for name in wheels:
        x, y = AHEAD if "front" in name else -AHEAD, ASIDE if "left" in name else -ASIDE
        text += f"""<link name="{name}"><inertial><mass value="0.5"/>
            <inertia ixx="0.002" iyy="0.002" izz="0.002" ixy="0" ixz="0" iyz="0"/></inertial>
          <collision><geometry><sphere radius="{RADIUS}"/></geometry></collision></link>
        <joint name="{name}_joint" type="continuous"><parent link="chassis"/><child link="{name}"/>
          <origin xyz="{x} {y} 0"/><axis xyz="0 1 0"/></joint>
        <gazebo reference="{name}">{friction}
          <fdir1 gz:expressed_in="chassis">1 {-1 if x * y > 0 else 1} 0</fdir1></gazebo>"""
        commanded += f'<joint name="{name}_joint"><command_interface name="velocity"/></joint>'
    return f"""<robot name="base" xmlns:gz="http://gazebosim.org/schema">{text}
      <ros2_control name="wheels" type="system">
      <hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>{commanded}</ros2_control></robot>"""


def build(tmp_path, text, controllers=(), **settings):
    suffix = "sdf" if "<sdf" in text else "urdf"
    file = tmp_path / f"base.{suffix}"
    file.write_text(text)
    xyz = (0, 0, RADIUS) if suffix == "sdf" else (0, 0, 0)
    return TwinBuilder(**settings).robot("base", file, xyz=xyz, controllers=controllers).build()


def pose(twin):
    x, y, _, qw, _, _, qz = twin.robot_state("base").base_pose
    return np.array([x, y, 2 * atan2(qz, qw)])


# Command (m/s, m/s, rad/s) → where the chassis is after 3 s (m, m, rad): Gazebo Fortress's own engine (ign-physics 5
# with DART 6.12, 1 ms), the wheels at the velocities of gz-sim's MecanumDrive.
ALONG = {
    (0.4, 0, 0): (1.1885, 0, 0),
    (0, 0.4, 0): (0, 1.1887, 0),
    (0, 0, 0.6): (0, 0, 1.7973),
    (0.2, -0.3, 0): (0.592, -0.8904, 0.0007),
    (0.3, 0.1, 0.5): (0.4127, 0.7492, 1.4895),
    (-0.2, 0.2, -0.4): (-0.144, 0.7786, -1.1972),
}
ACROSS = {(0.4, 0, 0): (1.1885, 0, 0), (0, 0.4, 0): (0, -1.1887, 0)}
CASES = [(1.0, 0.0, *case) for case in ALONG.items()] + [(0.0, 1.0, *case) for case in ACROSS.items()]


@pytest.mark.parametrize("settings", [{}, {"time_step": 0.01}, {"engine": "cenic"}])
@pytest.mark.parametrize(("mu", "mu2", "command", "there"), CASES)
def test_a_mecanum_base_goes_where_gazebos_goes(tmp_path, settings, mu, mu2, command, there):
    twin = build(tmp_path, mecanum(mu=mu, mu2=mu2), **settings)
    assert (twin.findings.not_started, twin.findings.warnings) == ((), ())
    twin.advance_to(0.5)
    linear = {"x": float(command[0]), "y": float(command[1])}
    twin.publish("/base/cmd_vel", {"linear": linear, "angular": {"z": float(command[2])}})
    twin.advance_to(3.5)
    assert pose(twin) == pytest.approx(there, abs=0.01 * max(map(abs, there)))


YAML = """
controller_manager:
  ros__parameters:
    wheels: {{type: velocity_controllers/JointGroupVelocityController}}
wheels:
  ros__parameters:
    joints: [{}]
"""


def driven(tmp_path, text, speeds, until=2.0, **settings):
    """A base whose wheels have had these speeds (rad/s) since 0.5 s."""
    yaml = tmp_path / "wheels.yaml"
    yaml.write_text(YAML.format(", ".join(speeds)))
    twin = build(tmp_path, text, controllers=yaml, **settings)
    twin.advance_to(0.5)
    twin.publish("/base/wheels/commands", {"data": [*speeds.values()]})
    twin.advance_to(until)
    return twin


def velocity(twin):
    twist = twin.latest("/base/ground_truth/odom").twist.twist
    return np.array([twist.linear.x, twist.linear.y, twist.angular.z])


@pytest.mark.parametrize("seed", range(6))
def test_no_wheel_slips_along_its_direction(tmp_path, seed):
    """The closed form: what a wheel's place on the base moves along its direction is what the wheel rolls there."""
    forwards, left, turn = np.random.default_rng(seed).uniform(-0.4, 0.4, 3)
    speeds = {}
    for name, x, y in (
        ("front_left", AHEAD, ASIDE),
        ("front_right", AHEAD, -ASIDE),
        ("rear_left", -AHEAD, ASIDE),
        ("rear_right", -AHEAD, -ASIDE),
    ):
        at_wheel = np.array([forwards - turn * y, left + turn * x])
        direction = np.array([1, -1 if x * y > 0 else 1])
        speeds[f"{name}_joint"] = float(at_wheel @ direction / RADIUS)
    twin = driven(tmp_path, urdf(), speeds)
    assert (twin.findings.not_started, twin.findings.warnings) == ((), ())
    assert velocity(twin) == pytest.approx([forwards, left, turn], abs=2e-3)


def test_a_collision_in_gazebos_tag_says_the_same(tmp_path):
    """Gazebo merges it into the link's, where ``<mu1>`` is ``<mu>``: such wheels slide across without friction."""
    blob = re.sub(
        r"<mu1>1</mu1><mu2>0</mu2>\s*(<fdir1.*?</fdir1>)",
        r"<collision><surface><friction><ode><mu>1</mu><mu2>0</mu2>\1</ode></friction></surface></collision>",
        urdf(),
    )
    twin = build(tmp_path, blob)
    assert twin.findings == ()
    assert twin.built.plans[0].description.surfaces["front_left"].frictions == (Friction(1.0, 0.0),)
    speeds = {"front_left_joint": -5.0, "front_right_joint": 5.0, "rear_left_joint": 5.0, "rear_right_joint": -5.0}
    assert velocity(driven(tmp_path, blob, speeds)) == pytest.approx([0, 0.4, 0], abs=1e-5)


def test_on_the_moon_a_base_grips_with_its_weight_there(tmp_path):
    """The closed form: it speeds up by µ·g/√2, the limit of four wheels that each hold along 45°."""
    speeds = dict.fromkeys(("front_left_joint", "front_right_joint", "rear_left_joint", "rear_right_joint"), 50.0)
    twin = driven(tmp_path, urdf(), speeds, until=1.0, world=World(gravity=(0, 0, -1.62)))
    assert velocity(twin)[0] == pytest.approx(1.62 / 2**0.5 * 0.5, rel=0.03)


def test_a_planar_move_plugin_moves_the_base_in_place_of_its_wheels(tmp_path):
    plugin = '<gazebo><plugin name="move" filename="libgazebo_ros_planar_move.so"/></gazebo></robot>'
    twin = build(tmp_path, urdf().replace("</robot>", plugin))
    kinds = {controller.type for controller in twin.built.plans[0].controllers}
    assert "gazebo_ros/PlanarMove" in kinds
    assert "drake_twin/RollerWheels" not in kinds


def test_what_is_stronger_than_the_friction_stops_the_base(tmp_path):
    wall = tmp_path / "wall.urdf"
    wall.write_text(
        """<robot name="wall"><link name="world"/><link name="wall"><inertial><mass value="50"/>
        <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
        <collision><geometry><box size="0.2 4 1"/></geometry></collision></link><joint name="stands" type="fixed">
        <parent link="world"/><child link="wall"/><origin xyz="0.6 0 0.5"/></joint></robot>"""
    )
    file = tmp_path / "base.sdf"
    file.write_text(mecanum())
    twin = TwinBuilder().robot("base", file, xyz=(0, 0, RADIUS)).robot("wall", wall).build()
    twin.publish("/base/cmd_vel", {"linear": {"x": 0.4}})
    twin.advance_to(4.0)
    assert pose(twin) == pytest.approx([0.5 - AHEAD - RADIUS, 0, 0], abs=1e-3)
    assert twin.robot_state("base").velocities == pytest.approx([0.4 / RADIUS] * 4, rel=0.01)


@pytest.mark.parametrize(
    ("text", "why"),
    [
        (urdf(wheels=("front_left", "rear_right")), "two wheels do not say how a base moves"),
        (urdf(friction="<mu1>1</mu1><mu2>0.5</mu2>"), "the wheels hold across as well"),
        (urdf().replace(' gz:expressed_in="chassis"', ""), "the direction turns with the wheel"),
        (urdf().replace('expressed_in="chassis"', 'expressed_in="front_left"'), "so does this one, with one of them"),
        (urdf().replace('<sphere radius="0.08"/>', '<box size="0.1 0.1 0.16"/>'), "no radius"),
    ],
)
def test_any_other_direction_of_friction_is_a_finding(tmp_path, text, why):
    twin = build(tmp_path, text)
    assert any("friction is the same in all directions" in finding.what for finding in twin.findings), why
    assert not twin.built.plans[0].description.base_joints
