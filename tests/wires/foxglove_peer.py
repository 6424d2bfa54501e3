"""Foxglove's own client, the npm package @foxglove/ws-protocol, in a process of Node's."""

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
from wires.zenoh_peer import Heard

from drake_twin.scratch_folder import scratch_folder

PROGRAM = Path(__file__).with_name("foxglove_peer.js")


@functools.cache
def npm_modules(*packages: str) -> Path:
    """The folder of npm packages, installed once a process; the test is skipped where they are not to be had."""
    if shutil.which("npm") is None or shutil.which("node") is None:
        pytest.skip("Node's npm is not installed: no client that nobody here wrote")
    folder = Path(tempfile.mkdtemp(prefix="npm_", dir=scratch_folder()))
    install = ["npm", "install", "--no-audit", "--no-fund", "--prefix", str(folder), *packages]
    done = subprocess.run(install, capture_output=True, text=True, timeout=300, check=False)
    if done.returncode:
        pytest.skip(f"{', '.join(packages)} cannot be installed: {done.stderr.strip().splitlines()[-1:]}")
    return folder / "node_modules"


class FoxglovePeer:
    """A client of a server; what it is told is in `heard`, each item with its `event`."""

    def __init__(self, address: str):
        modules = npm_modules("@foxglove/ws-protocol@0.8", "ws@8")
        self.heard = Heard()
        self._process = subprocess.Popen(
            ["node", str(PROGRAM), address],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            text=True,
            env=os.environ | {"NODE_PATH": str(modules)},
        )
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def of(self, event: str, **values: Any) -> list[dict[str, Any]]:
        """What was told of a kind so far."""
        return [item for item in list(self.heard.items) if is_such(item, event, values)]

    def wait(self, event: str, count: int = 1, **values: Any) -> list[dict[str, Any]]:
        """Wait for so many of a kind."""

        def is_there(items: list[Any]) -> bool:
            return sum(is_such(item, event, values) for item in items) >= count

        return [item for item in self.heard.wait_for(is_there, 60.0) if is_such(item, event, values)]

    def subscribe(self, topic: str) -> None:
        self.heard.wait_for(lambda items: any(item.get("channel", {}).get("topic") == topic for item in items), 60.0)
        self.do("subscribe", topic=topic)

    def publish(self, topic: str, kind: str, data: bytes, encoding: str = "cdr") -> None:
        self.do("publish", topic=topic, type=kind, encoding=encoding, data=base64.b64encode(data).decode())

    def call(self, service: str, data: bytes) -> bytes:
        self.heard.wait_for(lambda items: any(item.get("service", {}).get("name") == service for item in items), 60.0)
        self.do("call", service=service, data=base64.b64encode(data).decode())
        return base64.b64decode(self.wait("response")[-1]["data"])

    def asset(self, number: int, uri: str) -> bytes | None:
        self.do("asset", id=number, uri=uri)
        answer = self.wait("asset", requestId=number)[-1]
        return base64.b64decode(answer["data"]) if answer["status"] == 0 else None

    def do(self, op: str, **what: Any) -> None:
        self._process.stdin.write(json.dumps({"op": op, **what}) + "\n")
        self._process.stdin.flush()

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()
        self._thread.join()

    def _read(self) -> None:
        for line in self._process.stdout:
            self.heard(json.loads(line))


def is_such(item: dict[str, Any], event: str, values: dict[str, Any]) -> bool:
    return item["event"] == event and all(item.get(name) == value for name, value in values.items())


@contextlib.contextmanager
def foxglove_peer(address: str) -> Iterator[FoxglovePeer]:
    client = FoxglovePeer(address)
    try:
        client.wait("info")
        yield client
    finally:
        client.close()


def messages_of(client: FoxglovePeer, topic: str, decode: Callable[[bytes], Any]) -> list[Any]:
    return [decode(base64.b64decode(item["data"])) for item in client.of("message", topic=topic)]
