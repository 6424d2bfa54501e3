"""Access control of the page's server: a request needs the run's token and must come from the page itself.

Any web site that is open in the same browser can send requests to 127.0.0.1. It cannot read the token, and the browser
names the requesting site in ``Origin`` and the requested host in ``Host``.
"""

import contextlib
import hmac
import ipaddress
import os
import re
import secrets
import socket
import stat
from dataclasses import dataclass, field
from pathlib import Path

_EVERY_INTERFACE = ("0.0.0.0", "::")


def new_token() -> str:
    """Return a new random secret."""
    return secrets.token_urlsafe(18)


def kept_token(folder: Path, port: int) -> str:
    """Return the token of this user's last program on a port, so that an open page finds a restarted twin.

    The token is stored in a file that only this user can read. If the file cannot be used, each token is a new one.

    Args:
        folder: The folder of the file.
        port: The page's port.
    """
    file = folder / f"token-{port}"
    with contextlib.suppress(OSError, UnicodeDecodeError):
        descriptor = os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with open(descriptor, encoding="ascii") as stream:
            status = os.fstat(descriptor)
            is_private = status.st_uid == os.getuid() and stat.S_IMODE(status.st_mode) == 0o600
            if is_private and (known := re.fullmatch(r"[\w-]{24}", stream.read(100))):
                return known[0]
    token = new_token()
    with contextlib.suppress(OSError):
        file.unlink(missing_ok=True)
        with open(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="ascii") as stream:
            stream.write(token)
    return token


@dataclass(frozen=True)
class Access:
    """What a request to the server must carry.

    Attributes:
        host: The address that the server listens on.
        port: Its port.
        token: The secret, which is the first part of every path.
    """

    host: str
    port: int
    token: str = field(default_factory=new_token)

    @property
    def url(self) -> str:
        """The page's address, including the token."""
        name = socket.gethostname() if self.host in _EVERY_INTERFACE else self.host
        return f"http://{_bracketed(name)}:{self.port}/{self.token}/"

    def refusal(self, host: str | None, origin: str | None, path: str, *, needs_origin: bool = False) -> str | None:
        """Return why a request is refused; None if it is accepted.

        Args:
            host: The ``Host`` header.
            origin: The ``Origin`` header.
            path: The path.
            needs_origin: Whether to refuse a request without an origin, as for web sockets.
        """
        if not self._is_own(host):
            return "the Host header does not name this server"
        if origin is None and needs_origin:
            return "the request has no Origin header"
        if origin is not None and not (origin == f"http://{host}" and self._is_own(host)):
            return "the request comes from another site"
        given = path.removeprefix("/").partition("/")[0]
        if not hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode()):
            return "the address has no valid token: use the address that the program printed"
        return None

    @property
    def is_local(self) -> bool:
        """Whether the server is reachable from this machine only."""
        own = _address(self.host)
        return self.host == "localhost" or (own is not None and own.is_loopback)

    def _is_own(self, host: str | None) -> bool:
        """Return whether a ``Host`` header names this server; names that an attacker's DNS could resolve never do."""
        if host is None:
            return False
        name, _, port = host.rpartition(":")
        if port != str(self.port):
            return False
        name = name.removeprefix("[").removesuffix("]").lower()
        if name == self.host.lower():
            return True
        address = _address(name)
        if self.host in _EVERY_INTERFACE:  # a bare address needs no DNS, so it cannot be an attacker's name
            return address is not None or name in ("localhost", socket.gethostname().lower())
        return name == "localhost" and self.is_local


def _address(name: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(name)
    except ValueError:
        return None


def _bracketed(name: str) -> str:
    return f"[{name}]" if ":" in name else name
