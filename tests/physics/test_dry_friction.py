"""Dry friction in joints with a motor: it takes its share of what the motor can do, and holds what it can hold.

The rotor has the moment of inertia M, its motor the largest effort E, its bearing the friction F: it speeds up at
(E - F) / M and is braked by (E + F) / M. References: these closed forms, MuJoCo, and the discrete engine.
"""

import sysconfig
from pathlib import Path

import numpy as np
import pytest
from lxml import etree
from scenes import ENGINES, G, box, every_engine, world

from drake_twin import TwinBuilder
from drake_twin.cockpit.overlay import OVERLAY_KINDS
from drake_twin.cockpit.overlays.collision_shapes import _shapes
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.description.package_index import PackageIndex
from drake_twin.description.robot_model import load_robot_model
from drake_twin.errors import InputError
from drake_twin.scenario import World

M, E, F = 0.1, 2.0, 0.5  # of a rotor (kg·m², N·m), or of a slider (kg, N)
SPEED_UP, SLOW_DOWN = (E - F) / M, (E + F) / M
MODES = ("position", "velocity", "effort")
KINDS = ("revolute", "prismatic")
every_kind = pytest.mark.parametrize("kind", KINDS)

# By which the velocity is off (rad/s): what a velocity servo yields, and half of what a step does where a motor turns.
CLOSE = 1e-3

DATA = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix" / "share" / "example-robot-data" / "robots"
ARMS = {"xarm7": DATA / "xarm_description/urdf/xarm7.urdf", "z1": DATA / "z1_description/urdf/z1.urdf"}


def rotor(mode, kind="revolute", axis="0 0 1", friction=F, base="", center="0 0 0"):
    """A body that turns or slides; its base is the world, or a free link."""
    inertial = f'<inertial><origin xyz="{center}"/><mass value="{M}"/>'
    inertial += f'<inertia ixx="{M}" iyy="{M}" izz="{M}" ixy="0" ixz="0" iyz="0"/></inertial>'
    return f"""<robot name="r"><link name="{base or "world"}">{inertial if base else ""}</link>
<link name="body">{inertial}</link>
<joint name="joint" type="{kind}"><parent link="{base or "world"}"/><child link="body"/><axis xyz="{axis}"/>
<origin xyz="0.2 0.1 0.3" rpy="0.3 -0.2 0.5"/>
<limit lower="-1000" upper="1000" velocity="500" effort="{E}"/><dynamics friction="{friction}"/></joint>
<ros2_control name="s" type="system"><joint name="joint"><command_interface name="{mode}"/></joint></ros2_control>
</robot>"""


def twin_of(folder, engine, urdf, gravity=0.0, **options):
    (folder / "r.urdf").write_text(urdf)
    (folder / "world.sdf").write_text(world(gravity=gravity))
    builder = TwinBuilder(world=World(file=str(folder / "world.sdf")), **{**ENGINES[engine], **options})
    return builder.robot("r", folder / "r.urdf").build()


def command(twin, mode, value):
    twin.publish(f"/r/forward_{mode}_controller/commands", [float(value)])


def velocity(twin):
    return twin.robot_state("r").velocities[0]


def position(twin):
    return twin.robot_state("r").positions[0]


def drive(folder, engine, mode, kind="revolute"):
    """A twin whose motor does all it can, one way."""
    twin = twin_of(folder, engine, rotor(mode, kind))
    command(twin, mode, {"position": 900.0, "velocity": 400.0, "effort": 2 * E}[mode])
    return twin


@every_engine
@every_kind
@pytest.mark.parametrize("mode", MODES)
def test_a_motor_at_its_limit_has_friction_against_it(tmp_path, engine, mode, kind):
    twin = drive(tmp_path, engine, mode, kind)
    for time in (0.1, 0.5, 1.0):
        twin.advance_to(time)
        assert velocity(twin) == pytest.approx(SPEED_UP * time, abs=CLOSE)
    assert position(twin) == pytest.approx(SPEED_UP / 2, abs=SPEED_UP * 0.01 / 2 + 1e-3)


@every_engine
@every_kind
@pytest.mark.parametrize("mode", MODES)
def test_friction_helps_a_motor_that_brakes_and_turns_round_with_it(tmp_path, engine, mode, kind):
    twin = drive(tmp_path, engine, mode, kind)
    twin.advance_to(0.5)
    command(twin, mode, {"position": -900.0, "velocity": -400.0, "effort": -2 * E}[mode])
    start, stop = velocity(twin), velocity(twin) / SLOW_DOWN
    twin.advance_to(0.7)
    assert velocity(twin) == pytest.approx(start - SLOW_DOWN * 0.2, abs=CLOSE)
    twin.advance_to(1.5)
    # Within the step in which it turns round, a discrete engine takes the friction of the step's end.
    step = ENGINES[engine]["time_step"]
    assert velocity(twin) == pytest.approx(-SPEED_UP * (1.0 - stop), abs=CLOSE + 2 * F / M * step)


