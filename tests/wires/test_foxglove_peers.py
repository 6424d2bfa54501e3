"""A running twin in Foxglove, against its own npm packages: what is shown, what may be commanded, what it costs."""

import json
import math
from itertools import pairwise

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from rosbags.typesys import Stores, get_typestore
from wires.foxglove_client import foxglove_client
from wires.ros_client import while_running

from drake_twin.services.assets import Assets
from drake_twin.services.graph import connect
from drake_twin.twin.endpoints import PUBLISHED
from drake_twin.twin.replay import replay
from drake_twin.wires.foxglove_wire import FoxgloveWire

pytest.importorskip("foxglove")

JAZZY = get_typestore(Stores.ROS2_JAZZY)
STATES = "/robot_1/joint_states"
DESCRIPTION = "/robot_1/robot_description"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
ARRAY = "std_msgs/msg/Float64MultiArray"
LIST = "/robot_1/controller_manager/list_controllers"


class Shown:
    """A twin in Foxglove."""

    def __init__(self, twin, control):
        self.twin = twin
        self.wire = FoxgloveWire(port=0, control=control, asset=Assets(twin))
        self.wire.attach(twin)
        self.seam = connect(twin, [self.wire])

    def peer(self):
        return foxglove_client(self.wire.port)

    def run(self, work, **more):
        """Run the twin while a peer works; return what the work returns."""

        def do():
            with self.peer() as peer:
                return work(peer)

        return while_running(self.twin, do, **more)


@pytest.fixture
def shown(request):
    """Two rovers and an arm; with control if the test's parameter says so."""
    with rovers(2).robot("arm", ARM, xyz=(0, -3, 0)).build() as twin:
        shown = Shown(twin, getattr(request, "param", False))
        try:
            yield shown
        finally:
            shown.seam.close()


def said(caplog):
    """The lines of the wire: pytest shows those of the SDK's own loggers, too, which the program does not."""
    return [record.getMessage() for record in caplog.records if record.name == "drake_twin.wires.foxglove_clients"]


controlled = pytest.mark.parametrize("shown", [True], indirect=True)


def array(*values):
    types = JAZZY.types
    layout = types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    return bytes(JAZZY.serialize_cdr(types[ARRAY](layout=layout, data=np.array(values)), ARRAY))


def nanoseconds(stamp):
    return int(stamp["sec"]) * 1_000_000_000 + int(stamp["nanosec"])


def test_joint_states_without_a_gap(shown):
    """The first message is of the moment at which the client is noticed, the others are on the grid of 100 Hz."""

    def read(peer):
        peer.subscribe(STATES)
        return peer.messages(STATES, 250)

    messages = shown.run(read)
    stamps = [nanoseconds(item["message"]["header"]["stamp"]) for item in messages]
    assert stamps == [int(item["time"]) for item in messages]
    assert len(stamps) >= 250
    assert {after - before for before, after in pairwise(stamps[1:])} == {10_000_000}
    assert messages[0]["message"]["name"] == shown.twin.joint_states("robot_1").name


def test_values_are_those_of_the_twin(shown):
    own = {}
    shown.twin.publish(COMMANDS, [2.0, 3.0, 2.0, 3.0])
    shown.twin.subscribe(STATES, lambda message: own.setdefault(round(shown.twin.time * 1e9), message))

    def read(peer):
        peer.subscribe(STATES)
        return peer.messages(STATES, 50)

    for item in shown.run(read)[1:]:
        message = own[int(item["time"])]
        assert item["message"]["position"] == list(message.position)
        assert item["message"]["velocity"] == list(message.velocity)
        assert item["message"]["name"] == message.name
    assert own[max(own)].velocity[0] > 1.0


@controlled
def test_foxglove_reads_every_schema(shown):
    def read(peer):
        peer.channel("/tf")
        peer.wait_for(lambda events: any(item["event"] == "advertiseServices" for item in events))
        peer.do("parseAll")
        return peer.first("parsed")

    found = shown.run(read)
    published = {item.name for item in shown.twin.graph.endpoints if item.kind == PUBLISHED}
    assert set(found["channels"]) == published | {"/drake_twin/simulate_steps/_action/status"}
    assert {LIST, "/drake_twin/spawn_entity", "/pause_physics"} < set(found["services"])
    assert not any("send_goal" in name for name in found["services"])


