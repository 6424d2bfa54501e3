"""gz-sim's ApplyLinkWrench: messages push links for a step or until they are cleared, as mechanics has it."""

import pytest
from nodes.node_runs import script

from drake_twin import Snapshot, TwinBuilder
from drake_twin.cockpit.topics_panel import TopicsPanel
from drake_twin.errors import CommandError, InputError, RunError
from drake_twin.messages.interface_types import make
from drake_twin.scenario import World
from drake_twin.twin.endpoints import COMMANDED
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay

STEPS = pytest.mark.parametrize("time_step", [0.001, 0.01])
MASS, INERTIA = 4.0, 0.5
ONCE, PERSISTENT, CLEAR = "/world/space/wrench", "/world/space/wrench/persistent", "/world/space/wrench/clear"

# The center of mass of the box is beside its origin, where wrenches act.
BOX = f"""<model name="box"><pose>0 0 1 0 0 0</pose><link name="body"><inertial><pose>0 0.2 0 0 0 0</pose>
<mass>{MASS}</mass><inertia><ixx>{INERTIA}</ixx><iyy>{INERTIA}</iyy><izz>{INERTIA}</izz></inertia></inertial></link>
</model>"""
PLUGIN = '<plugin filename="gz-sim-apply-link-wrench-system" name="gz::sim::systems::ApplyLinkWrench">{}</plugin>'
PROBE = '<robot name="probe"><link name="probe"/></robot>'
PUSHED = "<persistent><entity_name>box</entity_name><entity_type>model</entity_type>{}</persistent>"


