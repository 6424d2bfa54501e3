"""SDF's ball, universal and screw joints: they move as mechanics has it, and turn for ever."""

import numpy as np
import pytest
from pydrake.common.eigen_geometry import Quaternion
from pydrake.common.value import Value
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.math import SpatialForce
from scenes import ENGINES, G, step_error
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation

from drake_twin import TwinBuilder
from drake_twin.diagram import ball_joints
from drake_twin.diagram.cenic_constraints import cenic_has_constraints
from drake_twin.errors import InputError
from drake_twin.findings import Kind
from drake_twin.scenario import Robot, World
from drake_twin.sensors.force_torque_sensor import ForceTorqueSensor, ForceTorqueSettings
from drake_twin.sensors.sensor_setup import SensorSetup

# What this Drake's engines can: CENIC has such constraints since 1.56.
WITH_BALLS = [engine for engine in ENGINES if engine != "cenic" or cenic_has_constraints("AddBallConstraint")]
engines_with_balls = pytest.mark.parametrize("engine", WITH_BALLS)

MASS, MOMENTS = 2.0, np.array([0.02, 0.03, 0.04])  # about the centre of mass
CENTER = np.array([0.1, -0.05, 0.4])  # of the ball joint, in the bob's frame (m)
START = Rotation.from_euler("xyz", [0.3, -0.2, 0.5])  # of the bob
SPIN = np.array([0.5, 7.0, 0.0])  # rad/s, in the bob's axes


def link(name, pose="0 0 0 0 0 0"):
    ixx, iyy, izz = MOMENTS
    return f"""<link name="{name}"><pose>{pose}</pose><inertial><mass>{MASS}</mass>
<inertia><ixx>{ixx}</ixx><iyy>{iyy}</iyy><izz>{izz}</izz></inertia></inertial></link>"""


def joint(kind, more="", pose="", parent="post"):
    return f"""<joint name="joint" type="{kind}"><parent>{parent}</parent><child>bob</child>
<pose>{pose or "0 0 0 0 0 0"}</pose>{more}</joint>"""


def model(inside):
    return f'<model name="m">{inside}</model>'


def pendulum(parent="post"):
    """A bob on a ball joint at a height of 1 m."""
    start = np.array([0.0, 0.0, 1.0]) - START.apply(CENTER)
    bob = link("bob", " ".join(map(str, [*start, *START.as_euler("xyz")])))
    return bob + joint("ball", pose=" ".join(map(str, CENTER)) + " 0 0 0", parent=parent)


def on_post(inside):
    return f'<sdf version="1.9">{model("<static>1</static>" + link("post") + inside)}</sdf>'


def twin_of(folder, engine, sdf, **world):
    (folder / "m.sdf").write_text(sdf)
    builder = TwinBuilder(world=World(ground=False, **world), **ENGINES[engine])
    return builder.robot("m", folder / "m.sdf").build()


def twin_in_world(folder, engine, inside):
    (folder / "w.sdf").write_text(f'<sdf version="1.9"><world name="w">{model(inside)}</world></sdf>')
    (folder / "post.sdf").write_text(on_post(""))
    builder = TwinBuilder(world=World(file=str(folder / "w.sdf")), **ENGINES[engine])
    return builder.robot("post", folder / "post.sdf", xyz=(5, 0, 0)).build()


def set_velocity(twin, velocity):
    context = twin.plant.GetMyContextFromRoot(twin.context)
    twin.plant.SetVelocities(context, np.array(velocity, dtype=float))


def pose(twin, name="m::bob"):
    state = twin.entities.state(name)
    return RigidTransform(RotationMatrix(Quaternion(state.orientation)), state.position)


