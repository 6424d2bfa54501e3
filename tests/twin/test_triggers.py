"""gz-sim's TriggeredPublisher: what is published when a message is heard, and when."""

from dataclasses import replace

import pytest

from drake_twin import Twin, TwinBuilder
from drake_twin.errors import CommandError, InputError
from drake_twin.findings import Kind
from drake_twin.nodes.nodes import Nodes
from drake_twin.scenario import Command, NodeProgram, Robot, World
from drake_twin.twin.recording import Recording
from drake_twin.twin.replay import replay

G = 9.8  # SDF's default

PLUGIN = '<plugin filename="gz-sim-triggered-publisher-system" name="gz::sim::systems::TriggeredPublisher">{}</plugin>'

# A mass of 2 kg on a rail, moved by a velocity.
SLIDER = """<sdf version="1.9"><model name="slider"><link name="rail"/>
<joint name="to_world" type="fixed"><parent>world</parent><child>rail</child></joint>
<link name="mass"><inertial><mass>2</mass></inertial></link>
<joint name="slide" type="prismatic"><parent>rail</parent><child>mass</child><axis><xyz>1 0 0</xyz></axis></joint>
<plugin filename="gz-sim-joint-controller-system" name="gz::sim::systems::JointController">
<joint_name>slide</joint_name><topic>/go</topic></plugin>
{}</model></sdf>"""
# A box that falls from 10 m, with an altimeter: what it reports is its height above its start.
BOX = """<model name="box"><pose>5 0 10 0 0 0</pose><link name="link"><inertial><mass>1</mass></inertial>
<sensor name="height" type="altimeter"><topic>/height</topic><update_rate>100</update_rate></sensor></link></model>"""


def trigger(source, *outputs, more=""):
    return PLUGIN.format(source + more + "".join(outputs))


def output(type_, topic, text=""):
    return f'<output type="gz.msgs.{type_}" topic="{topic}">{text}</output>'


START = '<input type="gz.msgs.Empty" topic="/start"/>'
GO = output("Double", "/go", "data: 1.5")
TOLD = output("Int32", "/told", "data: 7")


@pytest.fixture
def build(tmp_path):
    """Builds a twin of the slider, with plugins of its model and of its world."""

    def of(of_world="", of_model="", time_step=0.001, commands=()):
        (tmp_path / "slider.sdf").write_text(SLIDER.format(of_model))
        (tmp_path / "w.sdf").write_text(f"<sdf version='1.9'><world name='w'>{BOX}\n{of_world}</world></sdf>")
        world = World(file=str(tmp_path / "w.sdf"))
        builder = TwinBuilder(world=world, time_step=time_step).robot("slider", tmp_path / "slider.sdf", xyz=(0, 0, 1))
        return Twin(replace(builder.scenario(), commands=commands))

    return of


def heard(twin, topic="/told"):
    messages = []
    twin.subscribe(topic, lambda message: messages.append((round(twin.time, 6), message.data)))
    return messages


def speed(twin):
    return twin.robot_state("slider").velocities[0]


@pytest.mark.parametrize("place", ["of_world", "of_model"])
def test_a_message_makes_a_controller_hear_another_one(build, place):
    twin = build(**{place: trigger(START, GO)})
    assert twin.graph.topics()["/start"] == "std_msgs/msg/Empty"
    twin.advance_to(0.1)
    assert speed(twin) == 0.0
    twin.publish("/start", {})
    twin.advance_to(0.2)
    assert speed(twin) == pytest.approx(1.5, abs=1e-3)
    assert not [item for item in twin.findings if "trigger" in item.what]


def test_a_message_that_no_controller_hears_is_there_for_others(build):
    twin = build(trigger(START, TOLD))
    messages = heard(twin)
    twin.advance_to(0.1)
    twin.publish("/start", {})
    twin.publish("/start", {})
    twin.advance_to(0.2)
    assert [data for _, data in messages] == [7, 7]
    assert messages[0][0] <= 0.101


@pytest.mark.parametrize("time_step", [0.001, 0.01])
def test_a_delay_ends_at_its_step(build, time_step):
    twin = build(trigger(START, GO, TOLD, more="<delay_ms>250</delay_ms>"), time_step=time_step)
    twin.advance_to(0.5)
    twin.publish("/start", {})
    twin.advance_to(0.75)
    assert speed(twin) == 0.0
    twin.step(1)
    assert speed(twin) > 0.2


