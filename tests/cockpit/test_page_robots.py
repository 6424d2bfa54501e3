"""The controls of robots on the page, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import io

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, folder, open_tab, page, show
from conftest import ARM, ROVER, rovers
from PIL import Image
from robots_to_steer import TRAJECTORY, WHEELS_1, arm_with_trajectories

from drake_twin import TwinBuilder
from drake_twin.builder.demo import demo_scenario

pytestmark = BROWSER_TESTS


def test_a_joint_slider_commands_that_joint_by_number_and_by_mouse(page):
    it, tab = page
    number = folder(tab).get_by_label("rear_left_wheel_joint velocity, number")
    number.fill("3")
    number.press("Enter")
    it.frames(lambda: it.twin.graph.command(WHEELS_1) is not None and it.twin.graph.command(WHEELS_1).data[2] == 3.0)
    it.frames(lambda: abs(it.twin.robot_state("robot_1").velocities[2] - 3.0) < 0.05)
    slider = folder(tab).get_by_label("front_left_wheel_joint velocity", exact=False).first
    box = slider.bounding_box()
    tab.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.5 * box["height"], steps=5)
    tab.mouse.up()
    it.frames(lambda: it.twin.graph.command(WHEELS_1).data[0] > 5.0)
    assert it.twin.graph.command(WHEELS_1).data[2] == 3.0
    assert it.twin.graph.command(WHEELS_1.replace("1", "2")) is None


def test_a_slider_shows_what_was_commanded_elsewhere(page):
    it, tab = page
    it.twin.publish(WHEELS_1, [1, 2, 3, 4])
    number = folder(tab).get_by_label("rear_right_wheel_joint velocity, number")
    it.frames(lambda: float(number.input_value()) == 4)


def test_an_arm_on_trajectories_has_sliders(show, tmp_path):
    it, tab = show(arm_with_trajectories(tmp_path).scenario())
    number = folder(tab, "arm").get_by_label("arm joint_2 position, number")
    number.fill("0.3")
    number.press("Enter")
    it.frames(lambda: it.twin.graph.command(TRAJECTORY) is not None)
    it.frames(lambda: abs(it.twin.robot_state("arm").positions[1] - 0.3) < 0.02)


def test_a_controllers_switch_deactivates_and_activates_it(page):
    it, tab = page
    manager = it.twin.control.manager("robot_1")
    switch = folder(tab).get_by_label("robot_1 forward_velocity_controller")
    switch.click(force=True)
    it.frames(lambda: "forward_velocity_controller" not in manager.active)
    slider = folder(tab).get_by_label("rear_left_wheel_joint velocity, number")
    it.frames(lambda: slider.is_disabled())
    switch.click(force=True)
    it.frames(lambda: "forward_velocity_controller" in manager.active)
    it.frames(lambda: slider.is_enabled())


def test_the_joint_states_are_read_out(show):
    it, tab = show(demo_scenario("rover", 1))
    folder(tab).get_by_text("Joint states").click()
    it.frames(lambda: it.twin.time > 0.5)
    it.twin.pause()
    state = it.twin.robot_state("robot_1")
    row = folder(tab).locator("tbody tr").nth(2)
    it.frames(lambda: row.locator("td").first.inner_text() not in ("", "–"))
    for column, value in enumerate((state.positions[2], state.velocities[2])):
        it.frames(
            lambda column=column, value=value: float(row.locator("td").nth(column).inner_text()) == round(value, 4)
        )
    it.frames(lambda: float(row.locator("td").nth(2).inner_text()) == round(state.efforts[2], 3))


def test_the_joint_states_are_plotted_while_the_plots_are_open(page):
    it, tab = page
    plots = folder(tab).locator(".plots")
    it.twin.publish(WHEELS_1, [2, 2, 7, 4])
    it.frames(lambda: it.twin.time > 0.5)
    assert plots.locator("canvas").count() == 0  # nothing is drawn that nobody looks at
    plots.locator("summary").click()
    velocity = plots.locator("figure").nth(1)
    values = velocity.locator(".legend output")
    it.frames(lambda: values.count() == 4 and values.nth(2).inner_text() not in ("", "–"))
    it.frames(lambda: abs(float(values.nth(2).inner_text()) - 7) < 0.01)
    it.twin.publish(WHEELS_1, [-4, 2, 7, 4])
    it.frames(lambda: float(values.nth(0).inner_text()) < -3.9)
    it.for_frames(10)
    shot = np.asarray(Image.open(io.BytesIO(velocity.locator("canvas").screenshot())).convert("RGB")).astype(int)
    red, green, blue = shot[..., 0], shot[..., 1], shot[..., 2]
    second, _ = np.nonzero((red > green + 15) & (green > blue + 10))  # orange, on two rows of pixels
    third, _ = np.nonzero((green > red + 15) & (green > blue + 10))
    assert len(second) > 50
    assert len(third) > 50
    assert np.median(second) > np.median(third)  # 2 rad/s lies below 7 rad/s


def test_the_real_time_factor_is_plotted(page):
    it, tab = page
    open_tab(tab, "Time")
    tab.locator("#factor-plot summary").click()
    factor = tab.locator("#factor-plot .legend output")
    it.frames(lambda: factor.count() == 1 and factor.inner_text() not in ("", "–") and float(factor.inner_text()) > 0.1)


def test_an_emergency_stop_holds_one_robot_and_is_cleared(show):
    it, tab = show(demo_scenario("rover", 2))
    it.frames(lambda: it.twin.robot_state("robot_1").velocities[0] > 2)
    tab.get_by_label("Emergency stop of robot_1", exact=True).click()
    it.frames(lambda: max(map(abs, it.twin.robot_state("robot_1").velocities)) < 0.05)
    assert it.twin.robot_state("robot_2").velocities[0] > 2
    it.frames(lambda: folder(tab).locator(".pill").is_visible())
    tab.get_by_label("Clear emergency stop of robot_1").click()
    it.frames(lambda: not folder(tab).locator(".pill").is_visible())
    number = folder(tab).get_by_label("rear_left_wheel_joint velocity, number")
    it.frames(lambda: number.is_enabled())
    number.fill("2")
    number.press("Enter")
    it.frames(lambda: it.twin.robot_state("robot_1").velocities[2] > 1.9)


def test_stop_all_stops_all(show):
    it, tab = show(demo_scenario("rover", 2))
    it.frames(lambda: it.twin.robot_state("robot_2").velocities[0] > 2)
    tab.get_by_role("button", name="Stop all").click()
    it.frames(lambda: all(max(map(abs, it.twin.robot_state(name).velocities)) < 0.05 for name in it.twin.robots))


def test_a_robot_is_spawned_from_the_dialog_and_deleted_with_its_controls(page):
    it, tab = page
    tab.get_by_role("button", name="Spawn…").click()
    tab.get_by_label("Robot file").fill(ROVER)
    assert tab.get_by_label("Name", exact=True).input_value() == "robot_3"
    tab.get_by_label("x m", exact=True).fill("2")
    tab.get_by_role("button", name="Spawn", exact=True).click()
    it.frames(lambda: "robot_3" in it.twin.robots)
    assert it.twin.robot_state("robot_3").base_pose[0] == pytest.approx(2, abs=0.05)
    it.frames(lambda: folder(tab, "robot_3").count() == 1)
    number = folder(tab, "robot_3").get_by_label("rear_left_wheel_joint velocity, number")
    number.fill("3")
    number.press("Enter")
    it.frames(lambda: it.twin.robot_state("robot_3").velocities[2] > 2.9)
    tab.get_by_label("Delete robot_3").click()
    it.frames(lambda: "robot_3" not in it.twin.robots)
    it.frames(lambda: folder(tab, "robot_3").count() == 0)
    assert folder(tab, "robot_1").count() == 1


def test_a_robot_that_is_only_displayed_has_joint_sliders_and_no_time(show):
    it, tab = show(TwinBuilder().robot("arm", ARM).scenario(), only_displayed=True)
    number = folder(tab, "arm").get_by_label("arm joint_4 position, number")
    number.fill("0.3")
    number.press("Enter")
    it.frames(lambda: it.twin.robot_state("arm").positions[-2:] == pytest.approx((0.3, -0.3)))
    assert it.twin.time == 0
    assert not tab.get_by_role("button", name="Play").is_visible()
    assert folder(tab, "arm").get_by_label("arm joint_5 position").count() == 0  # which follows


def test_many_robots_are_folded_and_found_by_name(show):
    """A slider of one of five robots by its number and Enter."""
    it, tab = show(rovers(5).scenario())
    it.frames(lambda: tab.locator(".robot").count() == 5)
    assert tab.locator(".robot details[open]").count() == 0
    tab.get_by_label("Filter robots").fill("T_4")
    assert tab.locator(".robot:visible").evaluate_all("all => all.map(({ dataset }) => dataset.robot)") == ["robot_4"]
    tab.keyboard.press("Enter")
    it.frames(lambda: folder(tab, "robot_4").get_by_label("rear_left_wheel_joint velocity, number").is_visible())
    it.twin.entities.delete("robot_4")
    it.frames(lambda: tab.locator(".robot").count() == 4)
    assert tab.locator(".robot:visible").count() == 0
    tab.get_by_label("Filter robots").fill("")
    assert tab.locator(".robot:visible").count() == 4
