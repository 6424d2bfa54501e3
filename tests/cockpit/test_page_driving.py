"""Driving bases from the page by keys, pad and gamepad, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, folder, show
from multicopters import quadcopter
from robots_to_steer import CMD_VEL, driven_rovers

from drake_twin import TwinBuilder

pytestmark = BROWSER_TESTS


@pytest.fixture
def driven(show, tmp_path):
    return show(driven_rovers(tmp_path, 2).scenario())


def forward_speed(it):
    return it.twin.graph.command(CMD_VEL) and it.twin.graph.command(CMD_VEL).linear_x


def test_keys_drive_the_chosen_robot_and_letting_go_stops_it(driven):
    it, tab = driven
    tab.keyboard.down("w")
    it.for_frames(10)
    assert it.twin.graph.command(CMD_VEL) is None  # no robot is chosen
    tab.keyboard.up("w")
    folder(tab).get_by_role("button", name="Keys and gamepad").click()
    tab.keyboard.down("w")
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 0.2)
    assert forward_speed(it) == 0.5
    assert abs(it.twin.robot_state("robot_2").base_pose[0]) < 0.01
    tab.keyboard.up("w")
    it.frames(lambda: not forward_speed(it))
    tab.locator("#scene").click()
    tab.keyboard.down("ArrowLeft")
    it.frames(lambda: it.twin.graph.command(CMD_VEL) is not None and it.twin.graph.command(CMD_VEL).angular_z == 1.0)
    tab.keyboard.up("ArrowLeft")
    it.frames(lambda: it.twin.graph.command(CMD_VEL) is None or it.twin.graph.command(CMD_VEL).angular_z == 0.0)
    tab.keyboard.press("Escape")
    tab.keyboard.down("w")
    it.for_frames(10)
    assert not forward_speed(it)


def test_the_pad_drives_at_the_speed_that_is_set(driven):
    it, tab = driven
    number = folder(tab).get_by_label("robot_1 speed, number")
    number.fill("0.25")
    number.press("Enter")
    box = folder(tab).get_by_label("robot_1 Forwards").bounding_box()
    tab.mouse.move(box["x"] + 10, box["y"] + 10)
    tab.mouse.down()
    it.frames(lambda: forward_speed(it) == 0.25)
    tab.mouse.up()
    it.frames(lambda: not forward_speed(it))


def test_a_gamepad_drives(driven):
    it, tab = driven
    tab.evaluate(
        "() => { window.axes = [0, 0, 0, 0]; navigator.getGamepads = () => [{connected: true, axes: window.axes}]; }"
    )
    folder(tab).get_by_role("button", name="Keys and gamepad").click()
    tab.evaluate("window.axes = [0, -1, 0.5, 0]")
    it.frames(lambda: forward_speed(it) == 0.5 and it.twin.graph.command(CMD_VEL).angular_z == -0.5)
    tab.evaluate("window.axes = [0, 0.05, 0, 0]")
    it.frames(lambda: not forward_speed(it))


def test_closing_the_drivers_tab_stops_the_robot_and_not_the_twin(driven):
    it, tab = driven
    folder(tab).get_by_role("button", name="Keys and gamepad").click()
    tab.keyboard.down("w")
    it.frames(lambda: forward_speed(it) == 0.5)
    tab.close()
    it.tabs.remove(tab)
    it.frames(lambda: not forward_speed(it))
    start = it.twin.time
    it.frames(lambda: it.twin.time > start + 0.2)


def test_what_flies_goes_up_and_down_by_keys_and_buttons_too(show, tmp_path):
    file = tmp_path / "x3.sdf"
    file.write_text(quadcopter(controlled=True))
    it, tab = show(TwinBuilder(time_step=0.004).robot("uav", file, xyz=(0, 0, 1)).scenario())

    def climb():
        command = it.twin.graph.command("/uav/command/twist")
        return command and command.linear[2]

    folder(tab, "uav").get_by_role("button", name="Keys and gamepad").click()
    tab.keyboard.down("r")
    it.frames(lambda: climb() == 0.5)
    heights = []  # it has fallen until its first command

    def has_risen():
        heights.append(it.twin.robot_state("uav").base_pose[2])
        return heights[-1] > min(heights) + 0.05

    it.frames(has_risen)
    tab.keyboard.up("r")
    it.frames(lambda: climb() == 0.0)
    box = folder(tab, "uav").get_by_label("uav Downwards").bounding_box()
    tab.mouse.move(box["x"] + 10, box["y"] + 10)
    tab.mouse.down()
    it.frames(lambda: climb() == -0.5)
    tab.mouse.up()
    it.frames(lambda: climb() == 0.0)


def test_what_drives_has_no_buttons_for_heights(driven):
    _, tab = driven
    assert folder(tab).get_by_label("robot_1 Forwards").is_visible()
    assert not folder(tab).get_by_label("robot_1 Upwards").count()
