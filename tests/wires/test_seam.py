"""Between a twin and its wires: what is sent, what is heard, and what it costs."""

import logging
import struct
import threading
from functools import partial

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from hypothesis import given, settings
from hypothesis import strategies as st
from local_wire import LocalEnd, LocalWire
from rosbags.typesys import Stores, get_typestore
from waiting import until

from drake_twin import InputError, Robot, messages
from drake_twin.controllers.joint_state_broadcaster import JointStateBroadcaster
from drake_twin.messages.draft import Drafter
from drake_twin.messages.interface_types import make, serialize
from drake_twin.systems.robot_state_publisher import RobotStatePublisher
from drake_twin.twin.inbox import MOST_BYTES
from drake_twin.twin.replay import replay
from drake_twin.wires.seam import Seam

JAZZY = get_typestore(Stores.ROS2_JAZZY)
STATES = "/robot_1/joint_states"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
NUMBERS = "std_msgs/msg/Float64MultiArray"


@pytest.fixture
def wired():
    """A twin of two rovers with a wire."""
    twin, wire = rovers(2).build(), LocalWire()
    seam = Seam(twin, [wire])
    yield twin, wire, seam
    if not wire.is_closed:
        seam.close()


def command(*values):
    return serialize(messages.float64_multi_array(values))


def test_nobody_listens_and_nothing_is_sent(wired):
    twin, wire, seam = wired
    twin.advance_to(0.2)
    seam.close()
    latched = {name for name, sender in wire.senders.items() if sender.topic.latched}
    assert {name for name, sender in wire.senders.items() if sender.sent} == latched - {"/rosout"}  # nobody has logged
    assert "/robot_1/robot_description" in wire.senders
    assert wire.is_closed


def test_the_last_messages_of_a_robot_that_is_deleted_are_sent(wired):
    """The thread that sends is busy until the robot is gone."""
    twin, wire, seam = wired
    sent = wire.hear("/robot_2/joint_states")
    busy = threading.Event()
    seam._outbox.then(busy.wait)
    twin.advance_to(0.1)
    sender = wire.senders["/robot_2/joint_states"]
    at_end = []
    sender.close = lambda: at_end.append(len(sent))

    def go_on():
        until(lambda: "robot_2" not in twin.robots)
        busy.set()

    thread = threading.Thread(target=go_on)
    thread.start()
    twin.entities.delete("robot_2")
    twin.advance_to(0.2)
    thread.join()
    assert at_end == [len(sent)] == [10]


def test_messages_are_made_in_the_senders_thread_only(wired, monkeypatch):
    def make(self, *_):
        raise AssertionError("a message was made")

    monkeypatch.setattr(JointStateBroadcaster, "_calc_joint_states", make)
    monkeypatch.setattr(RobotStatePublisher, "_calc_tf", make)
    twin, wire, seam = wired
    topics = [STATES, "/robot_2/joint_states", "/tf"]
    sent = {topic: wire.hear(topic) for topic in topics}
    twin.advance_to(0.1)
    threads = set()
    monkeypatch.setattr(Drafter, "serialized", lambda *_: threads.add(threading.current_thread().name) or b"")
    twin.advance_to(0.5)
    seam.close()
    assert {topic: len(data) for topic, data in sent.items()} == {STATES: 50, "/robot_2/joint_states": 50, "/tf": 10}
    assert threads == {"drake_twin sender"}


def test_a_topic_is_sent_at_its_rate_while_somebody_listens(wired):
    twin, wire, seam = wired
    sent = wire.hear(STATES)
    twin.advance_to(0.5)
    seam.flush()
    wire.hear(STATES, False)
    twin.advance_to(1.0)
    seam.close()
    decoded = [JAZZY.deserialize_cdr(data, "sensor_msgs/msg/JointState") for data, _ in sent]
    stamps = [message.header.stamp.sec * 10**9 + message.header.stamp.nanosec for message in decoded]
    assert stamps == [time for _, time in sent] == [10_000_000 * index for index in range(50)]
    assert decoded[0].name[0] == "robot_1_front_left_wheel_joint"


