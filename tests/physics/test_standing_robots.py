"""Robots that servos hold stand still: on legs whose feet weigh nothing, on a slope on wheels, and those of others."""

import sysconfig
from dataclasses import replace
from math import radians
from pathlib import Path

import numpy as np
import pytest
from conftest import ROVER
from lxml import etree
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from scenes import ENGINES, G, Scene, every_engine, farthest_from, on_slope, plane, position, velocity, world

from drake_twin import InputError, Twin, TwinBuilder
from drake_twin.diagram.lumped_masses import with_lumped_masses
from drake_twin.scenario import World

SHARE = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix" / "share"
DATA = SHARE / "example-robot-data" / "robots"
QUADRUPEDS = {
    "hyq": "hyq_description/robots/hyq_no_sensors",
    "anymal": "anymal_b_simple_description/robots/anymal",
    "a1": "a1_description/urdf/a1",
    "go1": "go1_description/urdf/go1",
}

SHIN = """<link name="{name}"><inertial><origin xyz="0 0 -0.1"/><mass value="0.4"/>
<inertia ixx="0.002" iyy="0.002" izz="0.0004" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="{name}_foot"><inertial><origin xyz="0.001 0 0" rpy="0 0.3 0"/><mass value="1e-6"/>
<inertia ixx="1e-8" iyy="1e-8" izz="1e-8" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><sphere radius="0.02"/></geometry></collision></link>
<joint name="{name}_ankle" type="fixed"><parent link="{name}"/><child link="{name}_foot"/>
<origin xyz="0 0 -0.2"/></joint>
<joint name="{name}_joint" type="revolute"><parent link="trunk"/><child link="{name}"/><origin xyz="{x} {y} 0"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="20" velocity="20"/></joint>"""
LEGS = {
    f"{end}_{side}": (x, y)
    for end, x in (("front", 0.2), ("hind", -0.2))
    for side, y in (("left", 0.13), ("right", -0.13))
}
MASS = 8.0 + 4 * 0.4

# What a parked rover creeps on 25° at a step of 1 s (mm/s): Drake lets a sticking contact slip in proportion to the
# step, and CENIC takes one of 10 ms at most here. At 1 ms the stiction tolerance adds to it.
CREEP = {"1ms": 14.0, "10ms": 14.0, "cenic": 25.0}


def servos(joints, interface="position"):
    """What commands the joints of a URDF."""
    commanded = "".join(
        f'<joint name="{joint}"><command_interface name="{interface}"/><state_interface name="position"/></joint>'
        for joint in joints
    )
    return (
        '<ros2_control name="c" type="system"><hardware><plugin>gz_ros2_control/GazeboSimSystem</plugin></hardware>'
        f"{commanded}</ros2_control>"
    )


def dog():
    legs = "".join(SHIN.format(name=name, x=x, y=y) for name, (x, y) in LEGS.items())
    return f"""<robot name="dog"><link name="trunk"><inertial><mass value="8"/>
<inertia ixx="0.03" iyy="0.1" izz="0.12" ixy="0" ixz="0" iyz="0"/></inertial></link>{legs}
{servos(f"{name}_joint" for name in LEGS)}</robot>"""


@every_engine
def test_a_robot_on_feet_without_mass_stands_and_is_not_pushed_away(figure, tmp_path, engine):
    stance = {f"{name}_joint": 0.3 if name.startswith("front") else -0.3 for name in LEGS}
    twin = Scene(tmp_path, engine).add("dog", dog(), (0, 0, 0.22), initial_positions=stance).build()
    twin.advance_to(2.0)
    moved = farthest_from(twin, "dog", position(twin, "dog"), 6.0)
    assert figure("robot on four feet, 4 s: moves (mm)", 1e3 * moved) < 1e-3
    twin.entities.apply_wrench("dog", force=(0.0, 0.2 * MASS * G, 0.0), duration=2.0)
    twin.advance_to(7.9)
    slips = abs(velocity(twin, "dog")[1])
    assert figure("pushed by 0.2 of its weight: slips (mm/s)", 1e3 * slips) < 1.0


@every_engine
def test_a_parked_rover_creeps_no_more_than_the_solvers_regularization_asks(figure, tmp_path, engine):
    tilt = radians(25.0)
    file = tmp_path / "world.sdf"
    file.write_text(world(plane(tilt)))
    builder = TwinBuilder(world=World(file=str(file)), **ENGINES[engine])
    twin = builder.robot("rover", ROVER, xyz=on_slope(tilt, z=0.13), rpy=(0, tilt, 0)).build()
    twin.advance_to(3.0)
    before = position(twin, "rover")
    twin.advance_to(8.0)
    creep = 1e3 * np.linalg.norm(position(twin, "rover") - before) / 5.0
    assert figure("rover parked on 25°: creeps (mm/s)", creep) < CREEP[engine] * ENGINES[engine]["time_step"]
    assert np.linalg.norm(np.array(twin.entities.state("rover").angular)) < 1e-5


