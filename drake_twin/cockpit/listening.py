"""The socket at which the page is served."""

import socket

from drake_twin.errors import InputError

_FIRST_PORT, _LAST_PORT = 7000, 7099


def bind(port: int | None, host: str) -> socket.socket:
    """Return a listening socket for the page.

    Args:
        port: The port; by default the first free one from 7000 on.
        host: The address to listen on.

    Raises:
        InputError: If the port is taken or forbidden, or the address does not belong to this machine.
    """
    try:
        family, _, _, _, _ = socket.getaddrinfo(host, None, type=socket.SOCK_STREAM)[0]
        with socket.socket(family) as probe:
            probe.bind((host, 0))
    except (OSError, UnicodeError):
        raise InputError(f"no page can be served at {host!r}: the address does not belong to this machine") from None
    for candidate in (port,) if port is not None else range(_FIRST_PORT, _LAST_PORT + 1):
        try:
            return socket.create_server((host, candidate), family=family)
        except OSError:
            continue
    if port is None:
        raise InputError(f"no page can be served at {host}: ports {_FIRST_PORT} to {_LAST_PORT} are all taken")
    raise InputError(
        f"port {port} of {host} cannot be used: another program uses it, or it is not allowed. Choose another port, or"
        " none for the first free one"
    )