def test_all_wires_get_the_same_bytes_which_are_made_once(monkeypatch):
    twin, wires = rovers(1).build(), [LocalWire(), LocalWire()]
    seam = Seam(twin, wires)
    sent = [wire.hear(STATES) for wire in wires]
    twin.advance_to(0.1)
    seam.close()
    assert len(sent[0]) == 10
    assert all(one[0] is other[0] for one, other in zip(*sent, strict=True))


def test_a_command_takes_effect_at_a_step_and_its_replay_ends_in_the_same_state(wired):
    twin, wire, _ = wired
    twin.recorder.begin()
    twin.advance_to(0.0073)
    wire.listeners[COMMANDS].call(command(3.0, 3.0, 3.0, 3.0))
    twin.advance_to(0.5)
    assert twin.robot_state("robot_1").velocities[0] > 1.0
    assert twin.robot_state("robot_2").velocities[0] == pytest.approx(0.0, abs=1e-6)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_wires_that_nobody_uses_change_no_bit(wired):
    twin, wire, _ = wired
    alone = rovers(2).build()
    for each in (twin, alone):
        each.publish(COMMANDS, [2.0] * 4)
    wire.hear(STATES)
    twin.advance_to(0.4)
    alone.advance_to(0.4)
    assert twin.state_sha256() == alone.state_sha256()


def test_a_command_from_another_thread_is_done_in_the_thread_that_advances(wired):
    twin, wire, _ = wired
    threads = []
    publish = twin.publish
    twin.publish = lambda *arguments: (threads.append(threading.current_thread()), publish(*arguments))
    other = threading.Thread(target=lambda: wire.listeners[COMMANDS].call(command(1, 1, 1, 1)))
    other.start()
    other.join()
    assert threads == []
    twin.advance_to(0.1)
    assert threads == [threading.current_thread()]


def test_a_spawn_brings_topics_and_a_delete_takes_them_off(wired):
    twin, wire, _ = wired
    twin.entities.spawn(Robot("new", ROVER, xyz=(-3.0, 0.0, 0.13)))
    twin.advance_to(0.01)
    assert "/new/joint_states" in wire.senders
    assert not wire.listeners["/new/forward_velocity_controller/commands"].is_closed
    sent = wire.hear("/new/joint_states")
    twin.advance_to(0.1)
    twin.entities.delete("new")
    twin.advance_to(0.2)
    assert wire.senders["/new/joint_states"].is_closed
    assert wire.listeners["/new/forward_velocity_controller/commands"].is_closed
    assert not wire.senders[STATES].is_closed
    assert len(sent) == 9


def test_what_was_heard_of_a_robot_that_is_gone_is_not_sent_when_its_like_comes(wired):
    twin, wire, seam = wired
    wire.hear("/robot_1/joint_states")
    twin.advance_to(0.05)
    twin.entities.delete("robot_1")
    twin.advance_to(0.06)
    seam.flush()
    old = wire.senders.pop("/robot_1/joint_states")
    count = len(old.sent)
    assert old.is_closed
    twin.entities.spawn(Robot("robot_1", ROVER, xyz=(3, 0, 0.13)))
    twin.advance_to(0.07)
    sent = wire.hear("/robot_1/joint_states")
    twin.advance_to(0.2)
    seam.flush()
    assert count > 0
    assert len(old.sent) == count
    assert len(sent) > 0


def test_a_command_that_publish_refuses_is_refused_in_the_same_words_and_logged_once(wired, caplog):
    twin, wire, _ = wired
    with pytest.raises(Exception, match="not a finite number") as refused:
        twin.publish(COMMANDS, [np.nan, 0, 0, 0])
    for _ in range(5):
        wire.listeners[COMMANDS].call(command(np.nan, 0, 0, 0))
    with caplog.at_level(logging.WARNING):
        twin.advance_to(0.1)
    (line,) = caplog.messages
    assert line == f"{COMMANDS}: {refused.value}"


