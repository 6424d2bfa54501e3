"""Open a Zenoh session as rmw_zenoh does: through a router, without multicast."""

import json
import socket
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.errors import InputError
from drake_twin.requirements import missing

ROUTER_PORT = 7447  # rmw_zenoh's nodes connect to it on their own machine (DEFAULT_RMW_ZENOH_SESSION_CONFIG.json5)
_PATIENCE = 3000  # ms for a router to answer
_ANSWER = 0.5  # s for a program on this machine to take a connection
# µs for a peer that reads to make room; 1 ms, Zenoh's default, is too short for one that shares a busy processor. Of a
# peer that has stopped to read, only the first message waits so long.
_WAIT = 5000


@dataclass(frozen=True)
class OpenSession:
    """A session, and where it stands.

    Attributes:
        session: The ``zenoh.Session``.
        address: The address that it listens on, ``HOST:PORT``.
        router: The address of the router that it is connected to; None if it is the router.
    """

    session: Any
    address: str
    router: str | None = None


def open_session(host: str = "127.0.0.1", port: int = ROUTER_PORT, router: str | None = None) -> OpenSession:
    """Open a session that is connected to a router, or is the router where none runs on this machine.

    Args:
        host: The address to listen on as a router.
        port: The router's port.
        router: The address of a router to connect to in any case, ``HOST`` or ``HOST:PORT``.

    Raises:
        InputError: If Zenoh is not installed, the address cannot be used, the port is another program's, or no router
            answers.
    """
    try:
        import xxhash  # noqa: F401  # which names the graph's endpoints
        import zenoh
    except ImportError:
        raise missing("the ROS 2 graph needs", "zenoh", "xxhash") from None
    zenoh.try_init_log_from_env()  # type: ignore[no-untyped-call]  # with RUST_LOG only: its errors about what leaves are no news to a user
    if router is not None:
        return _connect(zenoh, _with_port(router, port))
    _check_address(host, port)
    try:
        address = f"{_bracketed(host)}:{port}"
        return OpenSession(zenoh.open(_config(zenoh, "router", address)), address)
    except zenoh.ZError:  # something listens there
        return _connect(zenoh, f"127.0.0.1:{port}")


def router_answers(port: int) -> bool:
    """Return whether a program has a port on this machine that a router would have."""
    try:
        socket.create_connection(("127.0.0.1", port), _ANSWER).close()
    except OSError:
        return False
    return True


def _connect(zenoh: Any, router: str) -> OpenSession:
    with socket.create_server(("127.0.0.1", 0)) as probe:  # Zenoh does not tell which port it has chosen
        own = f"127.0.0.1:{probe.getsockname()[1]}"
    try:
        return OpenSession(zenoh.open(_config(zenoh, "peer", own, router)), own, router)
    except zenoh.ZError:
        text = f"no Zenoh router answers at {router}"
        raise InputError(f"{text}: another program has the port, or the router is not running") from None


def _config(zenoh: Any, mode: str, address: str, router: str | None = None) -> Any:
    config = zenoh.Config()
    for key, value in {
        "mode": mode,
        "listen/endpoints": [f"tcp/{address}"],
        "connect/endpoints": [] if router is None else [f"tcp/{router}"],
        "connect/exit_on_failure": True,
        "connect/timeout_ms": _PATIENCE,
        "scouting/delay": 0,
        "transport/link/tx/queue/congestion_control/drop/wait_before_drop": _WAIT,
        "scouting/multicast/enabled": False,
        "timestamping/enabled": True,  # what is kept for late joiners is sorted by time
    }.items():
        config.insert_json5(key, json.dumps(value))
    return config


def _check_address(host: str, port: int) -> None:
    """Refuse an address that is not this machine's.

    Raises:
        InputError: If it is not.
    """
    try:
        family, kind, protocol, _, address = socket.getaddrinfo(host, port, type=socket.SOCK_STREAM)[0]
        with socket.socket(family, kind, protocol) as probe:
            probe.bind((address[0], 0))
    except OSError as error:
        raise InputError(f"cannot listen on {host}: {error.strerror or error}") from None


def _with_port(address: str, port: int) -> str:
    host, separator, given = address.rpartition(":")
    if not separator or address.endswith("]"):
        return f"{_bracketed(address)}:{port}"
    if not given.isdigit() or not 0 < int(given) < 65536 or not host:
        raise InputError(f"{address!r} is not the address of a router: write HOST or HOST:PORT")
    return f"{_bracketed(host)}:{given}"


def _bracketed(host: str) -> str:
    return f"[{host}]" if ":" in host and not host.startswith("[") else host
