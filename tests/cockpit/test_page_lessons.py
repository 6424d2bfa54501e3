"""The two lessons that this project comes from, done wholly on the page, in a real browser.

Only what a reader of the page sees is used: labels, names of buttons, the numbers that it shows.
"""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, folder, open_tab, show
from conftest import ARM, ROVER, rovers
from show_menu import press

pytestmark = BROWSER_TESTS


def spawn(it, tab, file, name, y):
    tab.get_by_role("button", name="Spawn…").click()
    tab.get_by_label("Robot file").fill(file)
    tab.get_by_label("Name", exact=True).fill(name)
    tab.get_by_label("y m", exact=True).fill(str(y))
    tab.get_by_role("button", name="Spawn", exact=True).click()
    it.frames(lambda: folder(tab, name).count() == 1 and not tab.locator("#spawn-dialog").is_visible())


def enter(it, field, text):
    field.fill(text)
    field.press("Enter")


def factor(tab):
    """The real-time factor that the page shows; 0 while it shows none."""
    text = tab.locator("#factor").inner_text()
    return float(text.rstrip("×")) if text not in ("–", "paused") else 0.0


def test_several_robots_in_one_world(show):
    """Robots by name, each with its topics, frames and controllers, driven from one place."""
    it, tab = show(rovers(1).scenario())
    spawn(it, tab, ROVER, "left", 1.5)
    spawn(it, tab, ROVER, "right", -1.5)
    for name, speed in (("left", "3"), ("right", "-3")):
        open_tab(tab, "View")
        tab.get_by_label("Camera follows").select_option(name)
        open_tab(tab, "Robots")
        for wheel in ("front_left", "front_right", "rear_left", "rear_right"):
            field = folder(tab, name).get_by_label(f"{name}_{wheel}_wheel_joint velocity, number")
            it.frames(lambda field=field: field.is_enabled())
            enter(it, field, speed)
    open_tab(tab, "View")
    tab.get_by_label("Camera follows").select_option("")
    it.frames(lambda: it.twin.entities.state("left").position[0] > 0.3)
    it.frames(lambda: it.twin.entities.state("right").position[0] < -0.3)
    open_tab(tab, "ROS")
    tab.locator(".topics-panel summary", has_text="Topics").click()
    tab.get_by_label("Filter topics").fill("left")
    it.frames(lambda: tab.locator(".topics button", has_text="/left/joint_states").count() == 1)
    tab.locator(".topics-panel summary", has_text="Frames").click()
    it.frames(lambda: tab.locator(".frames li", has_text="right_base_link").count() >= 1)
    press(tab, "Frames (tf)")
    it.frames(lambda: it.scene.has_path("/overlays/frames"))
    open_tab(tab, "Robots")
    controller = folder(tab, "left").get_by_label("left forward_velocity_controller", exact=True)
    it.frames(controller.is_checked)
    controller.click(force=True)
    it.frames(lambda: folder(tab, "left").locator(".controller .muted", has_text="inactive").count() == 1)
    controller.click(force=True)
    it.frames(lambda: folder(tab, "left").locator(".controller .muted", has_text="inactive").count() == 0)
    open_tab(tab, "Time")
    step = tab.get_by_label("Physics step, number")
    enter(it, step, "5")
    it.frames(lambda: it.twin.clock.time_step == 0.005)
    it.frames(lambda: factor(tab) > 0)
    open_tab(tab, "Robots")
    folder(tab, "right").locator("summary", has_text="Joint states").click()
    folder(tab, "right").get_by_title("Plot right_rear_left_wheel_joint").click()
    it.frames(lambda: tab.locator("#plots canvas").count() == 1)
    it.for_frames(20)


BARE = """<robot name="bare">
  <link name="base"><inertial><mass value="5"/>
    <inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial></link>
  <link name="arm"><inertial><origin xyz="0.3 0 0"/><mass value="1"/>
    <inertia ixx="0.01" iyy="0.01" izz="0.01" ixy="0" ixz="0" iyz="0"/></inertial>
    <visual><origin xyz="0.3 0 0"/><geometry><box size="0.6 0.05 0.05"/></geometry></visual></link>
  <link name="world"/>
  <joint name="fixed" type="fixed"><parent link="world"/><child link="base"/></joint>
  <joint name="shoulder" type="revolute"><parent link="base"/><child link="arm"/><axis xyz="0 1 0"/>
    <origin xyz="0 0 1"/><limit lower="-2" upper="2" effort="10" velocity="5"/></joint>
</robot>"""


def position(tab, robot, joint):
    return float(folder(tab, robot).locator("tr", has_text=joint).locator("td").first.inner_text() or "nan")


def test_an_arm_bends_without_a_controller_and_the_step_is_raised(show, tmp_path):
    """A digital twin of an arm: no controller runs, and it bends; another's does; the step is raised for more speed."""
    (tmp_path / "bare.urdf").write_text(BARE)
    it, tab = show(rovers(1).scenario())
    spawn(it, tab, str(tmp_path / "bare.urdf"), "bare", -2.0)
    spawn(it, tab, ARM, "arm", 2.0)
    tab.get_by_label("Delete robot_1").click()
    it.frames(lambda: folder(tab, "robot_1").count() == 0)
    for name in ("bare", "arm"):
        folder(tab, name).locator("summary", has_text="Joint states").click()
    it.frames(lambda: position(tab, "bare", "shoulder") > 0.3)
    assert abs(position(tab, "arm", "joint_3")) < 0.01
    assert folder(tab, "bare").locator(".controller").count() == 0
    enter(it, folder(tab, "arm").get_by_label("arm joint_1 velocity, number"), "0.5")
    it.frames(lambda: position(tab, "arm", "joint_1") > 0.1)
    switch = folder(tab, "arm").get_by_label("arm forward_velocity_controller", exact=True)
    it.frames(switch.is_checked)
    switch.click(force=True)
    it.frames(lambda: folder(tab, "arm").locator(".controller .muted", has_text="inactive").count() == 1)
    assert not it.twin.control.manager("arm").is_active("forward_velocity_controller")
    switch.click(force=True)
    it.frames(lambda: it.twin.control.manager("arm").is_active("forward_velocity_controller"))
    open_tab(tab, "Time")
    step = tab.get_by_label("Physics step, number")
    assert float(step.input_value()) == 1.0
    enter(it, step, "10")
    it.frames(lambda: it.twin.clock.time_step == 0.01)
    it.frames(lambda: factor(tab) > 0)
    assert float(step.input_value()) == 10.0