def test_bytes_that_are_no_message_are_refused(wired, caplog):
    twin, wire, _ = wired
    good = command(1, 2, 3, 4)
    lies = good[:12] + struct.pack("<I", 4_000_000_000) + good[16:]  # the number of elements
    for data in (b"", b"\0", good[:11], lies, bytes(1 << 21)):
        wire.listeners[COMMANDS].call(data)
    twin.advance_to(0.05)
    assert twin.graph.command(COMMANDS) is None
    assert all(COMMANDS in line for line in caplog.messages)
    assert len(caplog.messages) == 2  # too large, and what cannot be decoded: one line a cause


@settings(max_examples=200, deadline=None)
@given(data=st.binary(max_size=200))
def test_random_bytes_are_decoded_or_refused(data):
    from drake_twin.messages.interface_types import deserialize

    for kind in (NUMBERS, "geometry_msgs/msg/TwistStamped", "trajectory_msgs/msg/JointTrajectory"):
        for text in (data, b"\0\1\0\0" + data):
            try:
                message = deserialize(kind, text)
            except ValueError:
                continue
            assert message.__msgtype__ == kind


def test_an_inbox_that_is_full_keeps_stops_and_the_newest_of_each_topic(wired):
    twin, wire, _ = wired
    other = "/robot_2/forward_velocity_controller/commands"
    published = []
    twin.publish = lambda topic, message: published.append((topic, tuple(message.data)))
    wire.listeners[other].call(command(7, 7, 7, 7))
    wire.listeners[COMMANDS].call(command(0, 0, 0, 0))
    for index in range(3000):
        wire.listeners[COMMANDS].call(command(index, 1, 1, 1))
    twin.advance_to(0.001)
    assert len(published) == 1000
    assert (other, (7.0, 7.0, 7.0, 7.0)) in published
    assert published[1] == (COMMANDS, (0.0, 0.0, 0.0, 0.0))
    assert published[-1] == (COMMANDS, (2999.0, 1.0, 1.0, 1.0))


class Echo:
    """A service that is done between advances if it is asked to."""

    type = "std_srvs/srv/SetBool"
    node = "/echo"

    def __init__(self, name, answer, between_advances=False):
        self.name, self.answer, self.between_advances = name, answer, between_advances


def asked(wire, name, value):
    replies = []
    wire.services[name].call(serialize(make("std_srvs/srv/SetBool_Request", {"data": value})), replies.append)
    return replies


def response(replies):
    from drake_twin.messages.interface_types import deserialize

    (data,) = replies
    found = deserialize("std_srvs/srv/SetBool_Response", data)
    return found.success, found.message


def test_large_messages_that_wait_do_not_fill_the_memory(wired):
    """Those of a topic that are older than the newest make room."""
    twin, _, _ = wired
    done, size = [], MOST_BYTES // 4
    for number in range(8):
        twin.inbox.put(partial(done.append, number), "/camera", size=size)
    twin.inbox.put(partial(done.append, "small"), "/small")
    assert sum(item.size for item in twin.inbox._waiting) <= MOST_BYTES + size
    twin.inbox.look()
    assert done[-2:] == [7, "small"]
    assert len(done) < 8
    assert twin.inbox.put(done.clear, "/camera", size=size)  # there is room again


def test_services_answer_at_a_step_or_between_advances_and_later():
    twin, wire = rovers(1).build(), LocalWire()

    def slowly(request):
        for _ in range(3):
            yield
        return {"success": True, "message": f"{twin.time:.3f}"}

    def refused(request):
        raise messages_error

    messages_error = InputError("not today")
    services = [
        Echo("/now", lambda request: {"success": request.data, "message": f"{twin.time:.3f}"}),
        Echo("/between", lambda request: (twin.reset(), {"success": True})[1], between_advances=True),
        Echo("/later", slowly),
        Echo("/refused", refused),
    ]
    seam = Seam(twin, [wire], lambda twin: services)
    twin.advance_to(0.1)
    replies = {name: asked(wire, name, True) for name in ("/now", "/later", "/refused")}
    twin.advance_to(0.2)
    seam.flush()
    assert response(replies["/now"]) == (True, "0.100")
    assert response(replies["/later"])[0]
    assert response(replies["/refused"]) == (False, "not today.")
    reset = asked(wire, "/between", True)
    assert reset == []
    twin.advance_to(0.1)
    seam.flush()
    assert response(reset)[0]
    assert twin.time == pytest.approx(0.1)
    twin.pause()
    paused = asked(wire, "/now", False)
    twin.inbox.work()
    seam.flush()
    assert response(paused) == (False, "0.100")
    seam.close()


