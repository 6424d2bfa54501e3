"""A mirror on wires: what it hears, what it tells, and that it never offers a topic that moves a robot."""

import pytest
from real_robot import COMMANDS, JOINT_STATES, PLACE, Run, real
from wires.local_wire import LocalWire
from wires.zenoh_peer import free_port, peer, tokens

from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.mirror.check_service import NAME, TYPE
from drake_twin.mirror.live import DIAGNOSTICS, RESIDUALS, Live
from drake_twin.mirror.mirror import Mirror
from drake_twin.twin.endpoints import COMMANDED

TOLD = {DIAGNOSTICS, RESIDUALS}


@pytest.fixture(scope="module")
def robot():
    found = real("rover")
    yield found
    found.close()


@pytest.fixture
def mirror(robot):
    mirror = Mirror(robot.scenario)
    yield mirror
    mirror.close()


def follow(live, until):
    """Follow until something holds; a few seconds of wall time are the end of any."""
    stopped = []

    def each_frame():
        if until():
            stopped.append(15)

    live.run(stopped, 60.0, each_frame)
    assert until()


def test_it_hears_commands_and_measurements_and_offers_what_it_tells_only(robot, mirror):
    wire = LocalWire()
    live = Live(mirror, [wire])
    assert wire.senders.keys() == TOLD
    assert wire.services.keys() == {NAME}
    assert {COMMANDS, JOINT_STATES, PLACE} <= wire.listeners.keys()
    for heard in robot.run(Run(duration=0.5)):
        wire.listeners[heard.topic].call(serialize(heard.message))
    follow(live, lambda: mirror.arrivals[JOINT_STATES].count == 25 and mirror.zero is not None)
    live.close()
    assert wire.is_closed


def test_diagnostics_have_a_status_for_each_robot(mirror):
    wire = LocalWire()
    live = Live(mirror, [wire])
    live.tell(0.0)
    assert wire.senders[DIAGNOSTICS].sent == []
    wire.hear(DIAGNOSTICS)
    wire.hear(RESIDUALS)
    live.tell(0.5)
    assert wire.senders[DIAGNOSTICS].sent == []  # once a second
    live.tell(1.1)
    ((data, _),) = wire.senders[DIAGNOSTICS].sent
    (status,) = deserialize("diagnostic_msgs/msg/DiagnosticArray", data).status
    assert (status.name, status.hardware_id) == ("twin: robot_1", "robot_1")
    assert (bytes([status.level]) if isinstance(status.level, int) else status.level) == b"\x01"
    assert status.message == "what is healthy is being learned"
    live.close()


def test_what_cannot_be_decoded_is_noted_and_a_flood_is_an_error_at_the_end(mirror):
    wire = LocalWire()
    live = Live(mirror, [wire])
    for _ in range(20_001):
        wire.listeners[JOINT_STATES].call(b"\x00")
    follow(live, lambda: bool(mirror.notes))
    assert JOINT_STATES in mirror.notes[0]
    live.close()
    assert mirror.notes[-1].startswith("1 messages were lost")


def test_a_trajectory_is_checked_before_the_robot_moves(mirror):
    wire = LocalWire()
    live = Live(mirror, [wire])
    answers = []
    request = {"topic": "/no/such", "trajectory": {"joint_names": ["a"]}, "duration": 1.0}
    wire.services[NAME].call(serialize(make(f"{TYPE}_Request", request)), answers.append)
    wire.services[NAME].call(b"\x00", answers.append)
    follow(live, lambda: len(answers) == 2)
    bad, refused = sorted((deserialize(f"{TYPE}_Response", data) for data in answers), key=lambda item: len(item.kinds))
    assert not refused.is_safe
    assert refused.kinds == ["refused"]
    assert "/no/such" in refused.texts[0]
    assert not bad.is_safe
    assert bad.message
    live.close()


def test_on_a_real_wire_no_topic_is_published_that_a_robot_hears(mirror):
    pytest.importorskip("zenoh")
    from drake_twin.wires.zenoh_wire import ZenohWire

    port = free_port()
    live = Live(mirror, [ZenohWire(7, port=port)])
    with peer(port) as session:
        published = {token.split("/")[9].replace("%", "/") for token in tokens(session) if "/MP/" in token}
        heard = {token.split("/")[9].replace("%", "/") for token in tokens(session) if "/MS/" in token}
    commanded = {item.name for item in mirror.twin.graph.endpoints if item.kind == COMMANDED}
    live.close()
    assert published == TOLD
    assert published.isdisjoint(commanded)
    assert commanded <= heard
