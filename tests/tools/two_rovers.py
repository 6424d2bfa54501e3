"""Two rovers on the graph, and tools that talk to them."""

import faulthandler
import sys
from collections.abc import Iterator
from contextlib import contextmanager

from conftest import rovers
from wires.ros_client import while_running
from wires.zenoh_peer import free_port

from drake_twin.services.graph import connect
from drake_twin.wires.zenoh_wire import ZenohWire

DOMAIN = 6
COMMANDS = "/robot_1/forward_velocity_controller/commands"
ARRAY = "std_msgs/msg/Float64MultiArray"
MANAGER = ("-c", "/robot_1/controller_manager")
STATES = "/robot_1/joint_states"


class Tool:
    """Runs tools while the twin runs.

    Attributes:
        twin: The twin.
        port: Of its router.
    """

    def __init__(self, twin, port, capsys):
        self.twin, self.port, self._capsys = twin, port, capsys

    def __call__(self, module, *words):
        """Run a tool; return its exit code and what it prints."""
        words = [*map(str, words), "--router", f"127.0.0.1:{self.port}"]
        code = while_running(self.twin, lambda: module.main(words))
        captured = self._capsys.readouterr()
        return code, captured.out, captured.err

    def refused(self, module, *words):
        """Run a tool that refuses what it is given; return the paragraph."""
        code, _, err = self(module, *words)
        assert code == 2, err
        assert err.startswith("error: ")
        assert err.count("\n") == 1
        return err


@contextmanager
def tool_of_two_rovers(capsys, monkeypatch) -> Iterator[Tool]:
    """Yield a tool beside two rovers; one that waits for ever ends the tests."""
    monkeypatch.setenv("ROS_DOMAIN_ID", str(DOMAIN))
    faulthandler.dump_traceback_later(180, exit=True, file=sys.__stderr__)
    port = free_port()
    with rovers(2).static_transform("world", "robot_1_odom").build() as twin:
        seam = connect(twin, [ZenohWire(domain=DOMAIN, port=port)])
        try:
            yield Tool(twin, port, capsys)
        finally:
            seam.close()
            faulthandler.cancel_dump_traceback_later()