def test_an_answer_that_takes_longer_is_not_lost_when_it_fails_or_finds_no_room():
    twin, wire = rovers(1).build(), LocalWire()

    def failing(request):
        yield
        raise InputError("not after all")

    def waiting(request):
        while True:
            yield

    seam = Seam(twin, [wire], lambda twin: [Echo("/failing", failing), Echo("/waiting", waiting)])
    failed, waited = asked(wire, "/failing", True), asked(wire, "/waiting", True)
    twin.advance_to(0.1)
    assert response(failed) == (False, "not after all.")
    assert waited == []
    twin.inbox.put = lambda *arguments, **more: False  # it is full
    twin.advance_to(0.2)
    assert response(waited) == (False, "too many requests wait")
    seam.close()


def test_a_response_that_a_wire_cannot_send_stops_no_other(caplog):
    """The thread that sends goes on: the next response comes, and the end does not wait for ever."""
    twin, wire = rovers(1).build(), LocalWire()
    seam = Seam(twin, [wire], lambda twin: [Echo("/now", lambda request: {"success": True})])

    def lost(data):
        raise OSError("the wire has ended")

    wire.services["/now"].call(serialize(make("std_srvs/srv/SetBool_Request", {"data": True})), lost)
    sent = asked(wire, "/now", True)
    twin.advance_to(0.1)
    seam.close()
    assert response(sent)[0]
    assert "services: a response is not sent: the wire has ended" in caplog.text
    twin.close()


class Asking(LocalWire):
    """A wire over which services of other programs are asked."""

    def __init__(self):
        super().__init__()
        self.clients = {}

    def client(self, service, changed):
        return self.clients.setdefault(service.name, LocalEnd(service, changed))


class OfNodes:
    """What nodes ask of other programs; how often they were told that a service has come or gone."""

    def __init__(self, *names):
        self.names, self.count = names, 0

    def loaded(self, twin):
        return self.names

    def absent(self, twin):
        return ()

    def wanted(self):
        return [Echo(name, None) for name in self.names]

    def look_again(self):
        self.count += 1

    def topics(self):
        return ()

    news = topics

    def proceed(self):
        pass


def test_services_of_other_programs_are_looked_for_and_told_in_the_thread_that_advances():
    with rovers(1).build() as twin:
        wire, actions = Asking(), OfNodes("/first", "/second")
        seam = Seam(twin, [wire], actions=actions)
        assert {name: end.endpoint.node for name, end in wire.clients.items()} == {
            "/first": "/echo",
            "/second": "/echo",
        }
        thread = threading.Thread(target=wire.clients["/first"].call)
        thread.start()
        thread.join()
        assert actions.count == 0
        twin.advance_to(0.01)
        assert actions.count == 1
        actions.names = ("/second",)
        twin.advance_to(0.02)
        assert {name: end.is_closed for name, end in wire.clients.items()} == {"/first": True, "/second": False}
        seam.close()


def test_endpoints_name_the_nodes_that_a_ros_user_looks_for():
    twin = rovers(1).robot("arm", ARM, xyz=(0, -3, 0)).build()
    nodes = {(item.kind, item.name): item.node for item in twin.graph.endpoints}
    assert nodes["published", STATES] == "/robot_1/joint_state_broadcaster"
    assert nodes["published", "/robot_1/robot_description"] == "/robot_1/robot_state_publisher"
    assert nodes["commanded", COMMANDS] == "/robot_1/forward_velocity_controller"
    assert nodes["published", "/clock"] == "/drake_twin"
    assert twin.graph.endpoints is twin.graph.endpoints
