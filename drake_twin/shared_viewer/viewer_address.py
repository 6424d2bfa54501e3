"""The address of a shared page and a twin's name on it, checked before anything is built."""

import re

from drake_twin.errors import InputError

_ADDRESS = re.compile(r"tcp://(\[[0-9a-fA-F:.]+\]|[^\s/:\[\]*]+):(\d{1,5})|ipc://\S+")


def check_viewer_address(url: str) -> None:
    """Check the address of a meshcat-server.

    Raises:
        InputError: If it is not a ZeroMQ address.
    """
    match = _ADDRESS.fullmatch(url)
    if match is None or (match[2] is not None and not 1 <= int(match[2]) <= 65535):
        raise InputError(
            f"{url!r} is not the address of a meshcat-server: expected tcp://HOST:PORT, for example"
            " tcp://127.0.0.1:6000, which the server prints as zmq_url"
        )


def check_viewer_name(name: str) -> None:
    """Check a twin's name on a shared page.

    Raises:
        InputError: If it cannot be the name of one folder.
    """
    if not name or "/" in name or name != name.strip() or not name.isprintable() or name == "<object>":
        raise InputError(f"{name!r} cannot be a folder on the shared page: expected a name without slashes")