@every_engine
@every_kind
def test_a_body_let_go_is_stopped_by_friction_and_stays(tmp_path, engine, kind):
    twin = drive(tmp_path, engine, "effort", kind)
    twin.advance_to(0.2)
    command(twin, "effort", 0.0)
    start = velocity(twin)
    twin.advance_to(0.4)
    assert velocity(twin) == pytest.approx(start - F / M * 0.2, abs=CLOSE)
    twin.advance_to(2.0)
    stop = position(twin)
    twin.advance_to(5.0)
    assert position(twin) == pytest.approx(stop, abs=1e-7)
    assert velocity(twin) == pytest.approx(0.0, abs=1e-7)


@every_engine
@every_kind
@pytest.mark.parametrize("share", [0.5, 0.95, -0.95])
def test_an_effort_below_friction_moves_nothing(tmp_path, engine, kind, share):
    twin = twin_of(tmp_path, engine, rotor("effort", kind))
    command(twin, "effort", share * F)
    twin.advance_to(5.0)
    assert abs(position(twin)) < 1e-3 * 5.0


@every_engine
@every_kind
def test_an_effort_above_friction_moves_the_body(tmp_path, engine, kind):
    twin = twin_of(tmp_path, engine, rotor("effort", kind))
    command(twin, "effort", 1.05 * F)
    twin.advance_to(2.0)
    assert velocity(twin) == pytest.approx(0.05 * F / M * 2.0, abs=CLOSE + 2e-3)


@every_engine
@every_kind
def test_servos_reach_what_they_are_told(tmp_path, engine, kind):
    twin = twin_of(tmp_path, engine, rotor("position", kind))
    command(twin, "position", 2.0)
    twin.advance_to(4.0)
    assert position(twin) == pytest.approx(2.0, abs=1e-3)
    twin = twin_of(tmp_path, engine, rotor("velocity", kind))
    command(twin, "velocity", 5.0)
    twin.advance_to(1.0)
    assert velocity(twin) == pytest.approx(5.0, abs=CLOSE)
    command(twin, "velocity", -5.0)
    twin.advance_to(3.0)
    assert velocity(twin) == pytest.approx(-5.0, abs=CLOSE)


PENDULUM = """<mujoco><option gravity="0 0 -9.81" timestep="1e-4" integrator="implicitfast" tolerance="0"/>
<worldbody><body pos="0 0 0"><joint name="j" type="hinge" axis="0 1 0" frictionloss="{friction}"
solimpfriction="0.9999 0.9999 0.001" solreffriction="2e-4 1"/>
<inertial pos="0 0 -0.5" mass="0.1" diaginertia="0.1 0.1 0.1"/></body></worldbody>
<actuator><general name="m" joint="j" gainprm="{gain}" biastype="affine" biasprm="0 {stiffness} {damping}"
forcerange="{lower} {upper}"/></actuator></mujoco>"""


def in_mujoco(mode, value, gains, times):
    """Positions of a pendulum with a motor and friction (rad)."""
    p, d = gains
    gain = {"position": p, "velocity": d, "effort": 1.0}[mode]
    text = PENDULUM.format(friction=F, gain=gain, stiffness=-p, damping=-d, lower=-E, upper=E)
    mujoco = pytest.importorskip("mujoco", reason="the extra 'benchmarks' is not installed")
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    found = []
    data.ctrl[0] = value
    for time in times:
        while data.time < time - 1e-9:
            mujoco.mj_step(model, data)
        found.append(data.qpos[0])
    return found


@pytest.mark.parametrize(("engine", "bound"), [("1ms", 3e-3), ("cenic", 1e-3)])
@pytest.mark.parametrize(("mode", "value"), [("position", 3.0), ("velocity", 2.5), ("effort", 0.9), ("effort", -2.0)])
def test_a_pendulum_moves_as_in_mujoco(tmp_path, engine, bound, mode, value):
    urdf = rotor(mode, axis="0 1 0", center="0 0 -0.5").replace('rpy="0.3 -0.2 0.5"', "")
    gain = '<hardware><param name="position_proportional_gain">0.05</param></hardware>'  # a lag of 0.2 s at 100 Hz
    urdf = urdf.replace('type="system">', f'type="system">{gain}')
    twin = twin_of(tmp_path, engine, urdf, G, accuracy=1e-7)
    command(twin, mode, value)
    actuator = twin.plant.GetJointActuatorByName("joint")
    times, found = (0.1, 0.3, 0.6, 1.0, 1.5, 2.0), []
    for time in times:
        twin.advance_to(time)
        found.append(position(twin))
    gains = actuator.get_controller_gains()
    p, d = (gains.p if mode == "position" else 0.0), (0.0 if mode == "effort" else gains.d)
    expected = in_mujoco(mode, value, (p, d), times)
    assert found == pytest.approx(expected, abs=bound, rel=bound / 3)


