"""What docs/trust.md says of who can reach a twin: another user, another machine, a page of another site."""

import contextlib
import os
import re
import socket
import subprocess
import sys
import threading
import urllib.request
from pathlib import Path

import pytest
from waiting import until

NOBODY = 65534
AT_ALL = ["--robots", "1", "--foxglove", "--foxglove-control", "--ros", "zenoh", "--duration", "600"]

pytestmark = pytest.mark.skipif(sys.platform != "linux" or os.getuid() != 0, reason="becomes another user, as root")

# Tries each address as a stranger; prints what it was answered.
STRANGER = """
import os, socket, sys

"localhost".encode("idna")  # loads what another user may not read
user = int(sys.argv.pop(1))
if user:
    os.setgroups([])
    os.setgid(user)
    os.setuid(user)

def asked(host, port, lines):
    try:
        with socket.create_connection((host, port), 3) as client:
            client.settimeout(3)
            client.sendall("\\r\\n".join([*lines, "", ""]).encode())
            return client.recv(100).decode("latin-1").partition("\\r\\n")[0]
    except OSError as error:
        return type(error).__name__

for place in sys.argv[1:]:
    host, port, path, origin = place.split(",")
    upgrade = ["Connection: Upgrade", "Upgrade: websocket", "Sec-WebSocket-Version: 13",
               "Sec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==", "Sec-WebSocket-Protocol: foxglove.sdk.v1"]
    origins = [f"Origin: {origin}"] if origin else []
    print(asked(host, int(port), [f"GET {path} HTTP/1.1", f"Host: localhost:{port}", *upgrade, *origins]))
"""


def free():
    with socket.create_server(("127.0.0.1", 0)) as taken:
        return taken.getsockname()[1]


@pytest.fixture(scope="module")
def twin(tmp_path_factory):
    """A program with all that listens: its ports, the page's path, and the folder of its cache."""
    cache = tmp_path_factory.mktemp("cache")
    ports = {"--port": free(), "--foxglove-port": free(), "--ros-port": free()}
    words = [word for option, port in ports.items() for word in (option, str(port))]
    opener = cache / "browser"
    opener.write_text(f"#!/bin/sh\nprintf '%s\\n' \"$@\" > {cache}/opened\n")
    opener.chmod(0o755)
    process = subprocess.Popen(
        [sys.executable, "-m", "drake_twin.run", *AT_ALL, *words],
        stdout=subprocess.PIPE,
        text=True,
        env={**os.environ, "XDG_CACHE_HOME": str(cache), "DISPLAY": ":77", "BROWSER": str(opener)},
    )
    try:
        line = next(line for line in process.stdout if line.startswith("page: "))
        address, _, key = line.removeprefix("page: ").strip().partition("#")
        opening = urllib.request.Request(address, key.encode(), {"Origin": address.rstrip("/")})
        with urllib.request.urlopen(opening) as answer:
            yield [*ports.values()], f"/{answer.read().decode()}/", cache, process.pid, key
    finally:
        process.terminate()
        process.communicate(timeout=60)


def strangers_answers(places, *prefix, user=NOBODY):
    words = [*prefix, sys.executable, "-S", "-c", STRANGER, str(user), *(",".join(map(str, place)) for place in places)]
    result = subprocess.run(words, capture_output=True, text=True, timeout=60, check=False)
    if "Operation not permitted" in result.stderr:
        pytest.skip(f"the system lets none do this: {result.stderr.strip()[-200:]}")
    assert result.returncode == 0, result.stderr
    return result.stdout.splitlines()


def test_another_user_does_not_find_the_page_and_learns_its_secrets_nowhere(twin):
    (port, *_), path, cache, pid, key = twin
    opened = until(lambda: (cache / "opened").exists() and (cache / "opened").read_text())  # its command line
    token = path.strip("/")
    assert opened.startswith("file://")
    for secret in (token, key):
        assert secret not in opened
        assert secret not in Path(f"/proc/{pid}/cmdline").read_text()
    page = cache / "drake_twin" / "page"
    assert {file.stat().st_mode & 0o777 for file in page.iterdir()} == {0o600}
    own = f"http://localhost:{port}"
    answers = strangers_answers(
        [
            ("127.0.0.1", port, place, own)
            for place in ("/page.js", "/socket", "/x/socket", "/scene/socket", f"/{token[:-1]}/")
        ]
    )
    assert answers == ["HTTP/1.1 403 Forbidden"] * 5