def swung(seconds):
    """The bob's rotation after a time, as SciPy integrates Euler's equations about the joint's centre."""
    arm = -CENTER
    inertia = np.diag(MOMENTS) + MASS * (arm @ arm * np.eye(3) - np.outer(arm, arm))

    def derivative(_, state):
        w = state[4:]
        rotation = Rotation.from_quat(state[:4])
        torque = np.cross(arm, MASS * rotation.inv().apply([0, 0, -G]))
        x, y, z, s = state[:4]
        turning = 0.5 * np.array([[s, -z, y], [z, s, -x], [-y, x, s], [-x, -y, -z]]) @ w
        return [*turning, *np.linalg.solve(inertia, torque - np.cross(w, inertia @ w))]

    found = solve_ivp(derivative, (0.0, seconds), [*START.as_quat(), *SPIN], rtol=1e-10, atol=1e-10)
    return [Rotation.from_quat(state[:4]) for state in found.y.T]


@engines_with_balls
@pytest.mark.parametrize("where", ["robot", "world"])
def test_a_pendulum_on_a_ball_joint_swings_as_scipy_has_it(tmp_path, engine, where):
    if where == "robot":
        twin = twin_of(tmp_path, engine, on_post(pendulum()))
    else:
        twin = twin_in_world(tmp_path, engine, pendulum("world"))
    set_velocity(twin, [*SPIN, 0, 0, 0])  # in the joint's axes, which are the bob's at the start
    path = swung(2.0)
    assert max(abs((START.inv() * one).as_euler("ZYX")[1]) for one in path) > 1.56  # it passes by a pitch of 90 degrees
    twin.advance_to(2.0)
    found = Rotation.from_matrix(pose(twin).rotation().matrix())
    assert (found * path[-1].inv()).magnitude() < 12 * step_error(engine)  # of a turn of 6 rad
    assert pose(twin) @ CENTER == pytest.approx([0, 0, 1], abs=1e-5)


def test_a_snapshot_holds_a_ball_joint(tmp_path):
    twin = twin_of(tmp_path, "1ms", on_post(pendulum()))
    set_velocity(twin, [*SPIN, 0, 0, 0])
    twin.advance_to(0.3)
    before = twin.snapshot()
    twin.advance_to(0.6)
    after = twin.state_sha256()
    twin.restore(before)
    twin.advance_to(0.6)
    assert twin.state_sha256() == after


AXES = "<axis><xyz>0 0 1</xyz></axis><axis2><xyz>1 0 0</xyz></axis2><screw_thread_pitch>0.01</screw_thread_pitch>"
VELOCITY = {"ball": [*SPIN, 0, 0, 0], "universal": [3.0, 1.0], "screw": [2 * np.pi]}


def turn(folder, engine, kind, seconds):
    """Turns a joint without gravity, looking at where the child link is all the time.

    The centre of mass lies in the joint's axes; the bob has its own pose in the joint.
    """
    axes = "" if kind == "ball" else AXES
    sdf = on_post(link("bob", "0 0 1 0 0 0") + joint(kind, axes))
    twin = twin_of(folder, engine, sdf, gravity=(0, 0, 0))
    set_velocity(twin, VELOCITY[kind])
    while twin.time < seconds - 1e-9:
        twin.advance_to(min(twin.time + 0.25 * (1 if seconds < 100 else 40), seconds))
        X = pose(twin)
        R, (x, y, z) = X.rotation().matrix(), X.translation()
        assert np.isfinite(R).all()
        assert [x, y] == pytest.approx([0, 0], abs=1e-5)
        if kind == "screw":
            turns = (z - 1) / 0.01
            assert np.abs(R - Rotation.from_euler("z", 2 * np.pi * turns).as_matrix()).max() < 1e-6
        else:
            assert z == pytest.approx(1, abs=1e-5)
        if kind == "universal":  # the axis on the post is across that on the bob
            assert R[2, 0] == pytest.approx(0, abs=1e-9)
    return twin