def test_a_late_joiner_gets_what_is_latched(shown):
    def read(peer):
        for topic in (DESCRIPTION, "/tf_static"):
            peer.subscribe(topic)
            peer.messages(topic)
        return [peer.messages(topic)[0]["message"] for topic in (DESCRIPTION, "/tf_static")]

    shown.twin.advance_to(1.0)
    first = shown.run(read)
    shown.twin.pause()
    second = shown.run(read)  # also of a twin that is paused
    assert first == second
    assert second[0]["data"] == shown.twin.latest(DESCRIPTION).data
    static = {item["child_frame_id"] for item in second[1]["transforms"]}
    assert static == {item.child_frame_id for item in shown.twin.latest("/tf_static").transforms}


def test_the_time_is_the_twins_and_a_reset_begins_a_new_session(shown):
    def read(peer):
        peer.subscribe(STATES)
        peer.subscribe(DESCRIPTION)
        peer.messages(STATES, 50)
        before = len(peer.all("serverInfo"))
        shown.twin.inbox.put(shown.twin.reset, between_advances=True)
        peer.wait_for(lambda events: sum(item["event"] == "serverInfo" for item in events) > before)
        there = len(peer.events)
        peer.wait_for(lambda events: events[-1] if sum(item["event"] == "advertise" for item in events) > 2 else None)
        peer.subscribe(DESCRIPTION)
        peer.messages(STATES, len(peer.all("message", topic=STATES)) + 30)
        return peer.events, there

    events, there = shown.run(read)
    infos = [index for index, item in enumerate(events) if item["event"] == "serverInfo"]
    assert len({events[index]["sessionId"] for index in infos}) == len(infos) == 2
    assert infos[1] < there
    for part in (events[: infos[1]], events[infos[1] :]):
        times = [int(item["time"]) for item in part if item["event"] == "time"]
        assert {after - before for before, after in pairwise(times[-20:])} == {10_000_000}
    after = events[infos[1] :]
    assert next(int(item["time"]) for item in after if item["event"] == "time") == 0
    assert DESCRIPTION in {item.get("topic") for item in after}  # the client has forgotten it


def test_a_client_that_joins_others_is_told_the_time_also_while_the_twin_is_paused(shown):
    def join(peer):
        peer.subscribe(STATES)
        peer.messages(STATES, 10)
        shown.twin.pause()
        with shown.peer() as other:
            other.subscribe(STATES)
            return int(other.first("time")["time"])

    time = shown.run(join)
    frame = 34_000_000  # the twin stands still after the frame in which it is paused
    assert time <= round(shown.twin.time * 1e9) < time + 10_000_000 + frame


@controlled
def test_a_client_controls_the_time(shown):
    clock = shown.twin.clock

    def control(peer):
        info = peer.first("serverInfo")
        peer.do("playback", play=True, speed=2.5, id="faster")
        peer.do("playback", play=False, speed=0.25, id="paused")
        paused = peer.first("playback", id="paused")
        there = shown.twin.time
        peer.do("playback", play=False, speed=-1, id="backwards")
        peer.do("playback", play=False, speed=1, seek=1_000_000_000, id="future")
        future = peer.first("playback", id="future")
        peer.do("playback", play=False, speed=1, seek=0, id="start")
        start = peer.first("playback", id="start")
        shown.twin.inbox.put(shown.twin.play)  # as another program does
        told = peer.first("playback", id="")
        return (
            info,
            [peer.first("playback", id=name) for name in ("faster", "backwards")],
            paused,
            there,
            future,
            start,
            told,
        )

    info, (faster, backwards), paused, there, future, start, told = shown.run(control)
    assert "playbackControl" in info["capabilities"]
    assert (info["dataStartTime"]["sec"], info["dataEndTime"]["sec"]) == (0, 3600)
    assert (faster["status"], faster["speed"]) == ("playing", 2.5)
    assert (paused["status"], paused["speed"]) == ("paused", 0.25)
    assert (backwards["status"], backwards["speed"]) == ("paused", 0.25)
    assert int(paused["time"]) == int(future["time"]) == round(there * 1e9) > 0
    assert (future["seeked"], start["seeked"], start["time"]) == (False, True, "0")
    assert (told["status"], told["speed"], clock.real_time_rate) == ("playing", 1.0, 1.0)