def listeners(pid):
    """The addresses and TCP ports at which a process listens."""
    own = set()
    for entry in os.listdir(f"/proc/{pid}/fd"):
        with contextlib.suppress(OSError):
            own.add(os.readlink(f"/proc/{pid}/fd/{entry}"))
    found = set()
    for table in ("tcp", "tcp6"):
        for line in Path(f"/proc/{pid}/net/{table}").read_text(encoding="ascii").splitlines()[1:]:
            _, local, _, state, *rest = line.split()
            if state == "0A" and f"socket:[{rest[5]}]" in own:
                address, _, port = local.partition(":")
                found.add((".".join(str(byte) for byte in reversed(bytes.fromhex(address))), int(port, 16)))
    return found


def test_the_program_listens_at_what_the_table_names_and_nowhere_else(twin):
    ports, *_, pid, _ = twin
    found = listeners(pid)
    assert {("127.0.0.1", port) for port in ports} < found
    (hidden,) = found - {("127.0.0.1", port) for port in ports}  # Foxglove's own server
    assert re.fullmatch(r"127\.\d+\.\d+\.\d+", hidden[0])
    assert hidden[0] != "127.0.0.1"


def test_a_page_of_another_site_reaches_no_web_socket(twin):
    (page, foxglove, _), path, *_ = twin
    evil = "http://evil.example"
    answers = strangers_answers(
        [
            ("127.0.0.1", page, f"{path}socket", evil),
            ("127.0.0.1", page, f"{path}scene/socket", evil),
            ("127.0.0.1", foxglove, "/", evil),
            ("127.0.0.1", foxglove, "/", f"http://localhost:{page}"),
        ]
    )
    assert answers == ["HTTP/1.1 403 Forbidden"] * 4
    answers = strangers_answers([("127.0.0.1", page, f"{path}socket", f"http://localhost:{page}")])
    assert answers == ["HTTP/1.1 101 Switching Protocols"]  # with the token: what is refused above is the origin
    assert strangers_answers([("127.0.0.1", foxglove, "/", "")]) == ["HTTP/1.1 101 Switching Protocols"]  # a program


def test_from_another_network_nothing_is_reached(twin):
    """A namespace that is connected with this one by a wire of its own, as another machine is."""
    ports, path, *_ = twin
    made = subprocess.run(
        """
        ip netns add dt_other && ip link add dt_here type veth peer name dt_there netns dt_other &&
        ip addr add 198.51.100.1/30 dev dt_here && ip link set dt_here up &&
        ip -n dt_other addr add 198.51.100.2/30 dev dt_there && ip -n dt_other link set dt_there up
        """,
        shell=True,
        capture_output=True,
        text=True,
        check=False,
    )
    try:
        if made.returncode:
            pytest.skip(f"no network namespaces here: {made.stderr.strip()[-200:]}")
        with socket.create_server(("198.51.100.1", 0)) as open_to_all:
            control = ("198.51.100.1", open_to_all.getsockname()[1], "/", "")
            threading.Thread(target=lambda: open_to_all.accept()[0].sendall(b"reached\r\n"), daemon=True).start()
            places = [("198.51.100.1", port, path, "") for port in ports]
            *answers, reached = strangers_answers([*places, control], "ip", "netns", "exec", "dt_other", user=0)
        if reached != "reached":
            pytest.skip(f"the two networks are not connected here: {reached}")
        assert set(answers) <= {"ConnectionRefusedError", "TimeoutError"}
    finally:
        subprocess.run("ip link del dt_here; ip netns del dt_other", shell=True, capture_output=True, check=False)
