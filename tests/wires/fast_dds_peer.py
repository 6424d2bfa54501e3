"""A DDS participant of eProsima Fast DDS, compiled here: the middleware that ROS 2 has by default."""

import contextlib
import functools
import shutil
import subprocess
import threading
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from wires.zenoh_peer import Heard

from drake_twin.scratch_folder import scratch_folder

SOURCE = Path(__file__).with_name("fast_dds_peer.cpp")


@functools.cache
def program() -> str:
    """The compiled participant; the test is skipped where Fast DDS is not installed."""
    if shutil.which("g++") is None or not Path("/usr/include/fastdds").is_dir():
        pytest.skip("g++ and Fast DDS (Debian's libfastrtps-dev) are not installed: no other DDS")
    compiled = scratch_folder() / "fast_dds_peer"
    command = ["g++", "-std=c++17", str(SOURCE), "-o", str(compiled), "-lfastrtps", "-lfastcdr"]
    subprocess.run(command, check=True, timeout=300)
    return str(compiled)


class FastDdsPeer:
    """A participant; what it prints is in `heard`, each line as its words."""

    def __init__(self, domain: int):
        self.heard = Heard()
        pipes = {"stdin": subprocess.PIPE, "stdout": subprocess.PIPE, "text": True}
        self._process = subprocess.Popen([program(), str(domain)], **pipes)
        self._thread = threading.Thread(target=self._read, daemon=True)
        self._thread.start()

    def wait(self, count: int, *words: str) -> list[list[str]]:
        """Wait for so many lines that begin with these words."""
        found = self.heard.wait_for(lambda lines: sum(line[: len(words)] == [*words] for line in lines) >= count, 60.0)
        return [line for line in found if line[: len(words)] == [*words]]

    def messages(self, count: int, topic: str) -> list[bytes]:
        return [bytes.fromhex(line[2]) for line in self.wait(count, "heard", f"rt{topic}")]

    def subscribe(self, topic: str, dds_type: str, durability: str = "volatile") -> None:
        self.do(f"sub rt{topic} {dds_type} {durability}")

    def publish(self, topic: str, dds_type: str, data: bytes) -> None:
        """Publish once a reader has matched."""
        count = sum(line[0] == "published" for line in list(self.heard.items))
        self.do(f"pub rt{topic} {dds_type} {data.hex()}")
        self.wait(count + 1, "published")

    def stop_reading(self) -> None:
        self._process.send_signal(19)

    def close(self) -> None:
        self._process.kill()
        self._process.communicate()
        self._thread.join()

    def do(self, line: str) -> None:
        self._process.stdin.write(line + "\n")
        self._process.stdin.flush()

    def _read(self) -> None:
        for line in self._process.stdout:
            self.heard(line.split())


@contextlib.contextmanager
def fast_dds_peer(domain: int) -> Iterator[Any]:
    peer = FastDdsPeer(domain)
    try:
        peer.wait(1, "ready")
        yield peer
    finally:
        peer.close()