def stance_of(robot):
    """URDF of one of example-robot-data with position servos, its stance and its height above the ground (m)."""
    file = DATA / f"{QUADRUPEDS[robot]}.urdf"
    srdf = file.parent.parent / "srdf" / f"{robot}.srdf"
    state = etree.parse(srdf).find("group_state[@name='standing']")
    values = {joint.get("name"): [float(value) for value in joint.get("value").split()] for joint in state}
    height = values.pop("root_joint")[2]
    stance = {joint: value for joint, (value,) in values.items()}
    return file.read_text().replace("</robot>", servos(stance) + "</robot>"), stance, height


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="example-robot-data is not installed: pip install '.[corpus]'")
@every_engine
@pytest.mark.parametrize("robot", QUADRUPEDS)
def test_quadrupeds_that_nobody_here_wrote_stand_still(figure, tmp_path, engine, robot):
    urdf, stance, height = stance_of(robot)
    file = tmp_path / f"{robot}.urdf"
    file.write_text(urdf)
    builder = TwinBuilder(**ENGINES[engine]).package_path(SHARE)
    twin = builder.robot(robot, file, xyz=(0, 0, height + 0.01), initial_positions=stance).build()
    twin.advance_to(5.0)
    moved = farthest_from(twin, robot, position(twin, robot), 65.0, every=1.0)
    assert figure("quadrupeds of example-robot-data stand, 60 s: move (mm)", 1e3 * moved) < 0.1


TILTED = '<origin xyz="0.1 -0.2 0.3" rpy="0.4 -0.5 0.6"/>'
LUMPS = f"""<robot name="r"><link name="a"><collision/><inertial>{TILTED}<mass value="0.5"/>
<inertia ixx="0.02" iyy="0.03" izz="0.04" ixy="0.001" ixz="-0.002" iyz="0.003"/></inertial></link>
<link name="b"><inertial><mass value="2"/>
<inertia ixx="0.2" iyy="0.3" izz="0.4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="c"><collision/><inertial><origin xyz="0.5 0 0"/><mass value="0.25"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<link name="d"><collision/><inertial><mass value="0.1"/>
<inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="ab" type="fixed"><parent link="a"/><child link="b"/>{TILTED}</joint>
<joint name="bc" type="fixed"><parent link="b"/><child link="c"/><origin xyz="0 1 0" rpy="1 0 0"/></joint>
<joint name="bd" type="revolute"><parent link="b"/><child link="d"/><axis xyz="1 0 0"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>"""


def inertia_in_drake(urdf):
    """The spatial inertia of the links a, b and c together, about a's origin, and the mass of each."""
    plant = MultibodyPlant(0.0)
    Parser(plant).AddModelsFromString(urdf, "urdf")
    plant.Finalize()
    bodies = [plant.GetBodyByName(name) for name in "abc"]
    context = plant.CreateDefaultContext()
    inertia = plant.CalcSpatialInertia(context, plant.GetFrameByName("a"), [body.index() for body in bodies])
    return inertia.CopyToFullMatrix6(), [body.default_mass() for body in (*bodies, plant.GetBodyByName("d"))]


def test_lumped_masses_move_as_before():
    before, masses = inertia_in_drake(LUMPS)
    after, lumped = inertia_in_drake(with_lumped_masses(LUMPS))
    assert masses == [0.5, 2.0, 0.25, 0.1]
    assert lumped == [0.0, 2.75, 0.0, 0.1]
    np.testing.assert_allclose(after, before, rtol=1e-12, atol=1e-15)


def test_links_that_are_heavy_or_do_not_collide_keep_their_mass():
    heavy = LUMPS.replace('<mass value="0.5"/>', '<mass value="9"/>')
    assert inertia_in_drake(with_lumped_masses(heavy))[1] == [9.25, 2.0, 0.0, 0.1]
    untouched = LUMPS.replace("<collision/>", "")
    assert with_lumped_masses(untouched) == untouched


def test_a_mass_that_is_lumped_cannot_be_varied_in_cenic(tmp_path):
    file = tmp_path / "dog.urdf"
    file.write_text(dog())

    def built(engine, value):
        scenario = TwinBuilder(**ENGINES[engine]).robot("dog", file).scenario()
        return Twin(replace(scenario, values={f"dog.front_left_foot.{value}": 0.1}))

    built("10ms", "mass")
    with pytest.raises(InputError, match="counts the mass of the light link 'front_left_foot' as that of"):
        built("cenic", "mass")
    built("cenic", "payload")
