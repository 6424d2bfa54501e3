"""Sockets that a library opens on all interfaces, held to the loopback interface.

CycloneDDS receives on the wildcard address whatever interface it is given (``ddsi_udp.c``): what arrives on another
interface would reach the robots.
"""

import os
import socket
import sys
from collections.abc import Iterator
from contextlib import contextmanager, suppress

_DESCRIPTORS = "/dev/fd"
_BOUND_IF = 25  # IP_BOUND_IF of macOS' netinet/in.h, which Python's socket does not name


@contextmanager
def loopback_only() -> Iterator[list[int]]:
    """Hold the UDP sockets that are opened meanwhile, on all interfaces, to the loopback interface.

    Yields:
        The ports of those that the system does not let be held, known when it ends.
    """
    before, open_ports = _descriptors(), list[int]()
    yield open_ports
    for descriptor, _ in _descriptors() - before:
        with suppress(OSError), socket.socket(fileno=os.dup(descriptor)) as held:
            if held.type == socket.SOCK_DGRAM and held.family == socket.AF_INET:
                address, port = held.getsockname()
                if address == "0.0.0.0" and not _is_held(held):
                    open_ports.append(port)


def _is_held(held: socket.socket) -> bool:
    try:
        if sys.platform == "darwin":
            held.setsockopt(socket.IPPROTO_IP, _BOUND_IF, socket.if_nametoindex("lo0"))
        else:
            held.setsockopt(socket.SOL_SOCKET, socket.SO_BINDTODEVICE, b"lo")
    except OSError:  # Linux before 5.7 without privileges
        return False
    return True


def _descriptors() -> set[tuple[int, int]]:
    """Return the descriptors of this process with what they stand for, for a number is used again after its end."""
    found = set()
    for name in os.listdir(_DESCRIPTORS) if os.path.isdir(_DESCRIPTORS) else ():
        with suppress(OSError):
            found.add((int(name), os.fstat(int(name)).st_ino))
    return found
