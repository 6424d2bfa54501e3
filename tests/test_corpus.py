"""Robots that nobody here wrote: all of example-robot-data (the extra ``corpus``), and shared/corpus where it is."""

import json
import subprocess
import sys
import sysconfig
from pathlib import Path
from random import Random

import numpy as np
import pinocchio
import pytest
from conftest import CORPUS
from ledger import Robot, misspelt_in_silence, used_for_nothing

from drake_twin import Twin
from drake_twin.builder.robot_file import planned_robots
from drake_twin.cockpit.scene import TWIN, Scene
from drake_twin.description.package_index import PackageIndex
from drake_twin.errors import InputError
from drake_twin.run import main as run

SHARE = Path(sysconfig.get_paths()["purelib"]) / "cmeel.prefix" / "share"
DATA = SHARE / "example-robot-data" / "robots"
BODY = pinocchio.FrameType.BODY
URDFS = sorted(DATA.glob("**/*.urdf"))

needs_data = pytest.mark.skipif(not URDFS, reason="example-robot-data is not installed: pip install '.[corpus]'")


# Arms, hands, a rover, a drone and a biped: the others are slow, as all of them take minutes.
SAMPLE = {"ur5_robot", "panda", "allegro_left_hand", "finger_edu", "iris", "z1", "tiago_no_hand", "bolt"}
ROBOTS = [pytest.param(file, id=file.stem, marks=() if file.stem in SAMPLE else pytest.mark.slow) for file in URDFS]


def twin_of(file):
    return Twin(planned_robots(file, xacro_args={}, package_paths=[str(SHARE)]).scenario)


@needs_data
def test_the_collection_is_whole():
    assert len(URDFS) == 69


@needs_data
@pytest.mark.parametrize("file", ROBOTS)
def test_a_robot_of_the_collection_is_shown_and_steps_and_its_frames_and_inertias_are_the_files_own(file):
    twin = Twin(planned_robots(file, xacro_args={}, package_paths=[str(SHARE)]).scenario)
    scene = Scene()
    scene.draw(twin)
    (plan,) = twin.built.plans
    twin.draw()
    assert scene.has_path(f"{TWIN}/{plan.name}") == ("<visual" in plan.model.drake_text)
    twin.advance_to(1.0)
    state = twin.robot_state(plan.name)
    assert np.isfinite([*state.positions, *state.velocities, *state.base_pose]).all()
    if len(plan.description.links) > 1:
        assert_kinematics_and_inertia(twin, plan, file)


@needs_data
@pytest.mark.parametrize("file", URDFS, ids=lambda file: file.stem)
def test_what_a_file_of_the_collection_says_is_used_or_is_a_finding_with_its_line(tmp_path, file):
    robot = Robot(file.read_bytes(), tmp_path / file.name, PackageIndex((str(SHARE),), {}))
    random = Random(file.stem)
    assert list(misspelt_in_silence(robot, random, 5)) == []
    assert list(used_for_nothing(robot, random, 8)) == []


WHOLE = [
    *("a1", "allegro_left_hand", "allegro_right_hand", "TwoDofs", "borinot_flying_arm_2", "double_pendulum"),
    *("double_pendulum_continuous", "double_pendulum_simple", "finger_edu", "g1_29dof_with_hand_rev_1_0"),
    *("quadrotor_base", "hextilt_flying_arm_5", "human", "iris", "iris_simple", "laikago", "romeo"),
    *("romeo_small", "simple_humanoid_classical", "ur3"),
]


@needs_data
@pytest.mark.parametrize("name", WHOLE)
def test_strict_lets_whole_robots_of_the_collection_pass(name):
    (file,) = (file for file in URDFS if file.stem == name)
    options = ["--headless", "--duration", "0.01", "--strict", "--package-path", str(SHARE)]
    assert run([str(file), *options]) == 0


def assert_kinematics_and_inertia(twin, plan, file):
    """Against Pinocchio's reading of the original file, at the robot's own configuration after a second."""
    reference = pinocchio.buildModelFromUrdf(str(file))
    state = twin.robot_state(plan.name)
    values = dict(zip(state.joints, state.positions, strict=True))
    q = pinocchio.neutral(reference)
    for name, value in values.items():
        if not reference.existJointName(name):
            continue
        joint = reference.joints[reference.getJointId(name)]
        if joint.nq == 2:
            q[joint.idx_q : joint.idx_q + 2] = np.cos(value), np.sin(value)
        else:
            q[joint.idx_q] = value
    data = reference.createData()
    pinocchio.framesForwardKinematics(reference, data, q)
    tree = frames(twin.latest("/tf"), twin.latest("/tf_static"))
    root = plan.description.root_link
    to_root = data.oMf[reference.getFrameId(root, BODY)].inverse()
    for link in plan.description.links:
        if not reference.existFrame(link, BODY) or not connected(
            plan.frame_prefix + link, plan.frame_prefix + root, tree
        ):
            continue  # beyond a joint that no tf message covers
        expected = (to_root * data.oMf[reference.getFrameId(link, BODY)]).homogeneous
        found = relative(plan.frame_prefix + link, plan.frame_prefix + root, tree)
        assert np.abs(found - expected).max() < 1e-6, link
    changed = {item.rule for item in plan.model.findings} & {"massless_link", "inertia"}
    if not changed:
        instance = twin.plant.GetModelInstanceByName(plan.name)
        total = twin.plant.CalcTotalMass(twin.plant.GetMyContextFromRoot(twin.context), [instance])
        assert_joint_space_inertia(twin, plan, reference, q)
        own_root_mass = root_mass(file, plan)
        assert total == pytest.approx(pinocchio.computeTotalMass(reference) + own_root_mass, rel=1e-6, abs=1e-6)


