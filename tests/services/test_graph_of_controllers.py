"""A controller has its topics and actions on the graph once it is configured, as in ROS."""

import pytest
from conftest import ARM, rovers
from wires.local_wire import LocalWire

from drake_twin import TwinBuilder
from drake_twin.services.graph import connect

COMMANDS, STATES = "/robot_1/forward_velocity_controller/commands", "/robot_1/joint_states"


@pytest.fixture
def wired():
    """A rover on a wire."""
    with rovers(1).build() as twin:
        wire = LocalWire()
        seam = connect(twin, [wire])
        try:
            yield twin, wire
        finally:
            seam.close()


def present(ends):
    return {name for name, end in ends.items() if not end.is_closed}


def look(twin):
    twin.advance_to(twin.time + 0.01)
    twin.inbox.work()


def test_topics_go_and_come_with_their_controller(wired):
    twin, wire = wired
    manager = twin.control.manager("robot_1")
    assert COMMANDS in present(wire.listeners)
    manager.switch_controller(deactivate=["forward_velocity_controller"])
    look(twin)
    assert COMMANDS in present(wire.listeners)  # an inactive one still listens
    manager.unload_controller("forward_velocity_controller")
    look(twin)
    assert COMMANDS not in present(wire.listeners)
    assert STATES in present(wire.senders)
    manager.load_controller("forward_velocity_controller")
    look(twin)
    assert COMMANDS not in present(wire.listeners)
    wire.listeners.clear()
    manager.configure_controller("forward_velocity_controller")
    look(twin)
    assert COMMANDS in present(wire.listeners)


def test_two_robots_with_one_topic_keep_it_until_both_are_without():
    builder = TwinBuilder()
    for index in range(2):
        builder.robot(f"robot_{index}", ARM, xyz=(0, index, 0), namespace="")
    with builder.build() as twin:
        wire = LocalWire()
        seam = connect(twin, [wire])
        try:
            for index in range(2):
                assert "/joint_states" in present(wire.senders)
                manager = twin.control.manager(f"robot_{index}")
                manager.switch_controller(deactivate=["joint_state_broadcaster"])
                manager.unload_controller("joint_state_broadcaster")
                look(twin)
            assert "/joint_states" not in present(wire.senders)
        finally:
            seam.close()
