"""Which ports processes listen at, asked from the system."""

import os
import socket
import subprocess
import sys

import pytest

from drake_twin.sweeps.listening import Port, family, ports_of

pytestmark = pytest.mark.skipif(not os.path.exists("/proc/net/tcp"), reason="asks Linux")


@pytest.mark.parametrize(
    ("host", "address", "is_reachable"),
    [
        ("127.0.0.1", "127.0.0.1", False),
        ("127.3.0.9", "127.3.0.9", False),
        ("0.0.0.0", "0.0.0.0", True),
        ("::", "::", True),
        ("::1", "::1", False),
        ("::ffff:127.0.0.1", "::ffff:127.0.0.1", False),
    ],
)
def test_a_port_is_found_with_what_it_is_bound_to(host, address, is_reachable):
    with socket.socket(socket.AF_INET6 if ":" in host else socket.AF_INET) as server:
        try:
            server.bind((host, 0))
        except OSError as error:
            pytest.skip(f"this machine has no {host}: {error}")
        number = server.getsockname()[1]
        assert number not in [port.number for port in ports_of([os.getpid()])]
        server.listen()
        (port,) = [port for port in ports_of([os.getpid()]) if port.number == number]
    assert (port.address, port.is_reachable) == (address, is_reachable)
    assert number not in [port.number for port in ports_of([os.getpid()])]


def test_other_addresses_of_a_machine_are_reachable():
    assert Port(80, "192.0.2.2", "a").is_reachable
    assert Port(80, "::ffff:192.0.2.2", "a").is_reachable


def test_a_family_is_the_processes_with_a_text_and_what_they_have_started():
    child = "import sys; print('up', flush=True); sys.stdin.read()"
    parent = f"import subprocess, sys; print(subprocess.Popen([sys.executable, '-c', {child!r}]).pid, flush=True); "
    command = [sys.executable, "-c", parent + "sys.stdin.read()", "a-name-of-its-own"]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:
        started = {process.pid, int(process.stdout.readline())}
        assert started <= family("a-name-of-its-own")  # this process may hold the text, too
        assert not started & family("another-name-of-its-own")
        process.stdin.close()
