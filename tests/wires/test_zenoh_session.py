"""Who is the router, and what cannot be opened."""

import socket

import pytest
from wires.zenoh_peer import free_port

from drake_twin.errors import InputError
from drake_twin.wires.zenoh_session import open_session

zenoh = pytest.importorskip("zenoh")


@pytest.fixture
def first():
    """A router on a port of its own."""
    opened = open_session(port=free_port())
    yield opened
    opened.session.close()


def port_of(opened):
    return int(opened.address.rpartition(":")[2])


def test_the_first_session_is_the_router_and_the_next_ones_connect_to_it(first):
    assert first.router is None
    second = open_session(port=port_of(first))
    try:
        assert second.router == first.address
        assert second.session.info.routers_zid() == [first.session.zid()]
        socket.create_connection(("127.0.0.1", port_of(second)), timeout=5).close()
    finally:
        second.session.close()


def test_a_router_listens_only_on_the_address_that_it_is_given(first):
    with pytest.raises(OSError, match="refused"):
        socket.create_connection(("127.0.0.2", port_of(first)), timeout=5).close()
    socket.create_connection(("127.0.0.1", port_of(first)), timeout=5).close()


def test_a_router_elsewhere_is_connected_to_by_its_address(first):
    second = open_session(router=f"localhost:{port_of(first)}")
    try:
        assert second.router == f"localhost:{port_of(first)}"
        assert second.session.info.routers_zid() == [first.session.zid()]
    finally:
        second.session.close()


def test_a_port_that_another_program_has():
    with socket.create_server(("127.0.0.1", 0)) as other:
        port = other.getsockname()[1]
        with pytest.raises(InputError) as caught:
            open_session(port=port)
    assert str(caught.value) == (
        f"no Zenoh router answers at 127.0.0.1:{port}: another program has the port, or the router is not running."
    )


def test_a_router_that_does_not_answer():
    port = free_port()
    with pytest.raises(InputError, match=rf"^no Zenoh router answers at 127\.0\.0\.1:{port}: "):
        open_session(router=f"127.0.0.1:{port}")


@pytest.mark.parametrize("host", ["203.0.113.5", "no-such-host.invalid"])
def test_an_address_that_is_not_this_machines(host):
    with pytest.raises(InputError, match=rf"^cannot listen on {host}: "):
        open_session(host, free_port())


@pytest.mark.parametrize("router", ["host:", ":7447", "host:port", "host:0", "host:65536", "host:70000"])
def test_an_address_that_is_none(router):
    with pytest.raises(InputError, match=r"^'.*' is not the address of a router: write HOST or HOST:PORT"):
        open_session(router=router)


def test_zenoh_that_is_not_installed(monkeypatch):
    monkeypatch.setitem(__import__("sys").modules, "zenoh", None)
    with pytest.raises(InputError) as caught:
        open_session()
    assert str(caught.value).startswith("the ROS 2 graph needs eclipse-zenoh, which is not installed: `")
    assert str(caught.value).endswith(" -m pip install 'eclipse-zenoh>=1.6.1'`.")
