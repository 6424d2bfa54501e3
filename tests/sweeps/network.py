"""A network of its own for programs that open ports."""

import contextlib
import os
import shutil
import signal
import subprocess
from collections.abc import Iterator
from pathlib import Path

import pytest

UP = """
ip link set lo up || exit 1
ip link add outer type veth peer name nowhere && ip addr add 192.0.2.9/24 dev outer && ip link set outer up &&
ip route add default dev outer && echo up || echo loopback
exec sleep 100000
"""


class Network:
    """A network namespace: the loopback address, and where that can be made, a cable that leads nowhere.

    With the latter, Ray sees the address of a machine among others, as it does everywhere else.
    """

    def __init__(self):
        self._keeper = subprocess.Popen(
            ["unshare", "-n", "sh", "-c", UP],
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
        )
        made = self._keeper.stdout.readline().strip()
        self.is_up, self.has_outer = made != "", made == "up"

    def command(self, *arguments):
        return ["nsenter", "-t", str(self._keeper.pid), "-n", *arguments]

    def run(self, *arguments, **options):
        return subprocess.run(
            self.command(*arguments), capture_output=True, text=True, timeout=200, check=True, **options
        )

    @property
    def processes(self):
        """The processes in it, and their command lines."""
        own = os.readlink(f"/proc/{self._keeper.pid}/ns/net")
        found = {}
        for folder in Path("/proc").glob("[0-9]*"):
            with contextlib.suppress(OSError):
                if os.readlink(folder / "ns/net") == own and int(folder.name) != self._keeper.pid:
                    found[int(folder.name)] = (folder / "cmdline").read_bytes().replace(b"\0", b" ").decode()
        return {process: line for process, line in found.items() if line}  # those that are not yet waited for have none

    def close(self):
        for process in self.processes:
            with contextlib.suppress(OSError):
                os.kill(process, signal.SIGKILL)
        self._keeper.kill()
        self._keeper.communicate()


@contextlib.contextmanager
def network_of_its_own() -> Iterator[Network]:
    """A network that ends with all processes in it; skips the test where none can be made."""
    if shutil.which("unshare") is None or shutil.which("nsenter") is None or shutil.which("ip") is None:
        pytest.skip("makes a network of its own with unshare, nsenter and ip")
    network = Network()
    try:
        if not network.is_up:
            pytest.skip("may not make a network of its own")
        yield network
    finally:
        network.close()
