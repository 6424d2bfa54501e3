"""Whole poses of joints on the page, in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, folder, show
from conftest import rovers
from robots_to_steer import WHEELS_1, arm_with_trajectories

pytestmark = BROWSER_TESTS


@pytest.fixture
def arm(show, tmp_path):
    it, tab = show(arm_with_trajectories(tmp_path).scenario())
    it.twin.clock.real_time_rate = 4.0
    return it, tab


def at(it):
    return it.twin.robot_state("arm").positions[:3]


def press(tab, name):
    folder(tab, "arm").get_by_role("button", name=name, exact=True).click()


def reaches(it, positions):
    it.frames(lambda: at(it) == pytest.approx(positions, abs=0.005))
    it.for_frames(10)  # it comes to rest, and the page is told


def test_joints_go_home_and_to_zero_and_through_saved_poses(arm):
    it, tab = arm
    controller = "trajectory_controller"
    home = [it.twin.entities.start_positions("arm")[f"joint_{number}"] for number in (1, 2, 3)]
    field = folder(tab, "arm").get_by_label("arm joint_1 position, number")
    field.fill("0.6")
    field.press("Enter")
    reaches(it, [0.6, home[1], home[2]])
    tab.get_by_label(f"{controller}: name of the pose to save").fill("left")
    press(tab, f"{controller}: Save the joints' present positions")
    press(tab, f"{controller}: All to zero")
    reaches(it, [0.0, 0.0, 0.0])
    press(tab, f"{controller}: Save the joints' present positions")
    it.frames(lambda: folder(tab, "arm").get_by_role("button", name="pose 2", exact=True).count() == 1)
    press(tab, "left")
    reaches(it, [0.6, home[1], home[2]])
    start = it.twin.time
    press(tab, "Through all")
    it.frames(lambda: it.twin.graph.command("/arm/trajectory_controller/joint_trajectory") is not None)
    it.frames(lambda: it.twin.time > start + 2.5)
    reaches(it, [0.0, 0.0, 0.0])
    press(tab, f"{controller}: All to where they started")
    reaches(it, home)
    tab.reload()
    it.frames(lambda: folder(tab, "arm").get_by_role("button", name="left", exact=True).count() == 1)
    press(tab, "Forget left")
    it.frames(lambda: folder(tab, "arm").get_by_role("button", name="left", exact=True).count() == 0)
    assert folder(tab, "arm").get_by_role("button", name="Through all").count() == 0


def test_wheels_are_set_to_zero(show):
    it, tab = show(rovers(1).command(WHEELS_1, [3.0, 3.0, 3.0, 3.0]).scenario())
    it.frames(lambda: it.twin.robot_state("robot_1").velocities[0] > 2.0)
    folder(tab).get_by_role("button", name="forward_velocity_controller: All to zero").click()
    it.frames(lambda: abs(it.twin.robot_state("robot_1").velocities[0]) < 0.05)
    assert folder(tab).get_by_role("button", name="Save").count() == 0
