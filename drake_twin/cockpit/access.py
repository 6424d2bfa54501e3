"""Who may talk to the page's server: whoever has the run's token and comes from the page itself.

Any web site that is open in the same browser can send requests to 127.0.0.1. It cannot read the token, and the browser
says in ``Origin`` where a request comes from and in ``Host`` which name it was sent to.
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
    """A secret that nobody guesses."""
    return secrets.token_urlsafe(18)


def kept_token(folder: Path, port: int) -> str:
    """The token of this user's last program on a port, so that a page finds a twin that was started again.

    It is in a file that nobody else can read; where that cannot be, it is a new one each time.

    Args:
        folder: where it is kept.
        port: the page's port.
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
    """What a request must carry.

    Attributes:
        host: the address that the server listens at.
        port: its port.
        token: the secret, the first part of every path.
    """

    host: str
    port: int
    token: str = field(default_factory=new_token)

    @property
    def url(self) -> str:
        """The page's address, token included."""
        name = socket.gethostname() if self.host in _EVERY_INTERFACE else self.host
        return f"http://{_bracketed(name)}:{self.port}/{self.token}/"

    def refusal(self, host: str | None, origin: str | None, path: str, *, needs_origin: bool = False) -> str | None:
        """Why a request is refused; None when it may pass.

        Args:
            host: its ``Host`` header.
            origin: its ``Origin`` header.
            path: its path.
            needs_origin: whether a request without an origin is refused, as web sockets are.
        """
        if not self._is_own(host):
            return "this server does not go by that name"
        if origin is None and needs_origin:
            return "the request does not say where it comes from"
        if origin is not None and not (origin == f"http://{host}" and self._is_own(host)):
            return "the request comes from another site"
        given = path.removeprefix("/").partition("/")[0]
        if not hmac.compare_digest(given.encode("utf-8", "replace"), self.token.encode()):
            return "the address lacks this run's token: use the one that the program printed"
        return None

    @property
    def is_local(self) -> bool:
        """Whether only this machine can reach the server."""
        own = _address(self.host)
        return self.host == "localhost" or (own is not None and own.is_loopback)

    def _is_own(self, host: str | None) -> bool:
        """Whether a ``Host`` header names this server; a name that DNS gives out never does."""
        if host is None:
            return False
        name, _, port = host.rpartition(":")
        if port != str(self.port):
            return False
        name = name.removeprefix("[").removesuffix("]").lower()
        if name == self.host.lower():
            return True
        address = _address(name)
        if self.host in _EVERY_INTERFACE:  # no attacker's name resolves to a bare number
            return address is not None or name in ("localhost", socket.gethostname().lower())
        return name == "localhost" and self.is_local


def _address(name: str) -> ipaddress.IPv4Address | ipaddress.IPv6Address | None:
    try:
        return ipaddress.ip_address(name)
    except ValueError:
        return None


def _bracketed(name: str) -> str:
    return f"[{name}]" if ":" in name else name
