"""The other programs on the graph of the double of rclpy, which connects to them from its process."""

import contextlib
import json
import os
import socket
import threading
from pathlib import Path

from waiting import until

import drake_twin

DOUBLE = Path(__file__).parent / "rclpy_double"
SOURCED = os.pathsep.join((str(DOUBLE), str(Path(drake_twin.__file__).parents[1])))  # Python's path with it


class Network:
    """What the double tells, and what others do.

    Args:
        folder: Where the socket is.
    """

    def __init__(self, folder):
        self.address = os.path.join(folder, "rclpy")
        self.told, self._connections = [], []
        self._server = socket.socket(socket.AF_UNIX)
        self._server.bind(self.address)
        self._server.listen()
        threading.Thread(target=self._accept, daemon=True).start()

    def variables(self):
        """Return the environment of a machine on which the double is sourced."""
        return {"PYTHONPATH": SOURCED, "ROS_DISTRO": "jazzy", "RCLPY_DOUBLE": self.address, "AMENT_PREFIX_PATH": ""}

    def of(self, what, name):
        """Return what was told of an end, or of its messages."""
        return [each for each in tuple(self.told) if each["what"] == what and each["name"] == name]

    def wait(self, what, name, count=1):
        """Wait until something was told so often; return it."""
        until(lambda: len(self.of(what, name)) >= count)
        return self.of(what, name)

    def do(self, what, name, **fields):
        """Let another program do something; its data are bytes."""
        line = json.dumps({"what": what, "name": name, **fields, "data": fields.get("data", b"").hex()})
        self._connections[-1].sendall(line.encode() + b"\n")

    def close(self):
        """End it."""
        with contextlib.suppress(OSError):
            self._server.shutdown(socket.SHUT_RDWR)
        for each in (self._server, *self._connections):
            each.close()

    def _accept(self):
        with contextlib.suppress(OSError):
            while True:
                connection, _ = self._server.accept()
                self._connections.append(connection)
                threading.Thread(target=self._read, args=(connection,), daemon=True).start()

    def _read(self, connection):
        with contextlib.suppress(OSError, ValueError):
            self.told += map(json.loads, connection.makefile("r"))
