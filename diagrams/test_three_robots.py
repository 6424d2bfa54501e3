"""Three robots in CI: a test with pytest, as the CI of a robot's package would have it.

Run it: python -m pytest diagrams/test_three_robots.py
"""

import pytest

from drake_twin import TwinBuilder

ROVER = "package://rover_description/urdf/rover.urdf.xacro"
ROVERS = ("robot_1", "robot_2", "robot_3")


@pytest.fixture
def twin():
    builder = TwinBuilder(time_step=0.01)
    for number, name in enumerate(ROVERS):
        builder.robot(name, ROVER, xyz=(0, 2 * number, 0.13))
    return builder.build()


def test_nothing_in_the_files_is_ignored(twin):
    assert twin.findings == ()


def test_every_robot_has_its_controllers_active(twin):
    for name in ROVERS:
        states = {item.name: item.state for item in twin.control.manager(name).list_controllers()}
        assert states["forward_velocity_controller"] == "active"


@pytest.mark.parametrize("moving", ROVERS)
def test_a_command_moves_one_robot_and_no_other(twin, moving):
    twin.publish(f"/{moving}/forward_velocity_controller/commands", [5.0, 5.0, 5.0, 5.0])
    twin.advance_to(2.0)
    for name in ROVERS:
        x = twin.robot_state(name).base_pose[0]
        assert x == pytest.approx(1.0 if name == moving else 0.0, abs=0.05)


def test_two_runs_end_in_the_same_state(twin):
    twin.publish("/robot_1/forward_velocity_controller/commands", [2.0, 4.0, 2.0, 4.0])
    twin.advance_to(1.0)
    first = twin.state_sha256()
    twin.reset()
    twin.publish("/robot_1/forward_velocity_controller/commands", [2.0, 4.0, 2.0, 4.0])
    twin.advance_to(1.0)
    assert twin.state_sha256() == first
