"""The tokens of a server's pages, one for each, and when each ends."""

import contextlib
import hashlib
import os
import stat
import time
from collections.abc import Iterator
from pathlib import Path

from drake_twin.cockpit.access import new_token, write_private
from drake_twin.dataclass import dataclass

LONGEST_CLOSED = 3600.0  # s
MOST_PAGES = 1000
_LONGEST_LINE = 200  # bytes


@dataclass
class _Page:
    seen: float  # s since the epoch: when it was known to be open
    connections: int = 0

    def has_ended(self) -> bool:
        return not self.connections and not 0.0 <= time.time() - self.seen < LONGEST_CLOSED


class PageTokens:
    """The tokens of pages. A page that has been closed for an hour ends, and its token with it.

    A file makes an open page find a restarted twin: the pages of the last program with the file are known, too. It
    holds no token, but hashes. Only this user can read it; if it cannot be used, the pages end with the program.

    Args:
        file: The file.
    """

    def __init__(self, file: Path | None = None):
        self._file = file
        self._pages: dict[str, _Page] = {}
        for line in () if file is None else _read_private(file).splitlines()[:MOST_PAGES]:
            digest, _, seen = line.partition(" ")
            with contextlib.suppress(ValueError):
                self._pages[digest] = _Page(float(seen))

    def new(self) -> str:
        """Return the token of a new page; of too many pages, the one that has been closed for longest ends."""
        token = new_token()
        self._drop_ended()
        if len(self._pages) >= MOST_PAGES:
            del self._pages[min(self._pages, key=lambda key: (self._pages[key].connections > 0, self._pages[key].seen))]
        self._pages[_digest(token)] = _Page(time.time())
        self.save()
        return token

    def __contains__(self, token: str) -> bool:
        page = self._pages.get(_digest(token))
        return page is not None and not page.has_ended()

    @contextlib.contextmanager
    def connected(self, token: str) -> Iterator[None]:
        """Keep a page from ending while it has a connection."""
        page = self._pages.setdefault(_digest(token), _Page(time.time()))
        page.connections += 1
        self.save()
        try:
            yield
        finally:
            page.connections -= 1
            page.seen = time.time()
            self.save()

    def save(self) -> None:
        """Write the file."""
        self._drop_ended()
        for page in self._pages.values():
            page.seen = time.time() if page.connections else page.seen
        text = "".join(f"{digest} {page.seen:.0f}\n" for digest, page in self._pages.items())
        with contextlib.suppress(OSError):
            if self._file is not None:
                write_private(self._file, text)

    def _drop_ended(self) -> None:
        self._pages = {digest: page for digest, page in self._pages.items() if not page.has_ended()}


def _digest(token: str) -> str:
    return hashlib.sha256(token.encode("utf-8", "replace")).hexdigest()


def _read_private(file: Path) -> str:
    """Return the text of a file that no other user can have read or written; nothing if it cannot be used."""
    with contextlib.suppress(OSError, UnicodeDecodeError):
        descriptor = os.open(file, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK)
        with open(descriptor, encoding="ascii") as stream:
            status = os.fstat(descriptor)
            is_file = stat.S_ISREG(status.st_mode) and stat.S_IMODE(status.st_mode) == 0o600
            if is_file and status.st_uid == os.getuid():
                return stream.read(MOST_PAGES * _LONGEST_LINE)
    return ""
