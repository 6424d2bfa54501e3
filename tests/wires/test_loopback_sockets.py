"""Sockets that are opened on all interfaces, held to the loopback interface."""

import os
import shutil
import socket
import subprocess
import sys

import pytest

from drake_twin.wires.loopback_sockets import loopback_only

linux_only = pytest.mark.skipif(sys.platform != "linux", reason="SO_BINDTODEVICE is Linux'")


def device_of(held):
    return held.getsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, 16).rstrip(b"\0")


def udp(address):
    made = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    made.bind((address, 0))
    return made


@linux_only
def test_sockets_on_all_interfaces_that_are_opened_meanwhile_are_held():
    with udp("0.0.0.0") as before, loopback_only() as open_ports:
        wild, own, stream = udp("0.0.0.0"), udp("127.0.0.1"), socket.create_server(("0.0.0.0", 0))
    with wild, own, stream:
        assert open_ports == []
        assert device_of(wild) == b"lo"
        assert [device_of(item) for item in (own, stream)] == [b"", b""]
        wild.settimeout(5.0)
        own.sendto(b"hello", ("127.0.0.1", wild.getsockname()[1]))
        assert wild.recv(10) == b"hello"
    with udp("0.0.0.0") as after:
        assert device_of(after) == b""
    assert before.fileno() == -1


@linux_only
def test_what_cannot_be_held_is_told(monkeypatch):
    def refuse(*_):
        raise PermissionError(1, "Operation not permitted")

    with loopback_only() as open_ports:
        wild = udp("0.0.0.0")
        monkeypatch.setattr(socket.socket, "setsockopt", refuse, raising=False)
    with wild:
        assert open_ports == [wild.getsockname()[1]]


_BESIDE = """
import socket, subprocess, sys
from drake_twin.wires.loopback_sockets import loopback_only
run = lambda *words: subprocess.run(words, check=True)
other = subprocess.Popen(["unshare", "-n", sys.executable, "-c", "print(flush=True); input()"],
    stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
other.stdout.readline()
inside = ["nsenter", "-t", str(other.pid), "-n"]
run("ip", "link", "add", "here", "type", "veth", "peer", "name", "there", "netns", str(other.pid))
for where, name, address in (([], "here", "10.77.0.2/24"), (inside, "there", "10.77.0.3/24")):
    run(*where, "ip", "address", "add", address, "dev", name)
    run(*where, "ip", "link", "set", name, "up")
run("ip", "link", "set", "lo", "up")
def made():
    item = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    item.bind(("0.0.0.0", 0))
    return item
with loopback_only() as open_ports:
    held = made()
free = made()
send = "import socket, sys\\nto = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)\\n"
send += "for port in sys.argv[1:]: to.sendto(b'x', ('10.77.0.2', int(port)))"
ports = [str(item.getsockname()[1]) for item in (held, free)]
run(*inside, sys.executable, "-c", send, *ports)
free.settimeout(10.0)
print("free", free.recv(9))
held.setblocking(False)
try:
    print("held", held.recv(9))
except BlockingIOError:
    print("held nothing")
print(open_ports)
other.kill()
"""


def may_make_interfaces():
    words = ["unshare", "-Urn", "ip", "link", "add", "here", "type", "veth", "peer", "name", "there"]
    return shutil.which("unshare") and shutil.which("ip") and subprocess.run(words, capture_output=True).returncode == 0


@linux_only
@pytest.mark.skipif(not may_make_interfaces(), reason="this system lets nobody make a network interface (unshare, ip)")
def test_nothing_arrives_from_a_second_interface():
    """A datagram from beyond a second interface reaches a free socket, which was sent to later, and not a held one."""
    environment = os.environ | {"PYTHONPATH": os.pathsep.join(sys.path)}
    words = ["unshare", "-Urn", sys.executable, "-c", _BESIDE]
    done = subprocess.run(words, capture_output=True, text=True, timeout=60, env=environment)
    assert done.stdout.splitlines() == ["free b'x'", "held nothing", "[]"], done.stderr
