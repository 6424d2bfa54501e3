"""Whether a ``Host`` header names this server: a name that another's DNS could resolve never does."""

import ipaddress
import socket

_EVERY_INTERFACE = ("0.0.0.0", "::")


def is_every_interface(host: str) -> bool:
    """Tell whether a server that listens at an address does so at all of the machine's."""
    return host in _EVERY_INTERFACE


def is_loopback(host: str) -> bool:
    """Tell whether only programs of this machine reach an address."""
    address = as_address(host)
    return host == "localhost" or (address is not None and address.is_loopback)


def split_host(header: str) -> tuple[str, str]:
    """Return the name, without brackets and in small letters, and the port of a ``Host`` header; "" without a port."""
    name, colon, port = header.rpartition(":")
    if not colon or header.endswith("]"):
        name, port = header, ""
    return name.removeprefix("[").removesuffix("]").lower(), port


def is_own_name(name: str, host: str) -> bool:
    """Tell whether a name of a ``Host`` header is one of a server's that listens at an address.

    Args:
        name: The name, as `split_host` returns it.
        host: The address.
    """
    if name == host.lower():
        return True
    if is_every_interface(host):  # a bare address needs no DNS, so it cannot be an attacker's name
        return as_address(name) is not None or name in ("localhost", socket.gethostname().lower())
    return name == "localhost" and is_loopback(host)


def as_address(name: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    """Return an address that stands as numbers; None for a name."""
    try:
        return ipaddress.ip_address(name)
    except ValueError:
        return None
