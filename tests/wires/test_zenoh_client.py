"""A client beside a twin: whom it sees, and services that answer, refuse or are not there."""

import contextlib
import subprocess
import sys

import pytest
from conftest import rovers
from wires.ros_client import while_running
from wires.zenoh_peer import free_port

from drake_twin.errors import RunError
from drake_twin.messages.interface_types import type_hash
from drake_twin.services.graph import connect
from drake_twin.wires.wire import WireEndpoint
from drake_twin.wires.zenoh_client import ZenohClient
from drake_twin.wires.zenoh_session import open_session
from drake_twin.wires.zenoh_wire import ZenohWire

pytest.importorskip("zenoh")

# A look at the graph whose session does other things after the first reply has come, as busy programs do.
BUSY_LOOK = """
import itertools
import sys
from drake_twin.wires.zenoh_client import ZenohClient

class Busy:
    def __init__(self, session):
        self._session = session
    def liveliness(self):
        return self
    def get(self, *arguments):
        replies = self._session.liveliness().get(*arguments)
        first = replies.recv()
        for _ in range(3000):
            self._session.liveliness().declare_token("busy").undeclare()
        return itertools.chain([first], replies)

client = ZenohClient(sys.argv[1], 9)
client._session, session = Busy(client._session), client._session
print(len(client.tokens(9)))
client._session = session
client.close()
"""

DOMAIN, KIND = 9, "std_srvs/srv/Empty"
EMPTY = b"\x00\x01\x00\x00\x00"


@pytest.fixture
def port():
    return free_port()


@contextlib.contextmanager
def zenoh_session(port):
    opened = open_session(port=port)
    yield opened.session
    opened.session.close()


@pytest.fixture
def twin(port):
    with rovers(1).build() as twin:
        seam = connect(twin, [ZenohWire(domain=DOMAIN, port=port)])
        try:
            yield twin
        finally:
            seam.close()


@pytest.fixture
def client(twin, port):
    found = ZenohClient(f"127.0.0.1:{port}", DOMAIN)
    yield found
    found.close()


def endpoint(name, kind):
    return WireEndpoint(name, kind, type_hash(kind), "/asker")


def test_it_sees_the_twins_endpoints_and_domain(twin, client):
    entities = client.entities()
    published = {item.name: item.type for item in entities if item.kind == "MP"}
    assert published["/robot_1/joint_states"] == "sensor_msgs/msg/JointState"
    heard = {item.name: item.type for item in entities if item.kind == "MS"}
    assert heard["/robot_1/forward_velocity_controller/commands"] == "std_msgs/msg/Float64MultiArray"
    assert client.domains() == [DOMAIN]


def test_a_service_answers_with_bytes(twin, client):
    service = endpoint("/drake_twin/get_simulation_state", "simulation_interfaces/srv/GetSimulationState")
    answer = while_running(twin, lambda: client.call(service, EMPTY, 30.0))
    assert isinstance(answer, bytes)
    state, result = answer[4], answer[8]
    assert (state, result) == (1, 1)  # playing, and the result is OK


def test_a_service_that_is_not_there_does_not_answer(client):
    with pytest.raises(RunError, match="/nobody does not answer"):
        client.call(endpoint("/nobody", KIND), EMPTY, 0.2)


def test_a_look_at_a_large_graph_ends(port):
    """Zenoh's own channel of 256 replies stopped the session for ever, with ten robots."""
    with zenoh_session(port) as session:
        tokens = [session.liveliness().declare_token(f"@ros2_lv/{DOMAIN}/{number}") for number in range(1000)]
        words = [sys.executable, "-c", BUSY_LOOK, f"127.0.0.1:{port}"]
        result = subprocess.run(words, capture_output=True, text=True, timeout=60)
        assert (result.stdout, result.stderr) == (f"{len(tokens)}\n", "")
