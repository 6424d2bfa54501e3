"""gz-sim's DetachableJoint: what is attached stays where it was, and what is let go falls as mechanics has it."""

import numpy as np
import pytest

from drake_twin import TwinBuilder
from drake_twin.diagram.cenic_constraints import cenic_has_constraints
from drake_twin.errors import RunError
from drake_twin.findings import Kind
from drake_twin.scenario import Robot, World
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay

G = 9.8  # SDF's default

# A trolley of 5 kg on a rail 3 m above the ground, and what it carries.
CRANE = """<sdf version="1.9"><model name="crane"><link name="rail"/>
<joint name="to_world" type="fixed"><parent>world</parent><child>rail</child></joint>
<link name="trolley"><inertial><mass>5</mass><inertia><ixx>0.1</ixx><iyy>0.1</iyy><izz>0.1</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.4 0.4 0.2</size></box></geometry></collision></link>
<joint name="slide" type="prismatic"><parent>rail</parent><child>trolley</child><axis><xyz>1 0 0</xyz>
<limit><effort>200</effort></limit></axis></joint>
<plugin filename="gz-sim-joint-controller-system" name="gz::sim::systems::JointController">
<joint_name>slide</joint_name></plugin>
<plugin filename="gz-sim-detachable-joint-system" name="gz::sim::systems::DetachableJoint">
<parent_link>trolley</parent_link><child_model>crate</child_model><child_link>body</child_link>{more}</plugin></model>
</sdf>"""
CRATE = """<model name="crate"><pose>{pose}</pose><link name="body"><inertial><pose>0.02 0.05 0 0 0 0</pose>
<mass>2</mass><inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz></inertia></inertial>
<collision name="c"><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision></link></model>"""
BESIDE = "0.25 0.1 2.8 0.3 -0.2 0.5"  # a corner of the crate is in the trolley
DETACH, ATTACH, STATE = "/crane/detach", "/crane/attach", "/crane/state"


