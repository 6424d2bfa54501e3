"""Robots lie and stand still: a quadruped on its belly, and all of example-robot-data (the extra ``corpus``)."""

import sysconfig
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from scenes import ENGINES, Scene, every_engine, position, static_box

from drake_twin import Twin
from drake_twin.builder.robot_file import planned_robots

SHARE = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix" / "share"
DATA = SHARE / "example-robot-data" / "robots"
SETTLED, MEASURED = 60.0, 10.0  # s; limp arms with damping take a minute to sink down

# They have no collision shapes, or none that reaches the ground: they fall.
FALLING = {"alexander_v1.lowerBodyOnly", "human", "simple_humanoid_classical"}

# They have joints without damping or friction, whose swinging moves the rest for ever.
SWINGING = {"a1", "double_pendulum_simple"}

# They stand on wheels without damping and friction, and roll on.
ROLLING = {"tiago", "tiago_no_hand"}

# Light limp limbs that bear much still sink after a minute, against the damping of their joints; at a step of 10 ms the
# solver lets more of them creep. Engine → robot → how far it moves (mm), its fastest joint (rad/s), as measured.
SINKING = {
    "1ms": {
        "alex_nub_hands": (0.045, 2.1e-3),
        "alex_psyonic_hands": (0.13, 6.5e-3),
        "baxter": (0.001, 4.1e-3),
        "icub": (0.073, 4.4e-3),
    },
    "10ms": dict.fromkeys(
        (
            *("alex_nub_hands", "alex_psyonic_hands", "baxter", "double_pendulum_continuous"),
            *("go1", "hyq_no_sensors", "icub", "talos_full_v2"),
        ),
        (1.6, 1.6e-2),
    ),
    "cenic": {
        "alex_nub_hands": (0.71, 5.5e-3),
        "alex_psyonic_hands": (0.13, 1.7e-2),
        "alex_sake_hands": (0.039, 0.24),
        "baxter": (0.001, 4.1e-3),
        "hextilt_flying_arm_5": (0.021, 3.2e-3),
        "icub": (2.6, 1.4e-2),
        "icub_reduced": (0.095, 4.6e-3),
        "panda_collision": (0.1, 1.1e-2),  # still from the 80th second on
        "talos_full_v2": (0.17, 1.3e-2),
        "talos_full_v2_box": (14.6, 1.3),
        "talos_reduced": (2.6, 7.2e-3),
        "talos_reduced_corrected": (2.6, 7.2e-3),
    },
}

LEG = """<link name="{name}"><inertial><mass value="0.4"/><origin xyz="0 0 -0.1"/>
<inertia ixx="0.002" iyy="0.002" izz="0.0004" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><origin xyz="0 0 -0.2"/><geometry><sphere radius="0.02"/></geometry></collision></link>
<joint name="{name}_joint" type="revolute"><parent link="trunk"/><child link="{name}"/><origin xyz="{x} {y} 0"/>
<axis xyz="0 1 0"/><limit lower="-2" upper="2" effort="20" velocity="20"/><dynamics damping="0.05" friction="0.2"/>
</joint>"""


def quadruped():
    legs = [
        LEG.format(name=f"{end}_{side}", x=x, y=y)
        for end, x in (("front", 0.2), ("hind", -0.2))
        for side, y in (("left", 0.13), ("right", -0.13))
    ]
    return f"""<robot name="dog"><link name="trunk"><inertial><mass value="8"/>
<inertia ixx="0.03" iyy="0.1" izz="0.12" ixy="0" ixz="0" iyz="0"/></inertial>
<collision><geometry><box size="0.4 0.2 0.12"/></geometry></collision></link>{"".join(legs)}</robot>"""


@every_engine
@pytest.mark.parametrize("tilt", [0.0, np.radians(12.0)])
def test_a_quadruped_lies_on_its_belly(figure, tmp_path, engine, tilt):
    scene = Scene(tmp_path, engine, static_box(tilt))
    joints = [f"{end}_{side}_joint" for end in ("front", "hind") for side in ("left", "right")]
    legs = dict.fromkeys(joints, 1.45)
    twin = scene.add("dog", quadruped(), (0, 0, 0.07), (0, tilt, 0), initial_positions=legs).build()
    twin.advance_to(5.0)
    start = position(twin, "dog")
    twin.advance_to(10.0)
    moved = np.linalg.norm(position(twin, "dog") - start)
    assert figure("limp quadruped on its belly, 5 s: moves (mm)", 1e3 * moved) < 1.0
    fastest = np.abs(twin.robot_state("dog").velocities).max()
    assert figure("limp quadruped on its belly: fastest joint (rad/s)", fastest) < 2e-3


def resisted(twin, plan):
    """The velocities (rad/s) of the joints that damping, friction or a servo resists."""
    plant, context = twin.plant, twin.plant.GetMyContextFromRoot(twin.context)
    instance = plant.GetModelInstanceByName(plan.name)
    held = {plant.get_joint_actuator(index).joint().name() for index in plant.GetJointActuatorIndices(instance)}
    velocities = plant.GetVelocities(context)
    joints = (joint for joint in map(plant.get_joint, plant.GetJointIndices(instance)) if joint.num_velocities() == 1)
    moving = [joint for joint in joints if joint.name() in held or joint.default_damping_vector()[0] > 0]
    return np.abs([0.0, *(velocities[joint.velocity_start()] for joint in moving)])


@pytest.mark.slow
@pytest.mark.skipif(not DATA.is_dir(), reason="example-robot-data is not installed: pip install '.[corpus]'")
@every_engine
@pytest.mark.parametrize("file", sorted(DATA.glob("**/*.urdf")), ids=lambda file: file.stem)
def test_robots_that_nobody_here_wrote_lie_still(figure, file, engine):
    scenario = planned_robots(file, xacro_args={}, package_paths=[str(SHARE)]).scenario
    twin = Twin(replace(scenario, **ENGINES[engine]))
    (plan,) = twin.built.plans
    if file.stem in FALLING | SWINGING | ROLLING:
        pytest.skip("it falls, swings or rolls for ever")
    sinks, turns = SINKING[engine].get(file.stem, (0.0, 0.0))
    twin.advance_to(SETTLED)
    start, moved, fastest = np.array(twin.entities.state(plan.name).position), 0.0, 0.0
    while twin.time < SETTLED + MEASURED - 1e-9:
        twin.advance_to(twin.time + 0.1)
        moved = max(moved, float(np.linalg.norm(np.array(twin.entities.state(plan.name).position) - start)))
        fastest = max(fastest, float(resisted(twin, plan).max()))
    print(f"{file.stem}, {engine}: moves {1e3 * moved:.3f} mm, fastest joint {fastest:.1e} rad/s")
    figure("robots of example-robot-data, 10 s: move (mm)", 1e3 * moved)
    figure("robots of example-robot-data: fastest joint that is resisted (rad/s)", fastest)
    assert moved < max(1e-3, 1.25e-3 * sinks)
    assert fastest < max(2e-3, 1.25 * turns)
