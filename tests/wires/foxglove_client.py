"""npm's @foxglove/ws-protocol as a client of the wire, which nobody here wrote: a process of Node, driven by JSON."""

import atexit
import base64
import contextlib
import functools
import json
import os
import shutil
import subprocess
import tempfile
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

PACKAGES = ("@foxglove/ws-protocol@0.8", "@foxglove/rosmsg@5", "@foxglove/rosmsg2-serialization@3", "ws@8")
SCRIPT = Path(__file__).with_name("foxglove_client.cjs")


class FoxgloveClient:
    """A connected client.

    Attributes:
        events: What it was told, in order.
    """

    def __init__(self, modules: Path, port: int):
        self.events: list[dict[str, Any]] = []
        self._changed = threading.Condition()
        self._has_ended = False
        self._process = subprocess.Popen(
            ["node", str(SCRIPT), f"ws://127.0.0.1:{port}"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env={**os.environ, "NODE_PATH": str(modules)},
        )
        self._thread = threading.Thread(target=self._read)
        self._thread.start()
        self._calls = 0

    def do(self, action: str, **arguments: Any) -> None:
        assert self._process.stdin is not None
        self._process.stdin.write(json.dumps({"do": action, **arguments}) + "\n")
        self._process.stdin.flush()

    def wait_for(self, condition: Callable[[list[Any]], Any], timeout: float = 60.0) -> Any:
        """Wait until a condition of the events is met; return what it returns."""
        with self._changed:
            self._changed.wait_for(lambda: self._has_ended or condition(self.events), timeout)
            found = condition(self.events)
        assert found, f"Foxglove's client has {'ended' if self._has_ended else 'waited'}: {str(self.events)[-2000:]}"
        return found

    def first(self, event: str, **fields: Any) -> dict[str, Any]:
        """Wait for an event with these fields."""
        return self.wait_for(lambda events: next((item for item in events if _is(item, event, fields)), None))

    def all(self, event: str, **fields: Any) -> list[dict[str, Any]]:
        with self._changed:
            return [item for item in self.events if _is(item, event, fields)]

    def channel(self, topic: str) -> dict[str, Any]:
        """Wait for a topic's channel."""
        return self.wait_for(lambda events: _offered(events, "advertise", "channels", "topic", topic))

    def subscribe(self, topic: str) -> None:
        self.channel(topic)
        self.do("subscribe", topic=topic)

    def messages(self, topic: str, count: int = 1) -> list[dict[str, Any]]:
        """Wait for so many messages of a topic; return all that came."""

        def enough(events: list[Any]) -> Any:
            found = [item for item in events if _is(item, "message", {"topic": topic})]
            return found if len(found) >= count else None

        return self.wait_for(enough)

    def advertise(self, topic: str, kind: str, encoding: str = "cdr") -> Callable[[bytes], None]:
        """Offer a topic; return a function that publishes on it."""
        before = len(self.all("advertised"))
        self.do("advertise", topic=topic, schemaName=kind, encoding=encoding)
        self.wait_for(lambda events: len([item for item in events if item["event"] == "advertised"]) > before)
        channel = self.all("advertised")[-1]["channel"]
        return lambda data: self.do("publish", channel=channel, data=base64.b64encode(data).decode())

    def call(self, service: str, request: Any = None, *, data: bytes = b"", encoding: str = "cdr") -> Any:
        """Call a service; raise RuntimeError with the server's words if it fails."""
        number = self.send_call(service, request, data=data, encoding=encoding)
        answer = self.wait_for(
            lambda events: next(
                (item for item in events if item["event"] in ("response", "failure") and item["callId"] == number), None
            )
        )
        if answer["event"] == "failure":
            raise RuntimeError(answer["text"])
        return answer["message"]

    def send_call(self, service: str, request: Any = None, *, data: bytes = b"", encoding: str = "cdr") -> int:
        """Call a service without waiting; return the call's number."""
        self.wait_for(lambda events: _offered(events, "advertiseServices", "services", "name", service))
        self._calls += 1
        text = base64.b64encode(data).decode()
        self.do("call", service=service, callId=self._calls, encoding=encoding, request=request or {}, data=text)
        return self._calls

    def fetch(self, uri: str) -> bytes:
        """Fetch an asset; raise RuntimeError with the server's words if it is refused."""
        self._calls += 1
        self.do("fetch", uri=uri, requestId=self._calls)
        answer = self.first("asset", requestId=self._calls)
        if "data" not in answer:
            raise RuntimeError(answer["text"])
        return base64.b64decode(answer["data"])

    def parameters(self, *names: str) -> dict[str, Any]:
        """Ask for parameters, or for all; return their values."""
        return self._parameters("getParameters", names=names)

    def set_parameters(self, **arguments: Any) -> dict[str, Any]:
        """Set parameters, each as the protocol has it; return the values that the server says they have then."""
        return self._parameters("setParameters", **arguments)

    def _parameters(self, action: str, **arguments: Any) -> dict[str, Any]:
        self._calls += 1
        self.do(action, id=str(self._calls), **arguments)
        found = self.first("parameters", id=str(self._calls))["parameters"]
        return {item["name"]: item.get("value") for item in found}

    def close(self) -> None:
        with contextlib.suppress(OSError):
            self._process.kill()
        self._process.wait()
        self._thread.join()
        for end in (self._process.stdin, self._process.stdout):
            with contextlib.suppress(OSError):
                end.close()

    def _read(self) -> None:
        for line in self._process.stdout or ():
            if line.endswith("\n"):  # not of a process that was killed
                with self._changed:
                    self.events.append(json.loads(line))
                    self._changed.notify_all()


@functools.cache
def node_modules() -> Path:
    """The folder with Foxglove's own packages of npm; the test is skipped where they cannot be had."""
    for program in ("node", "npm"):
        if shutil.which(program) is None:
            pytest.skip(f"{program} is not installed, which runs Foxglove's own client")
    folder = tempfile.TemporaryDirectory(prefix="foxglove-npm-")
    atexit.register(folder.cleanup)
    command = ["npm", "install", "--no-audit", "--no-fund", "--loglevel=error", "--prefix", folder.name, *PACKAGES]
    try:
        done = subprocess.run(command, cwd=folder.name, capture_output=True, text=True, timeout=180)
    except subprocess.TimeoutExpired:
        pytest.skip("npm's registry does not answer")
    if done.returncode:
        pytest.skip(f"npm cannot install Foxglove's client: {done.stderr.strip()[:200]}")
    return Path(folder.name) / "node_modules"


def _is(item: dict[str, Any], event: str, fields: dict[str, Any]) -> bool:
    return item["event"] == event and all(item.get(name) == value for name, value in fields.items())


def _offered(events: list[Any], event: str, items: str, key: str, name: str) -> Any:
    """Return the last channel or service of a name."""
    found = [item for told in events if told["event"] == event for item in told[items] if item[key] == name]
    return found[-1] if found else None


@contextlib.contextmanager
def foxglove_client(port: int) -> Iterator[FoxgloveClient]:
    peer = FoxgloveClient(node_modules(), port)
    try:
        peer.first("serverInfo")
        yield peer
    finally:
        peer.close()
