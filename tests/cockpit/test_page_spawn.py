"""The spawn dialog in a real Chromium: it finds robots, shows a file's arguments, and stays open when it is refused."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, folder, page, show
from conftest import ARM, ROVER, rovers
from in_scene import place_of, tools

from drake_twin.scenario import NodeProgram, Robot, Scenario

pytestmark = BROWSER_TESTS


def test_a_found_robot_is_spawned_where_the_scene_was_clicked_and_is_recent_then(page):
    it, tab = page
    tab.get_by_role("button", name="Spawn…").click()
    found = tab.get_by_label("Found robots")
    it.frames(lambda: found.locator(f'option[value="{ARM}"]').count() > 0)
    found.select_option(ARM)
    assert tab.get_by_label("Robot file").input_value() == ARM
    tab.locator("#spawn-preview summary").click()
    picture = tab.locator("#spawn-preview img")
    it.frames(lambda: picture.is_visible() and picture.evaluate("image => image.naturalWidth") == 320)
    tab.get_by_role("button", name="Click in the scene…").click()
    assert not tab.locator("#spawn-dialog").is_visible()
    tab.mouse.click(*place_of(tab, (0.6, 1.0, 0.0)))
    it.frames(lambda: tab.locator("#spawn-dialog").is_visible())
    assert float(tab.get_by_label("x m", exact=True).input_value()) == pytest.approx(0.6, abs=0.02)
    tab.get_by_role("button", name="Spawn", exact=True).click()
    it.frames(lambda: "robot_3" in it.twin.robots)
    it.frames(lambda: not tab.locator("#spawn-dialog").is_visible())
    assert it.twin.entities.state("robot_3").position == pytest.approx((0.6, 1.0, 0.0), abs=0.02)
    tab.get_by_role("button", name="Spawn…").click()
    assert tab.get_by_label("Name", exact=True).input_value() == "robot_4"
    it.frames(lambda: found.locator('optgroup[label="Recent"] option').count() == 1)


def test_a_robot_is_spawned_beside_what_is_there_and_its_box_follows_the_mouse_before_a_click(page):
    it, tab = page
    tab.get_by_role("button", name="Spawn…").click()
    tab.get_by_label("Robot file").fill(ROVER)
    tab.get_by_label("Name", exact=True).focus()  # as with Tab: the file is given
    x, y = (tab.get_by_label(f"{axis} m", exact=True) for axis in "xy")
    it.frames(lambda: (x.input_value(), y.input_value()) != ("0", "0"))
    place = float(x.input_value()), float(y.input_value())
    robots = [it.twin.entities.state(robot).position for robot in it.twin.robots]
    assert min(np.hypot(place[0] - there[0], place[1] - there[1]) for there in robots) > 0.6
    tab.get_by_role("button", name="Click in the scene…").click()
    for there in ((1.0, 1.0, 0.0), (0.6, 1.0, 0.0)):
        tab.mouse.move(*place_of(tab, there))
        it.frames(lambda x=there[0]: tools(tab, "placing.box?.position.x ?? 0") == pytest.approx(x, abs=0.05))
    size = tools(tab, "placing.box.geometry.parameters")
    assert (size["width"], size["height"]) == pytest.approx((0.6, 0.5), abs=0.2)  # of a rover
    assert tools(tab, "placing.box.position.z") == pytest.approx(size["depth"] / 2, abs=0.02)  # it stands
    tab.keyboard.press("Escape")
    it.frames(lambda: tab.locator("#spawn-dialog").is_visible())
    assert tools(tab, "placing.box") is None
    assert (float(x.input_value()), float(y.input_value())) == place
    tab.get_by_role("button", name="Spawn", exact=True).click()
    it.frames(lambda: "robot_3" in it.twin.robots)
    assert it.twin.entities.state("robot_3").position[:2] == pytest.approx(place, abs=0.05)


def test_a_bad_file_keeps_the_dialog_with_the_reason_and_arguments_are_given(page, tmp_path):
    it, tab = page
    file = tmp_path / "made.xacro"
    file.write_text(
        '<robot name="made" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="mass" default="0"/>'
        '<link name="a"><inertial><mass value="${1/float(\'$(arg mass)\')}"/>'
        '<inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link></robot>'
    )
    tab.get_by_role("button", name="Spawn…").click()
    tab.get_by_label("Robot file").fill(str(file))
    it.frames(lambda: tab.locator("#spawn-arguments").is_visible())
    tab.get_by_role("button", name="Spawn", exact=True).click()
    message = tab.locator("#spawn-message")
    it.frames(lambda: message.is_visible())
    assert "made.xacro" in message.inner_text()
    assert "division by zero" in message.inner_text()
    assert it.twin.robots == ("robot_1", "robot_2")
    tab.locator("#spawn-arguments summary").click()
    mass = tab.get_by_label("Argument mass")
    assert mass.get_attribute("placeholder") == "0"
    mass.fill("4")
    tab.get_by_role("button", name="Spawn", exact=True).click()
    it.frames(lambda: "robot_3" in it.twin.robots)
    it.frames(lambda: not tab.locator("#spawn-dialog").is_visible())
    assert it.twin.scenario.robots[2].xacro_args == {"mass": "4"}


def test_a_page_without_robots_shows_the_one_that_a_node_spawns_and_none_after_it(show, tmp_path):
    (tmp_path / "idle.py").write_text("import rclpy\n")
    it, tab = show(Scenario(robots=(), nodes=(NodeProgram(str(tmp_path / "idle.py")),)))
    it.for_frames(5)
    it.twin.entities.spawn(Robot("rover", str(ROVER), xyz=(0, 0, 0.13)))
    it.frames(lambda: folder(tab, "rover").count() == 1)
    it.twin.entities.delete("rover")
    it.frames(lambda: folder(tab, "rover").count() == 0)