def assert_joint_space_inertia(twin, plan, reference, q):
    """The joints' block of the mass matrix is the same for a free and a fixed base; it holds every link's inertia."""
    names = [joint.name for joint in plan.description.movable_joints if reference.existJointName(joint.name)]
    own = [twin.plant.GetJointByName(name).velocity_start() for name in names]
    theirs = [reference.joints[reference.getJointId(name)].idx_v for name in names]
    context = twin.plant.GetMyContextFromRoot(twin.context)
    found = twin.plant.CalcMassMatrix(context)[np.ix_(own, own)]
    upper = pinocchio.crba(reference, reference.createData(), q)
    expected = (np.triu(upper) + np.triu(upper, 1).T)[np.ix_(theirs, theirs)]
    assert np.abs(found - expected).max(initial=0.0) <= 1e-6 * np.abs(expected).max(initial=0.0)


def root_mass(file, plan):
    """Pinocchio leaves out what is fixed to the universe: the root's own mass and that of what is fixed to it."""
    from lxml import etree

    masses = {
        link.get("name"): float(mass.get("value"))
        for link in etree.parse(file).getroot().iterfind("link")
        if (mass := link.find("inertial/mass")) is not None
    }
    fixed, total = {plan.description.root_link}, 0.0
    for _ in plan.description.joints:
        fixed |= {joint.child for joint in plan.description.joints if joint.type == "fixed" and joint.parent in fixed}
    for link in fixed:
        total += masses.get(link, 0.0)
    return total


def frames(*messages):
    found = {}
    for message in messages:
        for item in message.transforms:
            matrix = np.eye(4)
            rotation, translation = item.transform.rotation, item.transform.translation
            quaternion = pinocchio.Quaternion(rotation.w, rotation.x, rotation.y, rotation.z)
            matrix[:3, :3] = quaternion.toRotationMatrix()
            matrix[:3, 3] = (translation.x, translation.y, translation.z)
            found[item.child_frame_id] = (item.header.frame_id, matrix)
    return found


def connected(frame, root, tree):
    while frame != root and frame in tree:
        frame = tree[frame][0]
    return frame == root


def relative(frame, root, tree):
    pose = np.eye(4)
    while frame != root:
        frame, matrix = tree[frame]
        pose = matrix @ pose
    return pose


def whole_robots():
    """The files of shared/corpus that stand for a whole robot: not the parts that others include."""
    if not CORPUS.is_dir():
        return []
    files = [*CORPUS.glob("**/urdf/*.xacro.urdf"), *CORPUS.glob("*/*/robot/robot.xacro")]
    files += [*CORPUS.glob("**/description/urdf/*.urdf.xacro"), *CORPUS.glob("**/urdf/robots/*.xacro")]
    files += [*CORPUS.glob("**/urdf/*bot.urdf.xacro"), *CORPUS.glob("**/description/robot.urdf.xacro")]
    files += [*CORPUS.glob("**/urdf/mogi_arm.xacro"), *CORPUS.glob("**/urdf/rosbot_xl.urdf.xacro")]
    return sorted(set(files))


@pytest.mark.skipif(not CORPUS.is_dir(), reason="the folder shared/corpus with other people's robots is not here")
@pytest.mark.parametrize("file", whole_robots(), ids=lambda file: f"{file.parent.parent.parent.name}-{file.stem}")
def test_a_robot_of_the_corpus_loads_and_steps(file):
    if file.name == "rosbot_xl.urdf.xacro":  # its parts come from a package that is not in the corpus
        with pytest.raises(InputError, match="package 'ros_components_description' was not found in"):
            twin_of(file)
        return
    twin = twin_of(file)
    twin.advance_to(1.0)
    (plan,) = twin.built.plans
    state = twin.robot_state(plan.name)
    assert np.isfinite([*state.positions, *state.velocities, *state.base_pose]).all()
    assert abs(state.base_pose[2] - plan.spawn_pose.xyz[2]) < 0.02, "it does not stand"
    assert plan.model.drake_text


@needs_data
def test_the_second_start_converts_nothing(tmp_path):
    """In a process of its own: what a conversion needs (trimesh, SciPy) is not even imported."""
    file = DATA / "ur_description" / "urdf" / "ur5_robot.urdf"
    program = (
        "import sys, json; from drake_twin.check import check;"
        f"report = check({str(file)!r}, {{}}, [{str(SHARE)!r}]);"
        "print(json.dumps([report.ok, 'trimesh' in sys.modules, 'scipy.spatial' in sys.modules]))"
    )
    results = []
    for _ in range(2):
        command = [sys.executable, "-c", program]
        environment = {"XDG_CACHE_HOME": str(tmp_path), "PATH": "/usr/bin:/bin"}
        done = subprocess.run(command, capture_output=True, text=True, check=True, env=environment)
        results.append(json.loads(done.stdout))
    assert results == [[True, True, True], [True, False, False]]
