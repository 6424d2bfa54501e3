"""What of others on the graph over DDS does not fit, while it is there."""

import os

import pytest
from waiting import until

from drake_twin.wires.wire import WireEndpoint

pytest.importorskip("cyclonedds", reason="cyclonedds is not installed")

DOMAIN = 190 + int(os.environ.get("PYTEST_XDIST_WORKER", "gw0")[2:])
ARRAY, STRING = "std_msgs/msg/Float64MultiArray", "std_msgs/msg/String"


@pytest.fixture
def graph():
    """Two participants on the loopback interface, and what one discovers of the other."""
    from cyclonedds.core import Qos
    from cyclonedds.domain import Domain, DomainParticipant

    from drake_twin.wires.dds_discovery import Discovery
    from drake_twin.wires.rmw_dds_format import configuration

    domain = Domain(DOMAIN, configuration("127.0.0.1", multicast=False))
    own, other = (DomainParticipant(DOMAIN, Qos()) for _ in range(2))
    yield Discovery(own), other
    del own, other, domain


def test_what_another_program_publishes_with_another_type_is_told_while_it_is_there(graph, caplog):
    from drake_twin.wires.dds_discovery import End
    from drake_twin.wires.dds_endpoints import quality, reader, writer

    discovery, other = graph
    ends = [
        End(WireEndpoint(name, ARRAY, "", "/node"), f"rt{name}", ARRAY, bytes(16), is_reader=is_reader)
        for name, is_reader in (("/gone", True), ("/heard", True), ("/said", False), ("/same", True))
    ]

    def told():
        discovery.take()
        discovery.tell(ends)
        return caplog.messages

    gone = writer(other, "rt/gone", STRING, quality(b""))
    del gone  # before it is looked at
    there = [writer(other, name, kind, quality(b"")) for name, kind in (("rt/said", STRING), ("rt/same", ARRAY))]
    there += [writer(other, "rt/heard", STRING, quality(b"")), reader(other, "rt/said", STRING, quality(b""))]
    until(lambda: len(told()) >= 2)
    assert sorted(told()) == [
        f"/heard: another program publishes {STRING}, but the topic's type is {ARRAY}",
        f"/said: another program subscribes to {STRING}, but the topic's type is {ARRAY}",
    ]
    del there