@pytest.fixture
def space(tmp_path):
    """Builds a twin of a box without weight, and a robot; the plugin's elements are given."""

    def build(elements="", time_step=0.01, plugins=1, commands=(), nodes=(), robot=PROBE):
        (tmp_path / "probe.urdf").write_text(robot)
        body = f"{PLUGIN.format(elements) * plugins}<gravity>0 0 0</gravity>{BOX}"
        (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='space'>{body}</world></sdf>")
        builder = TwinBuilder(world=World(file=str(tmp_path / "w.sdf")), time_step=time_step)
        for command in commands:
            builder.command(**command)
        for node in nodes:
            builder.node(node)
        return builder.robot("probe", tmp_path / "probe.urdf", xyz=(0, 0, 50)).build()

    return build


def wrench(entity="box", kind=2, force=(0.0, 0.0, 0.0), torque=(0.0, 0.0, 0.0)):
    vectors = {"force": force, "torque": torque}
    fields = {name: dict(zip("xyz", map(float, vector), strict=True)) for name, vector in vectors.items()}
    return {"entity": {"name": entity, "type": kind}, "wrench": fields}


def motion(twin, entity="box"):
    state = twin.entities.state(entity)
    return (*state.linear, *state.angular)


@STEPS
def test_a_force_of_one_step_is_an_impulse_at_the_links_origin(space, time_step):
    twin = space(time_step=time_step)
    twin.advance_to(0.1)
    twin.publish(ONCE, wrench(force=(200, 0, 0)))
    twin.advance_to(0.1 + time_step)
    # The center of mass is 0.2 m beside: the origin moves by the turn as well.
    turn = 0.2 * 200 * time_step / INERTIA
    there = 200 * time_step / MASS + turn * 0.2
    assert motion(twin) == pytest.approx((there, 0, 0, 0, 0, turn), rel=1e-6, abs=1e-9)
    twin.advance_to(0.5)
    assert motion(twin)[5] == pytest.approx(turn, rel=1e-6)


@STEPS
def test_a_torque_of_one_step_on_a_link(space, time_step):
    twin = space(time_step=time_step)
    twin.publish(ONCE, wrench("box::body", 3, torque=(0, 0, 30)))
    twin.advance_to(0.2)
    assert motion(twin)[5] == pytest.approx(30 * time_step / INERTIA, rel=1e-6)


@STEPS
def test_two_wrenches_that_stay_add_up_until_they_are_cleared(space, time_step):
    twin = space(time_step=time_step)
    twin.publish(PERSISTENT, wrench(torque=(0, 0, 0.5)))
    twin.publish(PERSISTENT, make("ros_gz_interfaces/msg/EntityWrench", wrench(torque=(0, 0, 0.25))))
    twin.advance_to(1.0)
    assert motion(twin)[5] == pytest.approx(0.75 / INERTIA, rel=1e-6)
    twin.publish(CLEAR, {"name": "box", "type": 2})
    twin.advance_to(1.5)
    assert motion(twin)[5] == pytest.approx(0.75 / INERTIA, rel=1e-6)


def test_a_link_and_its_model_are_cleared_one_by_one(space):
    twin = space()
    twin.publish(PERSISTENT, wrench(torque=(0, 0, 0.5)))
    twin.publish(PERSISTENT, wrench("box::body", 3, torque=(0, 0, 0.25)))
    twin.publish(CLEAR, {"name": "box", "type": 2})
    twin.advance_to(1.0)
    assert motion(twin)[5] == pytest.approx(0.25 / INERTIA, rel=1e-6)


@STEPS
def test_the_worlds_own_wrenches_act_from_the_start_and_after_a_reset(space, time_step):
    twin = space(PUSHED.format("<torque>0 0 0.5</torque>"), time_step=time_step)
    for _ in range(2):
        twin.advance_to(1.0)
        assert motion(twin)[5] == pytest.approx(0.5 / INERTIA, rel=1e-6)
        twin.publish(CLEAR, {"name": "box"})
        twin.advance_to(1.2)
        assert motion(twin)[5] == pytest.approx(0.5 / INERTIA, rel=1e-6)
        twin.reset()


def test_one_of_the_world_that_is_wrong_costs_that_one(space):
    elements = PUSHED.format("<force>1 2</force>") + PUSHED.format("<torque>0 0 0.5</torque>")
    twin = space(elements)
    (finding,) = (item for item in twin.findings if "three numbers" in item.what)
    assert finding.file.endswith("w.sdf")
    twin.advance_to(1.0)
    assert motion(twin)[5] == pytest.approx(0.5 / INERTIA, rel=1e-6)


def test_a_wrench_that_stays_waits_for_its_entity(space):
    twin = space()
    twin.publish(PERSISTENT, wrench("twin", torque=(0, 0, 0.5)))
    twin.advance_to(0.5)
    twin.entities.copy_model("box", "twin", (0, 0, 9))
    twin.advance_to(1.5)
    assert motion(twin, "twin")[5] == pytest.approx(0.5 / INERTIA, rel=1e-6)
    assert motion(twin) == pytest.approx((0,) * 6)
    twin.entities.delete("twin")
    twin.advance_to(1.6)


@pytest.mark.parametrize(
    ("topic", "data", "why"),
    [
        (ONCE, wrench("egg", force=(1, 0, 0)), "Entity [egg] does not exist"),
        (ONCE, wrench("box::egg", 3, force=(1, 0, 0)), "model 'box' has no link 'egg'"),
        (ONCE, wrench("", force=(1, 0, 0)), "a wrench is on a link or a model, by its name"),
        (PERSISTENT, wrench("box", 7, force=(1, 0, 0)), "a wrench is on a link or a model, by its name"),
        (CLEAR, {"type": 2}, "a wrench is on a link or a model, by its name"),
        (PERSISTENT, wrench(force=(float("nan"), 0, 0)), "a number of the wrench is not finite"),
        (PERSISTENT, wrench(torque=(0, 0, float("inf"))), "a number of the wrench is not finite"),
        (PERSISTENT, {"entity": {"name": "box"}, "push": 1}, "push"),
    ],
)
def test_a_message_that_cannot_be_is_refused_and_changes_nothing(space, topic, data, why):
    twin = space(PUSHED.format("<torque>0 0 0.5</torque>"))
    with pytest.raises(CommandError, match=why.replace("[", r"\[")) as caught:
        twin.publish(topic, data)
    assert topic in str(caught.value)
    twin.advance_to(0.1)
    assert motion(twin)[5] == pytest.approx(0.05 / INERTIA, rel=1e-6)


def test_its_topics_are_the_worlds_or_the_files_and_none_without_it(space):
    types = {ONCE: "EntityWrench", PERSISTENT: "EntityWrench", CLEAR: "Entity"}
    twin = space()
    found = {item.name: item.type for item in twin.graph.endpoints if item.kind == COMMANDED}
    assert found == {topic: f"ros_gz_interfaces/msg/{kind}" for topic, kind in types.items()}
    assert found.items() <= twin.graph.topics().items()
    assert all(map(twin.graph.hears, found))
    named = space("<topic>/push</topic><topic_persistent>keep/on</topic_persistent><topic_clear>stop</topic_clear>")
    assert {item.name for item in named.graph.endpoints if item.kind == COMMANDED} == {"/push", "/keep/on", "/stop"}
    assert [item for item in space(plugins=0).graph.endpoints if item.kind == COMMANDED] == []
    with pytest.raises(InputError, match="nothing listens"):
        space(plugins=0).publish(ONCE, wrench(force=(1, 0, 0)))


def test_a_scenarios_own_command_pushes(space):
    twin = space(commands=[{"topic": ONCE, "data": wrench(torque=(0, 0, 30)), "time": 0.2}])
    twin.advance_to(0.2)
    assert motion(twin)[5] == 0.0
    twin.advance_to(0.5)
    assert motion(twin)[5] == pytest.approx(0.3 / INERTIA, rel=1e-6)


def test_a_run_goes_on_from_a_snapshot_a_rebuild_and_a_recording_to_the_same_bits(tmp_path, space):
    twin = space(PUSHED.format("<force>1 0 0</force>"))
    twin.recorder.begin()
    twin.publish(PERSISTENT, wrench(torque=(0, 0.1, 0.5)))
    twin.advance_to(0.3)
    twin.publish(ONCE, wrench(force=(0, 0, 100)))
    snapshot = twin.snapshot()
    twin.advance_to(0.5)
    twin.publish(CLEAR, {"name": "box"})
    twin.advance_to(1.0)
    there = twin.state_sha256()
    twin.recorder.recording().save(tmp_path / "run.json")
    twin.restore(snapshot)
    twin.advance_to(0.5)
    twin.publish(CLEAR, {"name": "box"})
    twin.advance_to(1.0)
    assert twin.state_sha256() == there
    assert replay(Recording.load(tmp_path / "run.json")).state_sha256() == there


def test_a_step_that_fails_takes_back_a_wrench_that_the_scenario_began_in_it(space):
    commands = [{"topic": PERSISTENT, "data": wrench(force=(1e300, 0, 0)), "time": 0.0}]
    twin = space(PUSHED.format("<torque>0 0 0.5</torque>"), commands=commands)
    before = twin.snapshot().steady_wrenches
    assert len(before) == 1
    for _ in range(2):
        with pytest.raises(RunError):
            twin.advance_to(0.5)
        assert (twin.time, twin.snapshot().steady_wrenches) == (0.0, before)


def test_a_file_keeps_them_and_has_no_entry_for_none(space, tmp_path):
    twin = space(PUSHED.format("<torque>0 0 0.5</torque>"))
    file = tmp_path / "state.json"
    twin.snapshot().save(file)
    assert "steady_wrenches" in file.read_text()
    twin.publish(CLEAR, {"name": "box"})
    twin.restore(Snapshot.load(file))
    twin.advance_to(1.0)
    assert motion(twin)[5] == pytest.approx(0.5 / INERTIA, rel=1e-6)
    twin.publish(CLEAR, {"name": "box"})
    twin.snapshot().save(file)
    assert "steady_wrenches" not in file.read_text()
    assert Snapshot.load(file).steady_wrenches == []


ROBOT = """<robot name="probe"><link name="probe"/><link name="arm"><inertial><mass value="1"/>
<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link><joint name="hinge" type="continuous">
<parent link="probe"/><child link="arm"/></joint><gazebo><plugin filename="gz-sim-joint-controller-system" name="c">
<joint_name>hinge</joint_name><topic>/turn</topic></plugin></gazebo></robot>"""


def test_a_topic_of_a_robot_stays_the_robots(space):
    twin = space("<topic>/probe/turn</topic>", robot=ROBOT)
    (own,) = (item for item in twin.graph.endpoints if item.name == "/probe/turn")
    assert own.robot == "probe"
    assert twin.graph.topics()["/probe/turn"] == own.type != "ros_gz_interfaces/msg/EntityWrench"
    twin.publish("/probe/turn", {"data": 1.0})


def test_the_page_and_a_node_push(space, tmp_path):
    """The page's message goes to the twin, and not to the nodes beside it."""
    node = """
from ros_gz_interfaces.msg import EntityWrench

class My(Node):
    def __init__(self):
        super().__init__("pusher")
        self.publisher = self.create_publisher(EntityWrench, "/world/space/wrench/persistent", 10)
        self.timer = self.create_timer(0.5, self.push)

    def push(self):
        message = EntityWrench()
        message.entity.name, message.entity.type = "box", 2
        message.wrench.torque.z = 0.5
        self.publisher.publish(message)
        self.timer.cancel()
"""
    twin = space(nodes=[script(tmp_path, "pusher.py", node)])
    panel = TopicsPanel(twin)
    panel.ask({"do": "Look", "version": 0, "echo": PERSISTENT, "frames": False})
    assert panel.state()["echoes"][PERSISTENT]["form"]["fields"]["entity"]["name"] == ""
    text = "{entity: {name: box, type: 2}, wrench: {torque: {z: 0.25}}}"
    panel.ask({"do": "Publish", "topic": PERSISTENT, "text": text, "key": "k"})
    assert panel.state()["outcome"]["problem"] == ""
    twin.advance_to(0.5)
    assert motion(twin)[5] == pytest.approx(0.125 / INERTIA, rel=1e-6)
    twin.advance_to(1.5)
    assert motion(twin)[5] == pytest.approx((0.375 + 0.5) / INERTIA, rel=0.02)
    twin.close()
