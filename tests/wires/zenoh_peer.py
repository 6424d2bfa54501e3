"""A plain Zenoh peer, and a port of its own for each test's router."""

import contextlib
import socket
import threading
from collections.abc import Callable, Iterator
from typing import Any


def free_port() -> int:
    with socket.create_server(("127.0.0.1", 0)) as probe:
        return probe.getsockname()[1]


@contextlib.contextmanager
def peer(port: int) -> Iterator[Any]:
    """A session that is connected to the router on a port."""
    from drake_twin.wires.zenoh_session import open_session

    opened = open_session(port=port)
    assert opened.router == f"127.0.0.1:{port}"
    try:
        yield opened.session
    finally:
        opened.session.close()


def tokens(session: Any) -> list[str]:
    """All liveliness tokens that a session finds, sorted."""
    return sorted(str(reply.ok.key_expr) for reply in session.liveliness().get("@ros2_lv/**"))


class Heard:
    """What a callback was given, and a wait for so many."""

    def __init__(self) -> None:
        self.items: list[Any] = []
        self._changed = threading.Condition()

    def __call__(self, item: Any) -> None:
        with self._changed:
            self.items.append(item)
            self._changed.notify_all()

    def wait_for(self, condition: Callable[[list[Any]], Any] | int, timeout: float = 20.0) -> list[Any]:
        """Wait for a condition, or for a number of items."""
        with self._changed:
            met = (
                (lambda: len(self.items) >= condition)
                if isinstance(condition, int)
                else (lambda: condition(self.items))
            )
            assert self._changed.wait_for(met, timeout), f"after {timeout} s: {len(self.items)} items"
            return list(self.items)