KINDS = [(kind, engine) for kind in ("universal", "screw") for engine in ENGINES]
KINDS += [("ball", engine) for engine in WITH_BALLS]
KINDS_AND_ENGINES = pytest.mark.parametrize(("kind", "engine"), KINDS)


@KINDS_AND_ENGINES
def test_a_joint_of_sdf_turns_on_and_on(tmp_path, kind, engine):
    twin = turn(tmp_path, engine, kind, 20.0)
    if kind == "screw":
        assert pose(twin).translation()[2] == pytest.approx(1 + 20 * 0.01, abs=1e-6)


@pytest.mark.slow
@KINDS_AND_ENGINES
def test_a_joint_of_sdf_turns_for_an_hour(tmp_path, kind, engine):
    turn(tmp_path, engine, kind, 3600.0)


@engines_with_balls
def test_a_quaternion_stays_short_and_the_run_goes_on_to_the_same_bit_whoever_looks(tmp_path, engine):
    """Drake makes a quaternion longer with each step; until then a ball that turned at 8 rad/s ended after 103 s."""
    sdf = on_post(link("bob", "0 0 1 0 0 0") + joint("ball", ""))
    hashes = set()
    for part in (40.0, 0.7):
        twin = twin_of(tmp_path, engine, sdf, gravity=(0, 0, 0))
        set_velocity(twin, VELOCITY["ball"])
        while twin.time < 40.0 - 1e-9:
            twin.advance_to(min(twin.time + part, 40.0))
            twin.state_sha256()
            lengths = np.linalg.norm(twin.plant.GetPositions(twin.plant.GetMyContextFromRoot(twin.context))[:4])
            assert 0.99 < lengths < 2.0
        hashes.add(twin.state_sha256())
        restored = twin_of(tmp_path, engine, sdf, gravity=(0, 0, 0))
        restored.restore(twin.snapshot())
        for each in (twin, restored):
            each.advance_to(45.0)
        assert twin.state_sha256() == restored.state_sha256()
    assert len(hashes) == 1


@pytest.mark.parametrize("kind", VELOCITY)
def test_tf_has_the_child_links_of_sdf_joints(tmp_path, kind):
    axes = "" if kind == "ball" else AXES
    twin = twin_of(tmp_path, "1ms", on_post(link("bob", "0.1 0.2 1 0.3 0 0") + joint(kind, axes)))
    set_velocity(twin, VELOCITY[kind])
    twin.advance_to(0.5)
    (found,) = [item for item in twin.latest("/tf").transforms if item.child_frame_id.endswith("bob")]
    expected = twin.entities.state("m::bob", "m::post")
    assert found.header.frame_id == found.child_frame_id.replace("bob", "post")
    p, q = found.transform.translation, found.transform.rotation
    assert [p.x, p.y, p.z] == pytest.approx(expected.position)
    assert [q.w, q.x, q.y, q.z] == pytest.approx(expected.orientation)


@pytest.fixture
def older_cenic(monkeypatch):
    monkeypatch.setattr(ball_joints, "cenic_has_constraints", lambda add: False)


@pytest.mark.usefixtures("older_cenic")
def test_cenic_refuses_a_robot_with_a_ball_joint_in_words(tmp_path):
    with pytest.raises(InputError) as raised:
        twin_of(tmp_path, "cenic", on_post(f"\n{pendulum()}"))
    assert str(raised.value) == (
        f"{tmp_path / 'm.sdf'}:4: robot 'm': the engine cenic of this Drake does not support the ball joint 'joint'"
        " (Drake 1.56 and later do): use the engine discrete, or make the joint fixed, revolute or universal."
    )


@pytest.mark.usefixtures("older_cenic")
def test_cenic_leaves_out_a_model_of_the_world_with_a_ball_joint(tmp_path):
    twin = twin_in_world(tmp_path, "cenic", pendulum("world"))
    (finding,) = twin.findings
    assert finding.kind is Kind.IGNORED
    assert finding.what == (
        "m: the model is left out, because Drake refuses it (the engine cenic of this Drake does not support the ball"
        " joint 'joint' (Drake 1.56 and later do): use the engine discrete, or make the joint fixed, revolute or"
        " universal)"
    )