def test_without_control_a_client_only_sees(shown):
    before = shown.twin.state_sha256()

    def command(peer):
        info = peer.first("serverInfo")
        publish = peer.advertise(COMMANDS, ARRAY)
        publish(array(1.0, 1.0, 1.0, 1.0))
        peer.do("playback", play=False, speed=2.0, id="pause")
        peer.subscribe(STATES)
        peer.messages(STATES, 20)
        return info["capabilities"], peer.all("advertiseServices"), [item["text"] for item in peer.all("status")]

    capabilities, services, said = shown.run(command)
    assert not {"clientPublish", "services", "playbackControl"} & set(capabilities)
    assert services == []
    assert any("not support" in text and "ublish" in text for text in said)
    assert any("not support playback control" in text for text in said)
    assert not shown.twin.clock.paused
    assert shown.twin.graph.command(COMMANDS) is None
    assert before != shown.twin.state_sha256()  # it has run


@controlled
def test_500_of_500_commands_are_applied_and_replayed(shown):
    def command(peer):
        publish = peer.advertise(COMMANDS, ARRAY)
        for number in range(500):
            publish(array(*[number / 100] * 4))
        return peer.call(LIST)

    shown.twin.recorder.begin()
    names = {item["name"] for item in shown.run(command)["controller"]}
    assert "forward_velocity_controller" in names
    shown.twin.advance_to(shown.twin.time + 0.5)
    calls = [call for call in shown.twin.recorder.recording().calls if call.name == "publish"]
    values = [call.arguments[1] if call.arguments else call.named["data"] for call in calls]
    assert [float(value.data[0]) for value in values] == [number / 100 for number in range(500)]
    assert shown.twin.robot_state("robot_1").velocities[0] > 1.0
    with replay(shown.twin.recorder.recording()) as again:
        assert again.state_sha256() == shown.twin.state_sha256()


@controlled
def test_commands_in_json(shown, caplog):
    def command(peer):
        publish = peer.advertise(COMMANDS, ARRAY, "json")
        for text in ('{"data": [1, 2', '{"data": "text"}', '{"dat": [1]}', "[" * 100_000):
            publish(text.encode())
        publish(json.dumps({"data": [1.5, 1.5, 1.5, 1.5]}).encode())
        peer.call(LIST)

    shown.run(command)
    assert list(shown.twin.graph.command(COMMANDS).data) == [1.5] * 4
    (line,) = said(caplog)
    assert line.startswith(f"{COMMANDS}: a message is not a {ARRAY}: ")


@controlled
def test_what_is_not_a_command_is_refused_with_one_line(shown, caplog):
    def command(peer):
        wrong_type = peer.advertise(COMMANDS, "geometry_msgs/msg/Twist")
        wrong_encoding = peer.advertise(COMMANDS, ARRAY, "protobuf")
        nobody = peer.advertise("/nobody", ARRAY)
        good = peer.advertise(COMMANDS, ARRAY)
        for _ in range(5):
            for publish in (wrong_type, wrong_encoding, nobody):
                publish(array(1.0, 1.0, 1.0, 1.0))
            good(array(math.nan, 1.0, 1.0, 1.0))
        peer.call(LIST)

    shown.run(command)
    assert shown.twin.graph.command(COMMANDS) is None
    assert said(caplog) == [
        f"{COMMANDS}: a geometry_msgs/msg/Twist is ignored: the topic's type is {ARRAY}",
        f"{COMMANDS}: the encoding 'protobuf' is not read: cdr and json are",
        "/nobody: nothing listens to it",
    ]
    assert len([text for text in caplog.messages if "not a finite number" in text]) == 1