@pytest.fixture
def crane(tmp_path):
    """Builds a twin of the crane with a crate; a pose of None leaves that out."""

    def build(pose=BESIDE, more="", **options):
        (tmp_path / "crane.sdf").write_text(CRANE.format(more=more))
        crate = "" if pose is None else CRATE.format(pose=pose)
        (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{crate}</world></sdf>")
        world = World(file=str(tmp_path / "w.sdf"), ground=True)
        return TwinBuilder(world=world, **options).robot("crane", tmp_path / "crane.sdf", xyz=(0, 0, 3)).build()

    return build


def offset(twin):
    """Of the crate from the trolley: position (m), then rotation vector (rad)."""
    state = twin.entities.state("crate", "crane::trolley")
    w, *axis = state.orientation
    angle = 2 * np.arctan2(np.linalg.norm(axis), w)
    return np.array([*state.position, *(angle * np.array(axis) / np.linalg.norm(axis))])


def drive(twin, velocity):
    twin.publish("/crane/joint/slide/cmd_vel", {"data": velocity})


def changes(twin):
    heard = []
    twin.subscribe(STATE, lambda message: heard.append((round(twin.time, 3), message.data)))
    return heard


@pytest.mark.parametrize(("time_step", "bound"), [(0.001, 1e-5), (0.01, 1e-4)])
def test_what_is_attached_keeps_its_pose_while_its_parent_speeds_up_and_brakes(crane, time_step, bound):
    twin = crane(time_step=time_step)
    before, worst = offset(twin), 0.0
    for velocity in (1.0, -1.0, 0.0):
        drive(twin, velocity)
        for _ in range(20):
            twin.advance_to(twin.time + 0.02)
            worst = max(worst, np.abs(offset(twin) - before).max())
        assert twin.entities.state("crate").linear[0] == pytest.approx(velocity, abs=1e-3)
    assert 0 < worst < bound


SATELLITE = """<sdf version="1.9"><model name="sat"><link name="hull"><inertial><mass>10</mass><inertia><ixx>0.3</ixx>
<iyy>0.4</iyy><izz>0.5</izz></inertia></inertial></link>
<plugin filename="gz-sim-detachable-joint-system" name="gz::sim::systems::DetachableJoint">
<parent_link>hull</parent_link>
<child_model>crate</child_model><child_link>body</child_link></plugin></model></sdf>"""


@pytest.mark.parametrize(("time_step", "bound"), [(0.001, 1e-5), (0.01, 3e-4)])
def test_two_free_bodies_tumble_as_one(tmp_path, time_step, bound):
    (tmp_path / "sat.sdf").write_text(SATELLITE)
    (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{CRATE.format(pose=BESIDE)}</world></sdf>")
    world = World(file=str(tmp_path / "w.sdf"), gravity=(0, 0, 0))
    twin = TwinBuilder(world=world, time_step=time_step).robot("sat", tmp_path / "sat.sdf", xyz=(0, 0, 3)).build()
    turn = np.array([0.3, 1.0, 2.0])
    way = np.array(twin.entities.state("crate").position) - (0, 0, 3)
    twin.entities.set_state("sat", angular=turn)
    state = twin.entities.state("crate")
    assert (state.angular, state.linear) == (pytest.approx(turn), pytest.approx(np.cross(turn, way)))
    before = twin.entities.state("crate", "sat").position
    for _ in range(20):
        twin.advance_to(twin.time + 0.1)
        assert np.abs(np.subtract(twin.entities.state("crate", "sat").position, before)).max() < bound


BAR = """<link name="{name}"><inertial><origin xyz="{middle} 0 0"/><mass value="{mass}"/>
<inertia ixx="1e-4" iyy="1e-4" izz="1e-4" ixy="0" ixz="0" iyz="0"/></inertial></link>
<joint name="{name}_joint" type="continuous"><parent link="{parent}"/><child link="{name}"/>
<origin xyz="{x} 0 0" rpy="0 0 {turn}"/><axis xyz="0 0 1"/></joint>"""
# Two arms whose tips meet above the middle between their bases, by bars of 0.2 m: at 104° and 41° from the base line.
# name, parent, place along it (m), turn (°), mass (kg), center of mass (m)
FIVE_BAR = [
    ("b1", "world", 0.0, 104.4775, 0.3, 0.1),
    ("b2", "b1", 0.2, -63.0679, 0.3, 0.1),
    ("pin", "b2", 0.2, 0.0, 0.002, 0.0),
    ("c1", "world", 0.2, 75.5225, 0.3, 0.1),
    ("c2", "c1", 0.2, 63.0679, 0.3, 0.1),
]


@pytest.mark.parametrize(("time_step", "bound"), [(0.001, 1e-6), (0.01, 1e-4)])
def test_it_closes_a_loop_of_one_robot(tmp_path, time_step, bound):
    """Most of the rods cannot move along themselves here: the mechanism is plane."""
    bars = "".join(
        BAR.format(name=name, parent=parent, x=x, turn=np.radians(turn), mass=mass, middle=middle)
        for name, parent, x, turn, mass, middle in FIVE_BAR
    )
    fixed = '<parent link="c2"/><child link="tip"/><origin xyz="0.2 0 0"/>'
    tip = f'<link name="tip"/><joint name="t" type="fixed">{fixed}</joint>'
    plugins = "".join(
        f'<plugin filename="gz-sim-joint-position-controller-system" name="{bar}"><joint_name>{bar}_joint</joint_name>'
        "<p_gain>50</p_gain><d_gain>2</d_gain><topic>both</topic></plugin>"
        for bar in ("b1", "c1")
    ) + (
        '<plugin filename="gz-sim-detachable-joint-system" name="loop"><parent_link>tip</parent_link>'
        "<child_model>bars</child_model><child_link>pin</child_link></plugin>"
    )
    robot = f'<robot name="bars"><link name="world"/>{bars}{tip}<gazebo>{plugins}</gazebo></robot>'
    (tmp_path / "bars.urdf").write_text(robot)
    twin = TwinBuilder(time_step=time_step).robot("bars", tmp_path / "bars.urdf").build()
    before = twin.entities.state("bars::pin", "bars::tip").position
    for number, angle in enumerate((0.3, -0.3, 0.2)):
        twin.publish("/bars/both", {"data": angle})
        for part in range(4):
            twin.advance_to(0.5 * number + 0.125 * part + 0.125)
            assert twin.entities.state("bars::pin", "bars::tip").position == pytest.approx(before, abs=bound)
        assert twin.robot_state("bars").positions[0] == pytest.approx(angle, abs=0.05)


def test_it_weighs_on_its_parent(crane):
    """The slide is pushed by 200 N at most: 5 kg alone would have 40 m/s²."""
    twin = crane()
    drive(twin, 1e3)
    twin.advance_to(0.1)
    assert twin.entities.state("crate").linear[0] == pytest.approx(200 / 7 * 0.1, rel=1e-6)


def test_what_is_let_go_falls_freely_with_the_speed_that_it_had(crane):
    twin = crane(pose="0 0 2 0 0 0")
    drive(twin, 1.0)
    twin.advance_to(1.0)
    start = twin.entities.state("crate")
    twin.publish(DETACH, {})
    twin.advance_to(1.5)
    now = twin.entities.state("crate")
    fallen = start.position[2] - now.position[2]
    assert fallen == pytest.approx(G * 0.5**2 / 2 + G * 0.5 * 0.001 / 2, abs=1e-6)  # and a half step of Euler's
    assert now.position[0] - start.position[0] == pytest.approx(0.5, abs=1e-4)
    assert now.linear[0] == pytest.approx(1.0, abs=1e-4)


def test_it_is_attached_again_where_it_is_then_and_each_change_is_told_once(crane):
    twin = crane(pose="0 0 2 0 0 0")
    heard = changes(twin)
    twin.advance_to(0.1)
    twin.publish(DETACH, {})
    twin.advance_to(0.3)
    twin.publish(ATTACH, {})
    twin.advance_to(0.4)
    height = twin.entities.state("crate").position[2]
    drive(twin, 0.5)
    twin.publish(ATTACH, {})  # it is already
    twin.advance_to(0.8)
    assert twin.entities.state("crate").position[2] == pytest.approx(height, abs=1e-5)
    assert height == pytest.approx(2 - G * 0.2**2 / 2, abs=2e-3)
    assert heard == [(0.01, "attached"), (0.11, "detached"), (0.31, "attached")]


def test_while_attached_the_two_do_not_touch_and_then_they_do(crane):
    """The crate's corner is 3 cm deep in the trolley: nothing moves it until it is let go; then it is pushed out."""
    twin = crane()
    twin.advance_to(0.1)
    assert twin.entities.state("crate").linear == pytest.approx((0, 0, 0), abs=1e-6)
    twin.publish(DETACH, {})
    twin.advance_to(0.11)
    assert abs(twin.entities.state("crate").linear[0]) > 0.05


def test_a_run_goes_on_from_a_snapshot_a_reset_and_a_rebuild_with_what_was_attached(crane):
    twin = crane(pose="0 0 2 0 0 0")
    twin.publish(DETACH, {})
    twin.advance_to(0.2)
    twin.publish(ATTACH, {})
    drive(twin, 1.0)
    twin.advance_to(0.3)
    snapshot, held = twin.snapshot(), offset(twin)
    twin.advance_to(0.6)
    after = twin.state_sha256()
    twin.publish(DETACH, {})
    twin.advance_to(0.9)
    twin.restore(snapshot)
    twin.advance_to(0.6)
    assert twin.state_sha256() == after
    twin.clock.set_time_step(0.002)  # builds the diagram again
    twin.advance_to(0.9)
    assert offset(twin) == pytest.approx(held, abs=1e-5)
    twin.reset()
    twin.advance_to(0.5)
    assert twin.entities.state("crate").position == pytest.approx((0, 0, 2), abs=1e-5)


def test_what_is_put_elsewhere_is_attached_there(crane):
    twin = crane(pose="0 0 2 0 0 0")
    twin.entities.place("crate", (0.5, 0, 1.5))
    twin.advance_to(0.5)
    assert twin.entities.state("crate").position == pytest.approx((0.5, 0, 1.5), abs=1e-5)


def test_what_is_attached_comes_along_with_its_parent(crane, tmp_path):
    twin = crane(pose="0 0 2 0.2 0 0")
    twin.entities.set_joint_positions("crane", {"slide": 0.7})
    assert twin.entities.state("crate").position == pytest.approx((0.7, 0, 2))
    twin.entities.place("crane", (1, 0, 4), (0, 0, np.pi / 2))
    assert twin.entities.state("crate").position == pytest.approx((1, 0.7, 3))
    twin.advance_to(0.5)
    assert twin.entities.state("crate").position == pytest.approx((1, 0.7, 3), abs=1e-5)


def test_a_model_that_comes_later_is_attached_when_it_comes(crane, tmp_path):
    twin = crane(pose=None)
    (finding,) = [item for item in twin.findings if "detachable_joint" in item.what]
    assert (finding.kind, finding.what) == (
        Kind.WARNING,
        "detachable_joint: no moving model 'crate' with a link 'body' is there yet",
    )
    assert finding.file.endswith("crane.sdf")
    assert finding.lines
    twin.advance_to(0.1)
    (tmp_path / "crate.sdf").write_text(f"<sdf version='1.9'>{CRATE.format(pose='0 0 0 0 0 0')}</sdf>")
    twin.entities.spawn(Robot("crate", str(tmp_path / "crate.sdf"), xyz=(0, 0, 2)))
    twin.advance_to(0.5)
    assert twin.entities.state("crate").position == pytest.approx((0, 0, 2), abs=1e-5)
    twin.entities.delete("crate")
    twin.advance_to(0.6)
    assert twin.robots == ("crane",)


def test_its_topics_are_the_files(crane):
    tags = {"detach_topic": "/a/let_go", "attach_topic": "/a/take", "output_topic": "/a/is"}
    twin = crane(more="".join(f"<{tag}>{name}</{tag}>" for tag, name in tags.items()))
    assert {"/crane/a/let_go", "/crane/a/take"} < twin.built.commanded.keys()
    assert twin.graph.topics()["/crane/a/is"] == "std_msgs/msg/String"
    older = crane(more="<topic>/a/let_go</topic>")
    assert {"/crane/a/let_go", ATTACH} < older.built.commanded.keys()


@pytest.mark.parametrize(
    ("before", "after", "what"),
    [
        ("<child_model>crate</child_model>", "", "<child_model> is missing"),
        ("<parent_link>trolley", "<parent_link>hook", "the robot has no link 'hook'"),
        (
            "<child_model>crate</child_model><child_link>body",
            "<child_model>__model__</child_model><child_link>trolley",
            "",
        ),
    ],
)
def test_a_joint_that_cannot_be_is_not_started(crane, monkeypatch, before, after, what):
    monkeypatch.setattr("test_detachable_joints.CRANE", CRANE.replace(before, after))
    (finding,) = [item for item in crane().findings if item.kind == Kind.NOT_STARTED]
    assert what in str(finding)


def test_cenic_has_the_joint_or_says_that_this_drake_has_not(crane):
    twin = crane(pose="0 0 2 0 0 0", engine="cenic", accuracy=1e-4)
    twin.advance_to(0.3)
    held = twin.entities.state("crate").position[2]
    if cenic_has_constraints("AddDistanceConstraint", 1.0):
        assert held == pytest.approx(2.0, abs=1e-3)
        return
    assert held < 1.9
    (finding,) = [item for item in twin.findings if item.kind == Kind.NOT_STARTED]
    assert "the engine cenic of this Drake has no such joint: use the engine discrete" in str(finding)


def test_a_step_that_fails_is_taken_back_with_what_it_was_to_detach(crane, monkeypatch):
    twin = crane(pose="0 0 2 0 0 0")
    twin.advance_to(0.1)
    twin.publish(DETACH, {})
    with monkeypatch.context() as patch:
        patch.setattr("drake_twin.twin.physics.Physics.check", lambda self: False)
        with pytest.raises(RunError):
            twin.advance_to(0.2)
    assert (twin.time, twin.entities.state("crate").position[2]) == (0.1, pytest.approx(2, abs=1e-5))
    twin.advance_to(0.3)  # the message is still to come
    assert twin.entities.state("crate").position[2] == pytest.approx(2 - G * 0.2**2 / 2, abs=2e-3)


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_recording_of_attaching_and_letting_go_ends_in_the_same_state(tmp_path, crane, time_step):
    twin = crane(time_step=time_step)
    twin.recorder.begin()
    for time, topic in ((0.2, None), (0.4, DETACH), (0.45, ATTACH), (0.8, DETACH), (1.5, None)):
        drive(twin, 1.0 - time)
        twin.advance_to(time)
        if topic is not None:
            twin.publish(topic, {})
    twin.recorder.recording().save(tmp_path / "run.json")
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == twin.state_sha256()
    assert twin.entities.state("crate").position[2] < 1.0, "it was let go"
