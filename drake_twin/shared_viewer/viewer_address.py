"""Where a shared page is, and what a twin is called there; checked before anything is built."""

import re

from drake_twin.errors import InputError

_ADDRESS = re.compile(r"tcp://(\[[0-9a-fA-F:.]+\]|[^\s/:\[\]*]+):(\d{1,5})|ipc://\S+")


def check_viewer_address(url: str) -> None:
    """Refuses what is no ZeroMQ address.

    Raises:
        InputError: it is none.
    """
    match = _ADDRESS.fullmatch(url)
    if match is None or (match[2] is not None and not 1 <= int(match[2]) <= 65535):
        raise InputError(
            f"{url!r} is no address of a meshcat-server: it reads tcp://HOST:PORT, for example tcp://127.0.0.1:6000"
            " (what the server prints as zmq_url)"
        )


def check_viewer_name(name: str) -> None:
    """Refuses what cannot be the name of one folder.

    Raises:
        InputError: it cannot.
    """
    if not name or "/" in name or name != name.strip() or not name.isprintable() or name == "<object>":
        raise InputError(f"{name!r} cannot be a folder on the shared page: a name without slashes is needed")