def test_what_the_twin_measures_triggers_at_the_time_that_free_fall_has(build):
    """The box has fallen 3 m after √(2 · 3 / g) = 0.782 s: within 0.05 m of it between 0.776 s and 0.789 s."""
    match = '<match field="vertical_position" tol="0.05">-3</match>'
    twin = build(trigger(f'<input type="gz.msgs.Altimeter" topic="/height">{match}</input>', GO))
    twin.advance_to(1.0)
    position = twin.robot_state("slider").positions[0]
    assert 1.0 - position / 1.5 == pytest.approx((2 * 3 / G) ** 0.5, abs=0.01)


def test_all_conditions_have_to_hold(build):
    conditions = '<match logic_type="negative">data: -5</match><match logic_type="negative" field="data">-4</match>'
    twin = build(trigger(f'<input type="gz.msgs.Int32" topic="/key">{conditions}</input>', TOLD))
    messages = heard(twin)
    for key in (-5, -4, 3):
        twin.advance_to(twin.time + 0.01)
        twin.publish("/key", {"data": key})
    twin.advance_to(0.1)
    assert len(messages) == 1
    assert messages[0][0] == pytest.approx(0.03, abs=0.0011)


def test_one_trigger_starts_another_one(build):
    between = output("Boolean", "/between", "data: true")
    second = '<input type="gz.msgs.Boolean" topic="/between"><match>data: true</match></input>'
    twin = build(trigger(START, between) + trigger(second, GO))
    twin.publish("/start", {})
    twin.advance_to(0.1)
    assert speed(twin) == pytest.approx(1.5, abs=1e-3)


def test_two_that_start_each_other_do_not_hold_up_the_twin(build):
    back = trigger('<input type="gz.msgs.Empty" topic="/there"/>', output("Empty", "/start"), TOLD)
    twin = build(trigger(START, output("Empty", "/there")) + back)
    messages = heard(twin)
    twin.publish("/start", {})
    twin.advance_to(0.1)
    assert len(messages) == pytest.approx(50, abs=1)  # each takes a step


def test_a_command_of_the_scenario_triggers(build):
    twin = build(trigger(START, GO), commands=(Command("/start", {}, time=0.1),))
    twin.advance_to(0.1)
    assert speed(twin) == 0.0
    twin.advance_to(0.2)
    assert speed(twin) == pytest.approx(1.5, abs=1e-3)


def test_what_is_pending_is_saved_and_goes_on_to_the_same_bits(build, tmp_path):
    twin = build(trigger(START, GO, more="<delay_ms>300</delay_ms>"))
    twin.advance_to(0.1)
    twin.publish("/start", {})
    twin.advance_to(0.2)
    snapshot = twin.snapshot()
    twin.advance_to(0.6)
    assert speed(twin) == pytest.approx(1.5, abs=1e-3)
    end = twin.state_sha256()
    twin.restore(snapshot)
    assert speed(twin) == 0.0
    assert twin.snapshot() == snapshot
    twin.advance_to(0.6)
    assert twin.state_sha256() == end
    twin.reset()
    twin.advance_to(0.6)
    assert speed(twin) == 0.0


def test_a_recording_is_repeated_to_the_same_bits(build, tmp_path):
    match = '<match field="vertical_position" tol="0.05">-1</match>'
    fallen = f'<input type="gz.msgs.Altimeter" topic="/height">{match}</input>'
    stop = output("Double", "/go", "data: -0.5")
    twin = build(trigger(START, GO) + trigger(fallen, stop, more="<delay_ms>105</delay_ms>"))
    twin.recorder.begin()
    twin.advance_to(0.0517)
    twin.publish("/start", {})
    twin.advance_to(0.8)
    assert speed(twin) == pytest.approx(-0.5, abs=1e-3)
    twin.recorder.recording().save(tmp_path / "r.json")
    assert replay(Recording.load(tmp_path / "r.json")).state_sha256() == twin.state_sha256()


def test_what_is_pending_outlives_a_spawn_and_goes_with_its_robot(build, tmp_path):
    twin = build(of_model=trigger(START, TOLD, more="<delay_ms>300</delay_ms>"))
    messages = heard(twin)
    twin.publish("/start", {})
    twin.entities.spawn(Robot("other", str(tmp_path / "slider.sdf"), xyz=(0, 3, 1)))
    twin.advance_to(0.5)
    assert [data for _, data in messages] == [7]
    twin.publish("/start", {})
    twin.advance_to(0.6)
    twin.entities.delete("other")
    twin.advance_to(1.0)
    assert [data for _, data in messages] == [7, 7]


def test_a_message_of_another_type_is_refused(build):
    twin = build(trigger('<input type="gz.msgs.Int32" topic="/key"/>', TOLD))
    with pytest.raises(CommandError, match="/key: "):
        twin.publish("/key", {"data": "text"})


