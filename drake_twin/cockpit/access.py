"""Access control of the page's server: a request needs the run's token and must come from the page itself.

Any web site that is open in the same browser can send requests to 127.0.0.1. It cannot read the token, and the browser
names the requesting site in ``Origin`` and the requested host in ``Host``.
"""

import contextlib
import hmac
import html
import os
import re
import secrets
import socket
import stat
import time
from dataclasses import dataclass, field
from pathlib import Path

from drake_twin.own_host import is_every_interface, is_loopback, is_own_name, split_host

_LONGEST_KEPT = 24 * 3600.0  # s


def new_token() -> str:
    """Return a new random secret."""
    return secrets.token_urlsafe(18)


def kept_token(folder: Path, port: int) -> str:
    """Return the token of this user's last program on a port, so that an open page finds a restarted twin.

    The token is stored in a file that only this user can read. If the file cannot be used, each token is a new one. A
    token that is a day old is not used again: who has learned it once cannot use it for ever.

    Args:
        folder: The folder of the file.
        port: The page's port.
    """
    file = folder / f"token-{port}"
    with contextlib.suppress(OSError, UnicodeDecodeError):
        descriptor = os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with open(descriptor, encoding="ascii") as stream:
            status = os.fstat(descriptor)
            is_young = 0.0 <= time.time() - status.st_mtime < _LONGEST_KEPT
            is_private = is_young and status.st_uid == os.getuid() and stat.S_IMODE(status.st_mode) == 0o600
            if is_private and (known := re.fullmatch(r"[\w-]{24}", stream.read(100))):
                return known[0]
    token = new_token()
    with contextlib.suppress(OSError):
        _write_private(file, token)
    return token


def door(folder: Path, access: "Access") -> Path:
    """Write a file that only this user can read, and that leads a browser to the page; return the file.

    A browser that is started with the page's own address has the token in its command line, which all users can list.

    Raises:
        OSError: If it cannot be written.
    """
    file = folder / f"open-{access.port}.html"
    url = html.escape(access.url)
    head = '<!DOCTYPE html><meta charset="utf-8"><meta name="referrer" content="no-referrer">'
    _write_private(file, f'{head}<meta http-equiv="refresh" content="0; url={url}"><a href="{url}">The page</a>\n')
    return file


def _write_private(file: Path, text: str) -> None:
    """Write a new file that only this user can read, in place of one that may be another's."""
    file.unlink(missing_ok=True)
    with open(os.open(file, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o600), "w", encoding="utf-8") as stream:
        stream.write(text)


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
        name = socket.gethostname() if is_every_interface(self.host) else self.host
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
        return is_loopback(self.host)

    def _is_own(self, host: str | None) -> bool:
        """Return whether a ``Host`` header names this server; names that an attacker's DNS could resolve never do."""
        if host is None:
            return False
        name, port = split_host(host)
        return port == str(self.port) and is_own_name(name, self.host)


def _bracketed(name: str) -> str:
    return f"[{name}]" if ":" in name else name
