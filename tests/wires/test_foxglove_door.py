"""Who may pass to Foxglove's server: programs, and pages of Foxglove."""

import argparse
import socket
import threading

import pytest

from drake_twin.errors import InputError
from drake_twin.wires import foxglove_door
from drake_twin.wires.foxglove_door import FoxgloveDoor, hidden_address
from drake_twin.wires.kinds.foxglove import FoxgloveKind


@pytest.fixture
def echo():
    """A server that repeats what it hears; its address."""
    listening = socket.create_server(("127.0.0.1", 0))

    def serve():
        while True:
            try:
                client, _ = listening.accept()
            except OSError:
                return
            threading.Thread(target=repeat, args=(client,), daemon=True).start()

    def repeat(client):
        with client:
            while data := client.recv(65536):
                client.sendall(data)

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    yield listening.getsockname()
    listening.shutdown(socket.SHUT_RDWR)
    listening.close()
    thread.join()


@pytest.fixture
def door(echo):
    door = FoxgloveDoor("127.0.0.1", 0, ["http://localhost:8080"])
    door.lead_to(echo)
    yield door
    door.close()


def answer(door, *headers, end=b"\r\n\r\n"):
    with socket.create_connection(("127.0.0.1", door.port), 10) as client:
        client.sendall("\r\n".join(("GET / HTTP/1.1", *headers)).encode("latin-1") + end)
        return client.recv(65536).decode("latin-1")


@pytest.mark.parametrize(
    "headers",
    [
        ["Host: localhost:8765"],
        ["Host: 127.0.0.1"],
        ["Host: [::1]:8765", "Origin: https://app.foxglove.dev"],
        ["host:localhost:9000", "ORIGIN:  http://localhost:8080 "],  # through a tunnel, from another port
        [],
    ],
)
def test_those_who_may_pass_reach_the_server(door, headers):
    assert answer(door, *headers).startswith("GET / HTTP/1.1\r\n")


@pytest.mark.parametrize(
    ("headers", "what"),
    [
        (["Host: localhost:8765", "Origin: http://evil.example"], "a page of 'http://evil.example' may not open it"),
        (["Origin: https://app.foxglove.dev", "Origin: http://evil.example"], "may not open it"),
        (["Origin: HTTPS://APP.FOXGLOVE.DEV"], "may not open it"),
        (["Origin: null"], "may not open it"),
        (["Origin:"], "may not open it"),
        (["Host: evil.example:8765"], "the Host header names 'evil.example:8765'"),
        (["Host: localhost.evil.example"], "the Host header names"),
    ],
)
def test_others_are_refused_in_words(door, headers, what, caplog):
    said = answer(door, *headers)
    assert said.startswith("HTTP/1.1 403 Forbidden")
    assert what in caplog.text


def test_bytes_pass_in_both_directions_until_one_side_ends(door):
    sent = bytes(range(256)) * 40_000  # 10 MB, more than the sockets hold
    with socket.create_connection(("127.0.0.1", door.port), 10) as client:
        client.sendall(b"GET / HTTP/1.1\r\n\r\n")
        thread = threading.Thread(target=client.sendall, args=(sent,))
        thread.start()
        heard = b""
        while len(heard) < len(sent) + 18:
            heard += client.recv(1 << 20)
        thread.join()
    assert heard == b"GET / HTTP/1.1\r\n\r\n" + sent


def test_a_head_without_an_end_is_no_request(door, monkeypatch):
    with pytest.raises(ConnectionResetError):
        answer(door, "a" * 40_000, end=b"")
    monkeypatch.setattr(foxglove_door, "_LONGEST_WAIT", 0.05)
    assert answer(door, "Host: localhost", end=b"") == ""


def test_more_clients_than_there_is_room_for_are_sent_away(door, monkeypatch, caplog):
    monkeypatch.setattr(foxglove_door, "MOST_CLIENTS", 2)
    held = [socket.create_connection(("127.0.0.1", door.port), 10) for _ in range(2)]
    for client in held:
        client.sendall(b"GET / HTTP/1.1\r\n\r\n")
        assert client.recv(100)
    with socket.create_connection(("127.0.0.1", door.port), 10) as other:
        assert other.recv(100) == b""
    assert "more than 2 connections" in caplog.text
    for client in held:
        client.close()


def test_its_end_ends_all_and_leaves_no_thread(echo):
    door = FoxgloveDoor("127.0.0.1", 0)
    door.lead_to(echo)
    with socket.create_connection(("127.0.0.1", door.port), 10) as client:
        client.sendall(b"GET / HTTP/1.1\r\n\r\n")
        assert client.recv(100)
        door.close()
        assert client.recv(100) == b""
    assert not [item.name for item in threading.enumerate() if item.name.startswith("foxglove")]
    with socket.create_server(("127.0.0.1", door.port)):
        pass


def test_where_the_system_has_many_loopback_addresses_the_server_hides_behind_one(monkeypatch):
    monkeypatch.setattr(foxglove_door.sys, "platform", "linux")
    assert len({hidden_address() for _ in range(20)}) == 20
    monkeypatch.setattr(foxglove_door.sys, "platform", "darwin")
    assert hidden_address() == "127.0.0.1"


@pytest.mark.parametrize("origin", ["evil.example", "http://a/b", "*", "null", ""])
def test_an_option_that_is_no_origin_is_refused(origin):
    parser = argparse.ArgumentParser()
    FoxgloveKind().add_options(parser)
    with pytest.raises(InputError, match="it must read like http://localhost:8080"):
        FoxgloveKind().check(parser.parse_args(["--foxglove", f"--foxglove-origin={origin}"]))
