"""The page of a program in a process of its own: nothing that it listens to answers a stranger, and the page knows
whether the program still answers."""

import contextlib
import os
import random
import signal
import socket
import subprocess
import sys
import threading
from urllib.parse import urlsplit

import pytest
from browser import opened
from chromium import CHROMIUM, OFFLINE, SOFTWARE_RENDERING
from entered_page import entered

BAD = [b"\x91", b"", b"\xc1", b"\xdd\xff\xff\xff\xff", b"\x91" * 65536, b"{", b'{"do":"Pause"}', b"\x00" * 1000]


class Program:
    """``drake_twin.run`` with its page."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "drake_twin.run", "--robots", "1", "--no-browser", *map(str, arguments)],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        self.url = self.process.stdout.readline().removeprefix("page: ").strip()
        self.port = urlsplit(self.url).port

    def end(self, number=signal.SIGTERM):
        self.process.send_signal(signal.SIGCONT)
        self.process.send_signal(number)
        return self.process.communicate(timeout=30)


@pytest.fixture
def start():
    programs = []

    def start(*arguments):
        programs.append(Program(*arguments))
        return programs[-1]

    yield start
    for program in programs:
        if program.process.poll() is None:
            program.end(signal.SIGKILL)


def listening_ports(pid):
    """The TCP ports at which a process listens, as Linux tells."""
    inodes = set()
    for entry in os.listdir(f"/proc/{pid}/fd"):
        with contextlib.suppress(OSError):
            inodes.add(os.readlink(f"/proc/{pid}/fd/{entry}").removeprefix("socket:[").removesuffix("]"))
    ports = set()
    for table in ("tcp", "tcp6"):
        with contextlib.suppress(FileNotFoundError), open(f"/proc/{pid}/net/{table}", encoding="ascii") as lines:
            for line in list(lines)[1:]:
                fields = line.split()
                if fields[3] == "0A" and fields[9] in inodes:
                    ports.add(int(fields[1].rpartition(":")[2], 16))
    return ports


def answer(port, content):
    """What a port answers to raw bytes, at most 4 kB of it."""
    with socket.create_connection(("127.0.0.1", port), timeout=10) as stranger:
        with contextlib.suppress(OSError):
            stranger.sendall(content)
            stranger.shutdown(socket.SHUT_WR)
        got = b""
        with contextlib.suppress(OSError):
            while len(got) < 4096 and (more := stranger.recv(4096)):
                got += more
        return got


def upgrade(path, port, origin):
    return (
        f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: {origin}\r\nUpgrade: websocket\r\n"
        "Connection: Upgrade\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n"
    ).encode()


@pytest.mark.skipif(not os.path.exists("/proc/net/tcp"), reason="asks Linux which ports a process listens at")
def test_no_port_of_the_program_answers_whoever_has_no_token(start, tmp_path):
    program = start("--summary", tmp_path / "summary.json", "--record", tmp_path / "run.yaml")
    ports = listening_ports(program.process.pid)
    assert ports == {program.port}
    own = f"http://127.0.0.1:{program.port}"
    path = urlsplit(entered(program.url)).path
    chance = random.Random(1)
    upgraded = [
        upgrade(f"{folder}{name}", program.port, origin)
        for folder, origin in (("/", own), ("/wrong/", own), (path, "http://example.org"), (path, "null"))
        for name in ("socket", "scene/socket")
    ]
    attacks = [head + frame for head in upgraded for frame in (b"\x82\x81\x00\x00\x00\x00\x91", *BAD)]
    attacks += [*BAD, *(chance.randbytes(chance.randrange(1, 2000)) for _ in range(1000 - len(attacks)))]
    for content in attacks:
        got = answer(program.port, content)
        assert not got or got.split(b" ")[1] in (b"400", b"403"), got
        assert b"drake_twin" not in got.lower()
    # With the token, what no browser sends still changes nothing.
    for name in ("socket", "scene/socket"):
        for frame in (b"\x82\x81\x00\x00\x00\x00\x91", *BAD, *(chance.randbytes(100) for _ in range(100))):
            answer(program.port, upgrade(f"{path}{name}", program.port, own) + frame)
    _, err = program.end()
    assert program.process.returncode == 0, err
    assert "Traceback" not in err
    assert (tmp_path / "summary.json").is_file()
    assert (tmp_path / "run.yaml").is_file()


def test_a_page_that_other_machines_can_open_is_said_to_be_and_has_a_key_of_its_own(start):
    first = start("--host", "0.0.0.0", "--port", 7392)
    _, err = first.end()
    assert "open to other machines: anyone with this address sees and commands the robots" in err
    assert start("--host", "0.0.0.0", "--port", 7392).url != first.url


class Proxy:
    """Passes bytes on from a port of its own, or keeps them, as a network that is cut does."""

    def __init__(self, port):
        self._to = port
        self._server = socket.create_server(("127.0.0.1", 0))
        self.port = self._server.getsockname()[1]
        self.flows = threading.Event()
        self.flows.set()
        threading.Thread(target=self._accept, daemon=True).start()

    def _accept(self):
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._server.accept()
                with contextlib.suppress(OSError):
                    far = socket.create_connection(("127.0.0.1", self._to))
                    for one, other in ((near, far), (far, near)):
                        threading.Thread(target=self._pass, args=(one, other), daemon=True).start()
                    continue
                near.close()

    def _pass(self, one, other):
        with contextlib.suppress(OSError):
            while content := one.recv(65536):
                self.flows.wait()
                other.sendall(content)
        for end in (one, other):
            with contextlib.suppress(OSError):
                end.shutdown(socket.SHUT_RDWR)

    def close(self):
        self._server.close()


@pytest.fixture
def tab():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_RENDERING + OFFLINE)
        yield opened(browser)
        browser.close()


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)")
def test_the_page_says_that_the_program_is_gone_and_works_when_it_is_back(start, tab):
    program = start("--port", 7391)
    tab.goto(program.url)
    tab.locator("body.ready").wait_for()
    banner = tab.locator("#connection")

    def works():
        """Whether a press arrives, and time is told."""
        banner.wait_for(state="hidden")
        tab.get_by_role("button", name="Pause").click()
        tab.get_by_role("button", name="Play", exact=True).click()
        tab.get_by_role("button", name="Pause").wait_for()

    works()
    program.process.send_signal(signal.SIGSTOP)
    banner.get_by_text("has not answered").wait_for()
    assert tab.locator("#panel").evaluate("node => node.inert")
    program.process.send_signal(signal.SIGCONT)
    works()
    program.end(signal.SIGKILL)
    banner.get_by_text("has ended or cannot be reached").wait_for()
    tab.keyboard.press("Space")
    assert "did not reach it" in banner.inner_text()
    again = start("--port", 7391)
    assert again.url != program.url  # the key is new, and the page has a token of its own
    works()
    tab.reload()
    works()


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)")
def test_the_page_says_that_the_network_is_cut_and_works_when_it_is_back(tab):
    from conftest import rovers

    from drake_twin.cockpit.access import Access
    from drake_twin.cockpit.cockpit import Cockpit
    from drake_twin.cockpit.listening import bind
    from drake_twin.cockpit.scene import Scene
    from drake_twin.cockpit.server import PageServer

    listening = bind(None, "127.0.0.1")
    proxy = Proxy(listening.getsockname()[1])
    scene, twin = Scene(), rovers(1).build()
    server = PageServer(listening, "127.0.0.1", scene, Access("127.0.0.1", proxy.port))
    cockpit = Cockpit(server, scene, twin)

    def frames(until, most=900):
        for _ in range(most):
            twin.step(30)
            cockpit.process_requests()
            if until():
                return
        raise AssertionError(f"not within {most} frames")

    tab.goto(server.url)
    frames(lambda: tab.locator("body.ready").count() == 1)
    proxy.flows.clear()
    frames(lambda: tab.locator("#connection").is_visible())
    assert "has not answered" in tab.locator("#connection").inner_text()
    proxy.flows.set()
    frames(lambda: not tab.locator("#connection").is_visible())
    proxy.close()
    server.close()