@controlled
def test_services_answer_while_the_twin_runs_and_while_it_is_paused(shown):
    def call(peer):
        switch = {"deactivate_controllers": ["forward_velocity_controller"], "strictness": 2}
        assert peer.call("/robot_1/controller_manager/switch_controller", switch)["ok"]
        states = {item["name"]: item["state"] for item in peer.call(LIST)["controller"]}
        with pytest.raises(RuntimeError, match="Unsupported encoding"):
            peer.call(LIST, encoding="json")
        return states["forward_velocity_controller"]

    assert shown.run(call) == "inactive"
    shown.twin.pause()
    assert shown.run(lambda peer: peer.call(LIST)["controller"][0]["name"]) == "joint_state_broadcaster"


@controlled
def test_services_in_json_are_those_in_cdr(shown):
    def call(peer):
        state = peer.channel("/tf") and peer.call("/drake_twin/get_entity_state", {"entity": "robot_2"})
        other = peer.call("/drake_twin/get_entity_state.json", {"entity": "robot_2"}, encoding="json")
        with pytest.raises(RuntimeError, match="entityy"):
            peer.call("/drake_twin/get_entity_state.json", {"entityy": "robot_2"}, encoding="json")
        with pytest.raises(RuntimeError, match="Expecting property name"):
            peer.call("/drake_twin/get_entity_state.json", data=b"{", encoding="json")
        (offered,) = (
            item
            for told in peer.all("advertiseServices")
            for item in told["services"]
            if item["name"] == "/drake_twin/get_entity_state.json"
        )
        return state, other, offered

    shown.twin.pause()
    state, other, offered = shown.run(call)
    assert other == state
    assert state["state"]["pose"]["position"]["y"] == pytest.approx(shown.twin.robot_state("robot_2").base_pose[1])
    schema = json.loads(offered["request"]["schema"])
    assert schema["properties"] == {"entity": {"type": "string"}}
    pose = json.loads(offered["response"]["schema"])["properties"]["state"]["properties"]["pose"]
    assert pose["properties"]["position"]["properties"] == {axis: {"type": "number"} for axis in "xyz"}


@controlled
def test_a_spawn_brings_channels_and_a_delete_takes_them_away(shown):
    def change(peer):
        pose = {"pose": {"position": {"x": -3.0, "z": 0.13}}}
        peer.call("/drake_twin/spawn_entity", {"name": "new", "uri": ROVER, "initial_pose": pose})
        peer.subscribe("/new/joint_states")
        peer.messages("/new/joint_states", 20)
        peer.call("/new/controller_manager/list_controllers")
        peer.call("/drake_twin/delete_entity", {"entity": "new"})
        peer.wait_for(lambda events: any("/new/joint_states" in item.get("topics", ()) for item in events))
        peer.wait_for(
            lambda events: any("/new/controller_manager/list_controllers" in item.get("names", ()) for item in events)
        )

    shown.run(change)
    assert shown.twin.robots == ("robot_1", "robot_2", "arm")


def test_files_of_the_robots_packages_and_no_others(shown):
    mesh = "package://arduinobot_description/meshes/turret.stl"

    def fetch(peer):
        with pytest.raises(RuntimeError, match="not found"):
            peer.fetch("file:///etc/passwd")
        with pytest.raises(RuntimeError, match="not found"):
            peer.fetch("package://arduinobot_description/../../pyproject.toml")
        return peer.fetch(mesh)

    content = shown.run(fetch)
    (file,) = {path for plan in shown.twin.built.plans for path in plan.model.meshes if path.name == "turret.stl"}
    assert content == file.read_bytes()


def test_a_client_that_only_reads_changes_no_bit():
    def state(is_shown):
        with rovers(2).build() as twin:
            twin.publish("/robot_2/forward_velocity_controller/commands", [2.0] * 4)
            if is_shown:
                shown = Shown(twin, control=True)
                try:
                    with shown.peer() as peer:
                        twin.advance_to(0.1)
                        for topic in (STATES, DESCRIPTION):
                            peer.subscribe(topic)
                        peer.messages(DESCRIPTION)  # so both subscriptions are there
                        twin.advance_to(1.234)
                        peer.messages(STATES, 100)
                finally:
                    shown.seam.close()
            twin.advance_to(1.234)
            return twin.state_sha256()

    assert state(True) == state(False)