@pytest.mark.parametrize("kind", ["revolute", "prismatic"])
def test_a_brake_pushes_both_links_alike(tmp_path, kind):
    """A robot that floats keeps its momentum while friction stops what its motor has set in motion."""
    twin = twin_of(tmp_path, "cenic", rotor("effort", kind, base="base", center="0.1 0.2 -0.3"), accuracy=1e-6)
    command(twin, "effort", E)
    twin.advance_to(0.2)
    command(twin, "effort", 0.0)
    assert abs(velocity(twin)) > 1.0
    twin.advance_to(3.0)
    assert velocity(twin) == pytest.approx(0.0, abs=1e-6)
    momentum = twin.plant.CalcSpatialMomentumInWorldAboutPoint(
        twin.plant.GetMyContextFromRoot(twin.context), np.zeros(3)
    )
    assert momentum.get_coeffs() == pytest.approx(np.zeros(6), abs=1e-4)


def test_a_brake_touches_nothing_else(tmp_path):
    crate = tmp_path / "crate.urdf"
    crate.write_text(box((0.4, 0.4, 0.4)))
    (tmp_path / "world.sdf").write_text(world(gravity=0.0))
    (tmp_path / "r.urdf").write_text(rotor("velocity"))
    builder = TwinBuilder(world=World(file=str(tmp_path / "world.sdf")), **ENGINES["cenic"])
    builder.robot("r", tmp_path / "r.urdf").robot("crate", crate, xyz=(0.2, 0.1, 0.3))
    twin = builder.build()
    command(twin, "velocity", 5.0)
    twin.advance_to(1.0)
    assert velocity(twin) == pytest.approx(5.0, abs=CLOSE)
    assert twin.entities.state("crate").position == pytest.approx((0.2, 0.1, 0.3), abs=1e-12)


def test_a_brake_is_not_drawn(tmp_path):
    text = rotor("velocity")
    (tmp_path / "bare.urdf").write_text(text)
    ball = '<link name="body"><collision><geometry><sphere radius="0.1"/></geometry></collision>'
    (tmp_path / "ball.urdf").write_text(text.replace('<link name="body">', ball))
    builder = TwinBuilder(world=World(ground=False), **ENGINES["cenic"])
    twin = builder.robot("bare", tmp_path / "bare.urdf").robot("ball", tmp_path / "ball.urdf", xyz=(9, 0, 0)).build()
    twin.advance_to(0.01)
    scene = Scene()
    for name in ("contacts", "collision"):
        OVERLAY_KINDS[name].type(scene, twin).draw()
    results = twin.graph.evaluate(twin.plant.get_contact_results_output_port())
    assert results.num_point_pair_contacts() + results.num_hydroelastic_contacts() == 2
    assert not scene.has_path(f"{OVERLAYS}/contact")
    assert [shape.shape.radius() for shape in _shapes(twin)] == [0.1]


def test_a_run_repeats(tmp_path):
    hashes = set()
    for slices in (1, 7):
        twin = drive(tmp_path, "cenic", "effort")
        for part in range(slices):
            twin.advance_to(0.7 * (part + 1) / slices)
        hashes.add(twin.state_sha256())
    assert len(hashes) == 1


def test_a_joint_without_motor_is_rubbed_in_cenic_too(tmp_path):
    text = rotor("effort", axis="0 1 0", center="0 0 -0.5", friction=0.1).replace('"0.3 -0.2 0.5"', '"0 1.5 0"')
    text = text[: text.index("<ros2_control")] + "</robot>"
    ends = []
    for engine in ("1ms", "cenic"):
        twin = twin_of(tmp_path, engine, text, G, accuracy=1e-5)
        twin.advance_to(1.0)
        ends.append(position(twin))
    assert abs(ends[0]) > 0.5
    assert ends[1] == pytest.approx(ends[0], abs=5e-3)