@engines_with_balls
def test_damping_brakes_a_ball_joint(tmp_path, engine):
    damping = "<axis><xyz>0 0 1</xyz><dynamics><damping>0.02</damping></dynamics></axis>"
    twin = twin_of(tmp_path, engine, on_post(link("bob") + joint("ball", damping)), gravity=(0, 0, 0))
    set_velocity(twin, [2.0, 0, 0, 0, 0, 0])
    twin.advance_to(1.0)
    assert twin.entities.state("m::bob").angular[0] == pytest.approx(
        2 * np.exp(-0.02 / MOMENTS[0]), rel=step_error(engine)
    )


def test_a_sensor_beside_a_ball_joint_measures_and_one_in_it_is_named(tmp_path):
    sensor = '<sensor name="{}" type="force_torque"/>'
    ball = joint("ball", sensor.format("inside"), pose="0 0 0.4 0 0 0")
    mount = (
        f"""<joint name="mount" type="fixed"><parent>bob</parent><child>load</child>{sensor.format("beside")}</joint>"""
    )
    hanging = link("bob", "0 0 0.6 0 0 0") + ball + link("load", "0 0 0.5 0 0 0") + mount
    twin = twin_of(tmp_path, "1ms", on_post(hanging))
    assert "m: sensor inside: it cannot measure in the ball joint joint" in twin.findings.warnings
    twin.advance_to(0.1)
    described = twin.built.plans[0].description.sensor("beside", "force_torque")
    instance = twin.plant.GetModelInstanceByName("m")
    dut = ForceTorqueSensor(SensorSetup(described, ForceTorqueSettings(), twin.plant, instance))
    ((forces, own),) = dut.host.inputs_from(twin.plant)
    context = dut.host.CreateDefaultContext()
    own.FixValue(context, Value[list[SpatialForce]](twin.graph.evaluate(forces)))
    assert dut.output("wrench").Eval(context) == pytest.approx([0, 0, -MASS * G, 0, 0, 0], abs=1e-6)


FOLLOWER = """<robot name="leader"><link name="base"/>{}</robot>""".format(
    "".join(
        f"""<link name="{name}"><inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/>
</inertial></link><joint name="{name}_joint" type="continuous"><parent link="base"/><child link="{name}"/>
<axis xyz="0 0 1"/>{more}</joint>"""
        for name, more in (("lead", ""), ("follow", '<mimic joint="lead_joint" multiplier="2"/>'))
    )
)


def test_models_have_ball_joints_beside_others_and_keep_moving_when_one_is_spawned(tmp_path):
    (tmp_path / "l.urdf").write_text(FOLLOWER)
    (tmp_path / "m.sdf").write_text(on_post(pendulum()))
    builder = TwinBuilder(world=World(ground=False), time_step=0.001)
    twin = builder.robot("l", tmp_path / "l.urdf").robot("m", tmp_path / "m.sdf").build()
    assert twin.plant.num_constraints() == 2  # one is the follower's: Drake removes no joint where there is one
    twin.advance_to(0.3)
    before = pose(twin).GetAsMatrix4()
    twin.entities.spawn(Robot("n", str(tmp_path / "m.sdf"), xyz=(3.0, 0.0, 0.0)))
    assert np.array_equal(pose(twin).GetAsMatrix4(), before)
    twin.advance_to(0.6)
    assert pose(twin) @ CENTER == pytest.approx([0, 0, 1], abs=1e-5)
    assert pose(twin, "n::bob") @ CENTER == pytest.approx([3, 0, 1], abs=1e-5)
    assert pose(twin).translation()[0] != pytest.approx(pose(twin, "n::bob").translation()[0] - 3.0, abs=1e-3)
