"""Switching between controllers that command the same joints, as the page's buttons request it, without a browser."""

import pytest
from conftest import rovers
from fake_page import FakePage
from two_hinges import hinges, velocities

from drake_twin.builder.demo import demo_scenario
from drake_twin.cockpit import protocol
from drake_twin.cockpit.scene import Scene
from drake_twin.twin.replay import replay
from drake_twin.twin.twin import Twin

FORWARD, DRIVE = "forward_velocity_controller", "drive_controller"
TRAJECTORIES, GRIPPER = "joint_trajectory_controller", "gripper_controller"
CMD_VEL = f"/robot_1/{DRIVE}/cmd_vel"


@pytest.fixture(scope="module")
def scene():
    return Scene()


@pytest.fixture
def demo(scene):
    pages = []

    def make(robot, count=1, **options):
        pages.append(FakePage(Twin(demo_scenario(robot, count, **options)), scene))
        return pages[-1]

    yield make
    for page in pages:
        page.cockpit.close()


def active(page, robot="robot_1"):
    return page.twin.control.manager(robot).active[1:]  # the first is the broadcaster


def test_a_rover_is_switched_to_its_drive_and_back(demo):
    page = demo("rover", 2)
    page.ask(protocol.SwitchTo("robot_1", DRIVE), protocol.Drive(CMD_VEL, 0.5, 0.0, 0.0))
    page.twin.advance_to(0.05)
    assert (active(page), active(page, "robot_2")) == ((DRIVE,), (FORWARD,))
    assert page.twin.graph.command(CMD_VEL).linear_x == 0.5
    assert page.state["robots"]["robot_1"]["controllers"][DRIVE] == "active"
    assert ("info", f"robot_1: switched: {DRIVE} active, {FORWARD} inactive") in page.messages
    page.ask(protocol.SwitchTo("robot_1", FORWARD))
    assert page.state
    assert active(page) == (FORWARD,)
    assert page.messages[-1] == ("info", f"robot_1: switched: {FORWARD} active, {DRIVE} inactive")


def test_an_arm_is_switched_to_its_trajectories_and_its_gripper_and_back_at_once(demo):
    page = demo("arduinobot", drive=False)
    page.ask(protocol.SwitchTo("robot_1", TRAJECTORIES), protocol.SwitchTo("robot_1", GRIPPER))
    page.ask(protocol.MoveJoint(f"/robot_1/{TRAJECTORIES}/joint_trajectory", 0, 0.3))
    page.ask(protocol.MoveJoint(f"/robot_1/{GRIPPER}/gripper_cmd", 0, 0.4))
    page.twin.advance_to(2.0)
    positions = page.twin.robot_state("robot_1").positions
    assert (positions[0], positions[3]) == pytest.approx((0.3, 0.4), abs=0.02)
    page.ask(protocol.SwitchTo("robot_1", FORWARD))
    assert page.state
    assert active(page) == (FORWARD,)
    texts = [text for _, text in page.messages]
    assert texts[-3:] == [
        f"robot_1: switched: {TRAJECTORIES} active, {FORWARD} inactive",
        f"robot_1: switched: {GRIPPER} active",
        f"robot_1: switched: {FORWARD} active, {TRAJECTORIES} inactive, {GRIPPER} inactive",
    ]


def test_the_gripper_replaces_what_commands_its_joint_by_another_interface(demo):
    page = demo("arduinobot", drive=False)
    page.ask(protocol.SwitchTo("robot_1", GRIPPER))
    assert active(page) == (GRIPPER,)


@pytest.mark.parametrize(
    ("robot", "controller", "reason"),
    [
        ("robot_1", FORWARD, f"robot_1: nothing is switched: controller {FORWARD!r} is already active"),
        ("robot_1", "no_such_controller", "controller 'no_such_controller' is not loaded"),
        ("robot_9", FORWARD, "robot_9"),
    ],
)
def test_a_switch_that_is_refused_is_reported_and_changes_nothing(scene, robot, controller, reason):
    page = FakePage(rovers(1).build(), scene)
    page.ask(protocol.SwitchTo(robot, controller))
    assert page.state
    assert active(page) == (FORWARD,)
    level, text = page.messages[-1]
    assert level == "error"
    assert reason in text
    page.cockpit.close()


def test_a_recorded_switch_is_replayed_to_the_same_bits(scene):
    page = FakePage(Twin(demo_scenario("rover", 1)), scene)
    page.twin.recorder.begin()
    page.twin.advance_to(0.1)
    page.ask(protocol.SwitchTo("robot_1", DRIVE), protocol.Drive(CMD_VEL, 0.5, 0.0, 0.0))
    page.twin.advance_to(0.5)
    again = replay(page.twin.recorder.recording())
    assert again.state_sha256() == page.twin.state_sha256()
    page.cockpit.close()


def test_a_chain_is_switched_as_a_whole_in_both_directions(tmp_path, scene):
    pid = (
        "pid_controller/PidController",
        {
            "dof_names": ["left"],
            "command_interface": "effort",
            "reference_and_state_interfaces": ["velocity"],
            "gains": {"left": {"p": 5.0}},
        },
    )
    upper = (
        "forward_command_controller/ForwardCommandController",
        {"joints": ["low/left"], "interface_name": "velocity"},
    )
    builder = hinges(
        tmp_path,
        {"low": pid, "upper": upper, "plain": velocities("left")},
        active=("plain",),
        inactive=("low", "upper"),
    )
    page = FakePage(builder.build(), scene)
    manager = page.twin.control.manager("r")
    page.ask(protocol.SwitchTo("r", "upper"))
    assert page.state
    assert page.messages[-1] == ("info", "r: switched: upper active, low active, plain inactive")
    assert set(manager.active) == {"low", "upper"}
    page.ask(protocol.SwitchTo("r", "plain"))
    assert page.state
    assert page.messages[-1] == ("info", "r: switched: plain active, low inactive, upper inactive")
    assert manager.active == ("plain",)
    page.cockpit.close()