def arm_along_a_trajectory(folder, name, engine):
    """An arm between two postures: its positions every 0.1 s (rad), and where it was to go."""
    root = etree.parse(ARMS[name]).getroot()
    for item in [*root.iterfind("ros2_control"), *root.iterfind("link/visual"), *root.iterfind("link/collision")]:
        item.getparent().remove(item)
    limits = {
        joint.get("name"): [float(joint.find("limit").get(side)) for side in ("lower", "upper")]
        for joint in root.iterfind("joint")
        if joint.get("type") == "revolute"
    }
    control = etree.SubElement(root, "ros2_control", name="s", type="system")
    for joint in limits:
        element = etree.SubElement(control, "joint", name=joint)
        etree.SubElement(element, "command_interface", name="position")
        for interface in ("position", "velocity"):
            etree.SubElement(element, "state_interface", name=interface)
    (folder / "arm.urdf").write_bytes(etree.tostring(root))
    (folder / "arm.yaml").write_text(
        "controller_manager: {ros__parameters: {arm: {type: joint_trajectory_controller/JointTrajectoryController}}}\n"
        f"arm: {{ros__parameters: {{joints: [{', '.join(limits)}], command_interfaces: [position],"
        " state_interfaces: [position, velocity]}}\n"
    )
    builder = TwinBuilder(world=World(ground=False), **ENGINES[engine])
    twin = builder.robot("arm", folder / "arm.urdf", controllers=folder / "arm.yaml").build()
    lower, upper = np.clip(np.array(list(limits.values())).T, -2.0, 2.0)
    found = []
    for start, share in ((0.0, 0.8), (3.0, 0.2)):
        goal = (lower + share * (upper - lower)).tolist()
        point = {"positions": goal, "velocities": [0.0] * len(goal), "time_from_start": 2.0}
        twin.publish("/arm/arm/joint_trajectory", {"joint_names": list(limits), "points": [point]})
        for tick in range(1, 31):
            twin.advance_to(start + 0.1 * tick)
            state = twin.robot_state("arm")
            positions = dict(zip(state.joints, state.positions, strict=True))
            found.append([positions[joint] for joint in limits])
    return np.array(found), np.array(goal)


@pytest.mark.skipif(not DATA.is_dir(), reason="example-robot-data is not installed: pip install '.[corpus]'")
@pytest.mark.parametrize("name", ARMS)
def test_an_arm_with_friction_moves_in_cenic_as_in_the_discrete_engine(tmp_path, name):
    expected, goal = arm_along_a_trajectory(tmp_path, name, "1ms")
    found, _ = arm_along_a_trajectory(tmp_path, name, "cenic")
    assert np.abs(expected[-1] - goal).max() < 1e-3
    assert np.abs(found - expected).max() < 1e-2
    assert np.abs(found[-1] - expected[-1]).max() < 1e-3


def slider(friction, kind="prismatic"):
    """A body of SDF on a vertical slide, which is welded to the world; G is what the world's gravity is."""
    inertial = f"<inertial><mass>{M}</mass><inertia><ixx>{M}</ixx><iyy>{M}</iyy><izz>{M}</izz></inertia></inertial>"
    axis = f"<axis><xyz>0 0 1</xyz><dynamics><friction>{friction}</friction></dynamics></axis>"
    more = axis.replace("axis>", "axis2>").replace("0 0 1", "0 1 0") if kind == "universal" else ""
    return f"""<sdf version="1.9"><model name="r"><link name="base">{inertial}</link><link name="body">{inertial}</link>
<joint name="weld" type="fixed"><parent>world</parent><child>base</child></joint>
<joint name="joint" type="{kind}"><parent>base</parent><child>body</child>
{axis}{more}</joint></model></sdf>"""


@every_engine
@pytest.mark.parametrize("share", [0.5, 0.95, 1.3])  # of the weight
def test_a_joint_of_sdf_is_rubbed_too(tmp_path, engine, share):
    (tmp_path / "r.sdf").write_text(slider(share * M * G))
    (tmp_path / "world.sdf").write_text(world())
    builder = TwinBuilder(world=World(file=str(tmp_path / "world.sdf")), **ENGINES[engine])
    twin = builder.robot("r", tmp_path / "r.sdf").build()
    assert [str(finding) for finding in twin.findings] == []
    twin.advance_to(1.0)
    assert velocity(twin) == pytest.approx(-max(0.0, 1 - share) * G, abs=CLOSE + 1e-3)


@pytest.mark.parametrize(
    ("kind", "friction", "message"),
    [
        ("universal", "0.5", "friction of joint joint (r.sdf:4)"),
        ("prismatic", "-0.5", "r.sdf:4: <friction> of .* it is -0.5, and must not be negative"),
        ("prismatic", "much", "it is 'much', which is not a number"),
    ],
)
def test_a_friction_of_sdf_that_cannot_be_had_is_said(tmp_path, kind, friction, message):
    file = tmp_path / "r.sdf"
    file.write_text(slider(friction, kind))
    if kind == "universal":
        assert [message in str(finding) for finding in load_robot_model(str(file), PackageIndex()).findings] == [True]
    else:
        with pytest.raises(InputError, match=message):
            load_robot_model(str(file), PackageIndex())
