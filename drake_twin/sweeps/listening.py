"""The ports at which processes of this machine listen, from the tables of Linux."""

import contextlib
import ipaddress
import os
import socket
import struct
from collections.abc import Iterable, Iterator
from dataclasses import field
from pathlib import Path

from drake_twin.dataclass import dataclass

_LISTENS = "0A"  # TCP_LISTEN


@dataclass(frozen=True, order=True)
class Port:
    """A TCP port at which a process listens.

    Attributes:
        number: The port.
        address: The address that it is bound to.
        owner: The name of the process.
    """

    number: int
    address: str
    owner: str = field(compare=False)

    @property
    def is_reachable(self) -> bool:
        """Whether other machines reach it: it is bound to more than the loopback address."""
        address = ipaddress.ip_address(self.address)
        inner = getattr(address, "ipv4_mapped", None) or address
        return not inner.is_loopback

    def __str__(self) -> str:
        return f"{self.owner} {self.number}"


def family(text: str) -> set[int]:
    """Return the processes whose command line holds a text, and all that they have started."""
    processes = list(_processes())
    found = {process for process in processes if text in _read(process, "cmdline")}
    parents = {process: _parent(process) for process in processes}
    while more := {process for process, parent in parents.items() if parent in found} - found:
        found |= more
    return found


def ports_of(processes: Iterable[int]) -> list[Port]:
    """Return the ports at which processes listen, in order."""
    found = set()
    for process in processes:
        inodes = set(_sockets(process))
        for table in ("tcp", "tcp6") if inodes else ():
            for line in _read(process, f"net/{table}").splitlines()[1:]:
                fields = line.split()
                if fields[3] == _LISTENS and fields[9] in inodes:
                    address, _, number = fields[1].partition(":")
                    found.add(Port(int(number, 16), _address(address), _read(process, "comm").strip()))
    return sorted(found)


def _processes() -> Iterator[int]:
    return (int(name) for name in os.listdir("/proc") if name.isdecimal())


def _read(process: int, name: str) -> str:
    with contextlib.suppress(OSError):  # it has ended, or belongs to another user
        return Path(f"/proc/{process}/{name}").read_text(errors="replace")
    return ""


def _parent(process: int) -> int:
    fields = _read(process, "stat").rpartition(")")[2].split()
    return int(fields[1]) if fields else 0


def _sockets(process: int) -> Iterator[str]:
    """Yield the inodes of the sockets that a process has open."""
    with contextlib.suppress(OSError):
        for item in os.scandir(f"/proc/{process}/fd"):
            with contextlib.suppress(OSError):
                target = os.readlink(item.path)
                if target.startswith("socket:["):
                    yield target[8:-1]


def _address(text: str) -> str:
    """Return an address of the tables, which write each four bytes as a number of this machine."""
    words = [int(text[place : place + 8], 16) for place in range(0, len(text), 8)]
    packed = struct.pack(f"={len(words)}I", *words)
    return socket.inet_ntop(socket.AF_INET if len(words) == 1 else socket.AF_INET6, packed)
