"""Bases drive as commanded on casters of any kind: balls in ball joints, frictionless spheres, swivels."""

from math import atan2, pi

import numpy as np
import pytest
from bases import RADIUS, TRACK, base, caster
from scenes import ENGINES, Scene, every_engine

from drake_twin import TwinBuilder

WHEELS = {"left": (0.0, TRACK / 2), "right": (0.0, -TRACK / 2)}
RATE = 1.0  # rad/s


def link(name, pose, mass, moments, shape):
    ixx, iyy, izz = moments
    return f"""<link name="{name}"><pose>{pose}</pose><inertial><mass>{mass}</mass>
<inertia><ixx>{ixx}</ixx><iyy>{iyy}</iyy><izz>{izz}</izz></inertia></inertial>
<collision name="c"><geometry>{shape}</geometry></collision></link>"""


def small_robot(joint="ball", more=""):
    """SDF of a robot of turtlebot3's size that leans on a ball of 5 mm, whose moment of inertia is absurd as there."""
    wheels = "".join(
        link(f"{side}_wheel", f"0 {y} 0.033 -1.57 0 0", 0.03, (2e-5, 2e-5, 2e-5), cylinder)
        + f"""<joint name="{side}" type="revolute"><parent>base</parent><child>{side}_wheel</child>
<axis><xyz>0 0 1</xyz></axis></joint>"""
        for side, y in (("left", 0.08), ("right", -0.08))
        for cylinder in ["<cylinder><radius>0.033</radius><length>0.018</length></cylinder>"]
    )
    return f"""<sdf version="1.9"><model name="robot">
{link("base", "-0.032 0 0.08 0 0 0", 0.8, (0.003, 0.003, 0.003), "<box><size>0.14 0.14 0.14</size></box>")}{wheels}
{link("ball", "-0.081 0 0.006 -1.57 0 0", 0.005, (1e-3,) * 3, "<sphere><radius>0.005</radius></sphere>")}
<joint name="caster" type="{joint}"><parent>base</parent><child>ball</child></joint>{more}
<plugin filename="gz-sim-diff-drive-system" name="gz::sim::systems::DiffDrive"><left_joint>left</left_joint>
<right_joint>right</right_joint><wheel_separation>0.16</wheel_separation><wheel_radius>0.033</wheel_radius>
<topic>cmd_vel</topic></plugin></model></sdf>"""


def small_twin(folder, engine, **options):
    (folder / "robot.sdf").write_text(small_robot(**options))
    return TwinBuilder(**ENGINES[engine]).robot("robot", folder / "robot.sdf", xyz=(0, 0, 0.001)).build()


def yaw(twin, name):
    w, x, y, z = twin.entities.state(name).orientation
    return atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def turned(twin, name, seconds):
    """By how much a robot turns in a time (rad)."""
    angle, last, end = 0.0, yaw(twin, name), twin.time + seconds
    while twin.time < end - 1e-9:
        twin.advance_to(min(twin.time + 0.1, end))
        now = yaw(twin, name)
        angle += (now - last + pi) % (2 * pi) - pi
        last = now
    return angle


@every_engine
def test_a_base_on_a_caster_ball_turns_in_place_as_commanded(tmp_path, engine):
    twin = small_twin(tmp_path, engine)
    assert "robot: joint caster: its caster ball slides without friction instead of rolling" in twin.findings.warnings
    twin.publish("/robot/cmd_vel", {"linear": {"x": 0.0}, "angular": {"z": RATE}})
    twin.advance_to(2.0)
    assert 0.97 < turned(twin, "robot", 4.0) / (RATE * 4.0) < 1.01


def swivel(x, name):
    """A wheel that trails behind an upright axis."""
    radius, trail = 0.05, 0.03
    return f"""<link name="{name}_fork"><inertial><mass value="0.2"/>
<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{name}_swivel" type="continuous"><parent link="chassis"/><child link="{name}_fork"/>
<origin xyz="{x} 0 0"/><axis xyz="0 0 1"/></joint>
<link name="{name}"><inertial><mass value="0.2"/>
<inertia ixx="2e-4" iyy="3e-4" izz="2e-4" ixy="0" ixz="0" iyz="0"/></inertial><collision><origin rpy="1.5708 0 0"/>
<geometry><cylinder radius="{radius}" length="0.02"/></geometry></collision></link>
<joint name="{name}_roll" type="continuous"><parent link="{name}_fork"/><child link="{name}"/>
<origin xyz="{-trail} 0 {radius - RADIUS}"/><axis xyz="0 1 0"/></joint>"""


@every_engine
@pytest.mark.parametrize("kind", [caster, swivel])
def test_a_base_on_other_casters_turns_in_place_as_commanded(tmp_path, engine, kind):
    urdf = base(WHEELS, caster=kind(0.2, "front") + kind(-0.2, "rear"))
    twin = Scene(tmp_path, engine).add("base", urdf, (0, 0, RADIUS)).build()
    twin.advance_to(0.5)
    speed = RATE * TRACK / 2 / RADIUS
    twin.publish("/base/forward_velocity_controller/commands", [speed, -speed])
    twin.advance_to(3.5)  # by when the swivels trail
    assert 0.97 < abs(turned(twin, "base", 4.0)) / (RATE * 4.0) < 1.01


def drive_figures_of_eight(twin, until):
    """Drives circles to the left and to the right by turns; all links have finite poses all the time."""
    links = [f"robot::{name}" for name in twin.built.plans[0].description.links]
    sign = 1.0
    while twin.time < until - 1e-9:
        twin.publish("/robot/cmd_vel", {"linear": {"x": 0.15}, "angular": {"z": 0.5 * sign}})
        end, sign = min(twin.time + 2 * pi / 0.5, until), -sign
        while twin.time < end - 1e-9:
            twin.advance_to(min(twin.time + 1.0, end))
            for name in links:
                state = twin.entities.state(name)
                assert np.isfinite([*state.position, *state.orientation, *state.linear, *state.angular]).all()
    height = twin.entities.state("robot::ball").position[2]
    assert height == pytest.approx(0.005, abs=1e-3)


@every_engine
def test_figures_of_eight_on_a_caster_ball(tmp_path, engine):
    drive_figures_of_eight(small_twin(tmp_path, engine), 60.0)


@pytest.mark.slow
@pytest.mark.parametrize(("engine", "seconds"), [("1ms", 3600.0), ("10ms", 600.0), ("cenic", 600.0)])
def test_figures_of_eight_on_a_caster_ball_for_long(tmp_path, engine, seconds):
    drive_figures_of_eight(small_twin(tmp_path, engine), seconds)
