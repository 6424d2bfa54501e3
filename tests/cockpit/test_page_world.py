"""The panel of the world in a real Chromium: the tree, the selection in it and in the scene, the details."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, open_tab, page, picture, show
from conftest import ROVER
from in_scene import item, look_at, place_of
from world_with_crate import rover_and_crate

from drake_twin.scenario import Robot

pytestmark = BROWSER_TESTS


@pytest.fixture
def crates(show, tmp_path):
    """A rover beside a crate and a ramp."""
    it, tab = show(rover_and_crate(tmp_path).scenario())
    open_tab(tab, "World")
    return it, tab


def value(tab, label):
    """The inspector's value beside a label."""
    return tab.locator(".inspector dt", has_text=label).first.locator("xpath=following-sibling::dd[1]")


def test_the_tree_has_robots_links_joints_models_and_lights(crates):
    it, tab = crates
    it.frames(lambda: item(tab, "robot:rover::rover").count() == 1)
    shown = [row.inner_text().split("\n")[-1] for row in tab.locator(".tree li:visible").all()]
    assert shown == ["rover", "ramp", "crate", "ground", "point 1"]
    robot = item(tab, "robot:rover::rover")
    robot.focus()
    for key in ("ArrowRight", "ArrowDown", "ArrowRight", "ArrowDown", "ArrowDown"):
        robot.page.keyboard.press(key)
    assert "rover_front_left_wheel_joint" not in tab.evaluate("document.activeElement.innerText")
    assert "rover_front_right_wheel_joint" in tab.evaluate("document.activeElement.innerText")
    tab.keyboard.press("Enter")
    it.frames(lambda: value(tab, "Type").count() == 1)
    it.seen(value(tab, "Type"), "continuous")
    it.seen(value(tab, "Axis"), "0.000 1.000 0.000")


def test_a_click_in_the_scene_selects_in_the_tree_and_shows_what_is_true_in_the_twin(crates):
    it, tab = crates
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
    it.frames(lambda: it.twin.time > 0.5)
    look_at(tab, "rover", "crate")
    it.for_frames(3)
    before = picture(tab)
    tab.mouse.click(*place_of(tab, (-0.5, 0.9, 0.4)))
    it.frames(lambda: item(tab, "link:crate::link").get_attribute("aria-selected") == "true")
    it.seen(value(tab, "Mass"), "2.000 kg")
    x, y, z = it.twin.entities.state("crate").position
    it.seen(value(tab, "Position"), f"{x:.3f} {y:.3f} {z:.3f} m")
    it.frames(lambda: value(tab, "Box").count() == 1)
    assert (picture(tab) - before)[..., 2].max() > 30  # it glows blue
    tab.mouse.click(*place_of(tab, (0.1, 0.45, 0.0)))  # the ground
    it.frames(lambda: tab.locator(".tree [aria-selected=true]").count() == 0)
    assert not tab.locator(".inspector").is_visible()


def test_a_robots_details_are_its_controllers_topics_and_findings(crates):
    it, tab = crates
    it.frames(lambda: item(tab, "robot:rover::rover").count() == 1)
    item(tab, "robot:rover::rover").click()
    it.frames(lambda: value(tab, "forward_velocity_controller").count() == 1)
    it.frames(lambda: value(tab, "forward_velocity_controller").inner_text().startswith("active, "))
    assert value(tab, "/rover/joint_states").inner_text() == "published, sensor_msgs/msg/JointState"
    assert value(tab, "File").inner_text() == ROVER
    it.twin.control.manager("rover").switch_controller(deactivate=["forward_velocity_controller"])
    it.frames(lambda: value(tab, "forward_velocity_controller").inner_text().startswith("inactive, "))


def test_what_comes_and_goes_does_so_in_the_tree(crates):
    it, tab = crates
    it.frames(lambda: item(tab, "robot:rover::rover").count() == 1)
    it.twin.entities.spawn(Robot("second", ROVER, xyz=(-0.5, 1, 0.13)))
    it.frames(lambda: item(tab, "robot:second::second").count() == 1)
    item(tab, "robot:second::second").click()
    it.frames(lambda: value(tab, "Mass").count() == 1)
    it.twin.entities.delete("second")
    it.frames(lambda: item(tab, "robot:second::second").count() == 0)
    it.frames(lambda: not tab.locator(".inspector").is_visible())


def test_nothing_is_read_while_no_tab_shows_the_panel(crates):
    it, tab = crates
    panel = it.cockpit.panels["world"]
    it.frames(lambda: panel.state() is not None)
    open_tab(tab, "View")
    it.frames(lambda: panel.state() is None)
    open_tab(tab, "World")
    it.frames(lambda: panel.state() is not None)
    tab.get_by_role("button", name="Side panel").click()
    it.frames(lambda: panel.state() is None)
