"""Servers and clients of services over DDS, between two participants of one process."""

import os
import threading
from types import SimpleNamespace

import pytest
from waiting import until

from drake_twin.messages.interface_types import deserialize, make, serialize
from drake_twin.wires.wire import WireEndpoint

pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")

DOMAIN = 200 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
KIND = "rcl_interfaces/srv/ListParameters"
SERVICE = WireEndpoint("/do", KIND, "", "/node")


@pytest.fixture
def participants():
    from cyclonedds.core import Qos
    from cyclonedds.domain import Domain, DomainParticipant

    from drake_twin.wires.rmw_dds_format import configuration

    domain = Domain(DOMAIN, configuration("127.0.0.1", multicast=False))
    made = [DomainParticipant(DOMAIN, Qos()) for _ in range(2)]
    yield made
    made.clear()
    del domain


def test_each_client_gets_the_answers_to_its_own_requests(participants):
    """Eight: a client's number on the graph has 64 bits, of which the first is set for half of them."""
    from drake_twin.wires.dds_service import DdsClient, DdsServer
    from drake_twin.wires.rmw_dds_format import service_id

    wire = SimpleNamespace(lock=threading.RLock(), forget=lambda endpoint: None)
    serving, asking = participants

    def name(participant, number):
        return service_id(participant.guid.bytes, number)

    def answer(request, reply):
        names = deserialize(f"{KIND}_Request", request).prefixes
        reply(serialize(make(f"{KIND}_Response", {"result": {"names": names}})))

    server = DdsServer(wire, serving, SERVICE, name(serving, 1), answer)
    changes = []
    clients = [DdsClient(wire, asking, SERVICE, name(asking, n), lambda: changes.append(1)) for n in range(1, 9)]

    def step():
        for end in (server, *clients):
            end.take()
            end.look()

    until(lambda: (step(), all(client.is_there for client in clients))[1])
    assert len(changes) == 8
    answers = []
    for number, client in enumerate(clients):
        for turn in range(2):
            request = serialize(make(f"{KIND}_Request", {"prefixes": [f"{number} {turn}"]}))
            client.ask(request, lambda data, asked=f"{number} {turn}": answers.append((asked, data)))
    until(lambda: (step(), len(answers) == 16)[1])
    found = {asked: deserialize(f"{KIND}_Response", data).result.names for asked, data in answers}
    assert found == {f"{number} {turn}": [f"{number} {turn}"] for number in range(8) for turn in range(2)}
    server.close()
    until(lambda: (step_of(clients), not any(client.is_there for client in clients))[1])
    assert len(changes) == 16


def step_of(clients):
    for client in clients:
        client.look()