def test_a_topic_of_another_type_in_the_twin_is_a_finding(build):
    twin = build(trigger('<input type="gz.msgs.Int32" topic="/height"/>', output("Int32", "/go", "data: 1")))
    found = {item.what for item in twin.findings if item.kind is Kind.WARNING}
    name = "Gazebo plugin triggered_publisher: "
    assert f"{name}/box/height is ros_gz_interfaces/msg/Altimeter here, and not std_msgs/msg/Int32" in found
    assert f"{name}/slider/go is std_msgs/msg/Float64 here, and not std_msgs/msg/Int32" in found


@pytest.mark.parametrize(
    ("plugin", "why"),
    [
        (trigger("", TOLD), "<input> is missing"),
        (trigger(START), "it does nothing: <output> or <service> is missing"),
        (trigger('<input topic="/a"/>', TOLD), "<input> has no type"),
        (trigger('<input type="gz.msgs.Empty"/>', TOLD), "<input> has no topic"),
        (trigger('<input type="gz.msgs.Model" topic="/a"/>', TOLD), "the twin knows no message type 'gz.msgs.Model'"),
        (trigger('<input type="gz.msgs.Empty" topic="/a"><match/></input>', TOLD), "its <match> is empty"),
    ],
)
@pytest.mark.parametrize("place", ["of_world", "of_model"])
def test_a_plugin_that_cannot_work_is_a_finding(build, plugin, why, place):
    twin = build(**{place: plugin})
    (finding,) = [item for item in twin.findings if item.kind is Kind.NOT_STARTED]
    assert finding.what.endswith(f"triggered_publisher (gz-sim-triggered-publisher-system): {why}")
    assert twin.built.triggers == ()


@pytest.mark.parametrize(
    ("plugin", "why"),
    [
        (
            trigger('<input type="gz.msgs.Int32" topic="/a"><match>data: x</match></input>', TOLD),
            "<match> is 'data: x': 'data' is 'x', which is not a whole number",
        ),
        (
            trigger('<input type="gz.msgs.Int32" topic="/a"><match tol="-1">data: 1</match></input>', TOLD),
            "tol of <match> is '-1', and has to be zero or more",
        ),
        (
            trigger('<input type="gz.msgs.Int32" topic="/a"><match tol="a">data: 1</match></input>', TOLD),
            "tol of <match> is 'a', which is not a number",
        ),
        (
            trigger('<input type="gz.msgs.Int32" topic="/a"><match logic_type="no">data: 1</match></input>', TOLD),
            "logic_type of <match> is 'no', which is neither 'positive' nor 'negative'",
        ),
        (trigger(START, output("Int32", "/told", "data 7")), "<output> is 'data 7': ':' is missing after 'data'"),
        (trigger(START, TOLD, more="<delay_ms>soon</delay_ms>"), "<delay_ms> is 'soon', which is not a number"),
    ],
)
def test_a_bad_value_is_refused_with_its_file_and_line(build, plugin, why):
    with pytest.raises(InputError) as raised:
        build(plugin)
    assert str(raised.value).endswith(f"w.sdf:3: <plugin filename='gz-sim-triggered-publisher-system'>: {why}.")


def test_a_static_model_of_the_world_may_have_one(build):
    sign = '<link name="l"><collision name="c"><geometry><box><size>1 1 1</size></box></geometry></collision></link>'
    twin = build(f'<model name="sign"><static>1</static><pose>9 9 9 0 0 0</pose>{sign}{trigger(START, GO)}</model>')
    twin.publish("/start", {})
    twin.advance_to(0.1)
    assert speed(twin) == pytest.approx(1.5, abs=1e-3)
    assert not [item for item in twin.findings if "trigger" in item.what]


NODE = """
import rclpy
from rclpy.node import Node
from std_msgs.msg import Empty, Int32

rclpy.init()
node = Node("pupil")
heard = []
node.create_subscription(Int32, "/told", lambda message: heard.append(message.data), 10)
publisher = node.create_publisher(Empty, "/start", 10)
node.create_timer(0.1, lambda: publisher.publish(Empty()))
while len(heard) < 3:
    rclpy.spin_once(node)
raise ValueError(f"heard {heard} at {node.get_clock().now().nanoseconds / 1e9:.1f}")
"""


def test_a_node_triggers_and_hears_what_is_published(build, tmp_path):
    (tmp_path / "pupil.py").write_text(NODE)
    twin = build(trigger(START, TOLD))
    nodes = Nodes(twin, [NodeProgram(str(tmp_path / "pupil.py"))])
    twin.advance_to(0.5)
    nodes.close()
    (finding,) = twin.more_findings
    assert "heard [7, 7, 7] at 0.3" in str(finding)
