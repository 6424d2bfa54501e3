"""Access control of the page's server: a request needs a page's token and must come from the page itself.

Any web site that is open in the same browser can send requests to 127.0.0.1. It cannot read the token, and the browser
names the requesting site in ``Origin`` and the requested host in ``Host``.

The printed address has the program's key behind ``#``: browsers send that part to no server, and name it in no
``Referer``. The page there exchanges the key for a token of its own, see `drake_twin.cockpit.page_tokens`, which is the
first part of all its paths, so that it can be reloaded.
"""

import html
import os
import secrets
import socket
from dataclasses import field
from pathlib import Path

from drake_twin.dataclass import dataclass
from drake_twin.own_host import is_every_interface, is_loopback, is_own_name, split_host


def new_token() -> str:
    """Return a new random secret."""
    return secrets.token_urlsafe(18)


def door(folder: Path, access: "Access") -> Path:
    """Write a file that only this user can read, and that leads a browser to the page; return the file.

    A browser that is started with the page's own address has the key in its command line, which all users can list.

    Raises:
        OSError: If it cannot be written.
    """
    file = folder / f"open-{access.port}.html"
    url = html.escape(access.url)
    head = '<!DOCTYPE html><meta charset="utf-8"><meta name="referrer" content="no-referrer">'
    write_private(file, f'{head}<meta http-equiv="refresh" content="0; url={url}"><a href="{url}">The page</a>\n')
    return file


def write_private(file: Path, text: str) -> None:
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
        key: The program's secret, for which a page gets a token of its own.
    """

    host: str
    port: int
    key: str = field(default_factory=new_token)

    @property
    def url(self) -> str:
        """The address that opens a page, with the key."""
        name = socket.gethostname() if is_every_interface(self.host) else self.host
        return f"http://{_bracketed(name)}:{self.port}/#{self.key}"

    def refusal(self, host: str | None, origin: str | None, *, needs_origin: bool = False) -> str | None:
        """Return why a request is refused, whatever its token; None if it is not.

        Args:
            host: The ``Host`` header.
            origin: The ``Origin`` header.
            needs_origin: Whether to refuse a request without an origin, as for web sockets.
        """
        if not self._is_own(host):
            return "the Host header does not name this server"
        if origin is None and needs_origin:
            return "the request has no Origin header"
        if origin is not None and origin != f"http://{host}":
            return "the request comes from another site"
        return None

    def is_key(self, given: bytes) -> bool:
        """Tell whether what a request has is the key."""
        return secrets.compare_digest(given, self.key.encode())

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
