"""The page as a person uses it, in a real Chromium: each control is operated, and the twin's state is looked at.

Screenshots before and after each test are in its ``tmp_path``.
"""

import io
import math
import shutil

import numpy as np
import pytest
from conftest import ARM, ROVER, rovers
from PIL import Image
from robots_to_steer import CMD_VEL, TRAJECTORY, WHEELS_1, arm_with_trajectories, driven_rovers

from drake_twin import Twin, TwinBuilder
from drake_twin.builder.demo import demo_scenario
from drake_twin.cockpit.scene import OVERLAYS
from drake_twin.cockpit.served_page import ServedPage

CHROMIUM = next(filter(None, map(shutil.which, ("chromium", "chromium-browser", "google-chrome"))), None)
SOFTWARE_RENDERING = ["--no-sandbox", "--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"]
OFFLINE = ["--disable-background-networking", "--disable-component-update", "--disable-sync", "--no-first-run"]

pytestmark = [
    pytest.mark.browser,
    pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)"),
]


@pytest.fixture(scope="module")
def browser():
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_RENDERING + OFFLINE)
        yield browser
        browser.close()


class Shown:
    """A twin, its page's server side, and browsers' tabs with the page."""

    def __init__(self, browser, scenario, **options):
        self._browser = browser
        self.served = ServedPage()
        self.scene = self.served.scene
        self.twin = Twin(scenario)
        self.cockpit = self.served.show(self.twin, **options)
        self.tabs = []
        self.faults = []

    def tab(self):
        """Opens the page in a new tab and waits until it shows something."""
        tab = self._browser.new_page(viewport={"width": 1280, "height": 800})
        tab.on("pageerror", lambda error: self.faults.append(str(error)))
        tab.on("console", lambda line: line.type == "error" and self.faults.append(line.text))
        self.tabs.append(tab)
        tab.goto(self.served.url)
        self.frames(lambda: len(self.served.server.clients) == len(self.tabs))
        self.frames(lambda: len(self.served.server._viewers) == len(self.tabs))
        self.frames(lambda: tab.locator("body.ready").count() == 1)
        return tab

    def frames(self, until, most=900):
        """Runs frame by frame, as the program does, until something holds."""
        count = 0

        def each_frame():
            nonlocal count
            count += 1
            self.cockpit.obey()
            return not until() and count < most

        self.twin.run(each_frame=each_frame)
        assert until(), f"not within {most} frames"

    def seen(self, locator, text):
        """Runs until an element reads as wanted."""
        self.frames(lambda: locator.inner_text() == text)

    def for_frames(self, count):
        """Runs so many frames."""
        left = iter(range(count))
        self.frames(lambda: next(left, None) is None, most=count + 2)

    def close(self):
        for tab in self.tabs:
            tab.close()
        self.served.close()


@pytest.fixture
def show(browser, tmp_path):
    """Shows a scenario in a tab; screenshots are taken then and at the end."""
    shown = []

    def show_(scenario, **options):
        it = Shown(browser, scenario, **options)
        shown.append(it)
        tab = it.tab()
        tab.screenshot(path=tmp_path / "before.png")
        return it, tab

    yield show_
    for it in shown:
        for number, tab in enumerate(it.tabs):
            tab.screenshot(path=tmp_path / f"after_{number}.png")
        it.close()
        assert it.faults == []


@pytest.fixture
def page(show):
    """Two rovers that stand still."""
    return show(rovers(2).scenario())


def folder(tab, robot="robot_1"):
    return tab.locator(f"details.robot[data-robot={robot}]")


def picture(tab):
    """The scene's pixels, once two pictures in a row are alike."""
    last = None
    for _ in range(40):
        shot = tab.locator("#scene").screenshot()
        if shot == last:
            break
        last = shot
    return np.asarray(Image.open(io.BytesIO(last)).convert("RGB")).astype(int)


def changed(before, after):
    """How many pixels differ clearly."""
    return int((np.abs(after - before).sum(axis=2) > 60).sum())


def orange(shot):
    """Where the orange of a rover's body is: rows and columns."""
    red, green, blue = shot[..., 0], shot[..., 1], shot[..., 2]
    return np.nonzero((red > 130) & (red > 1.6 * green) & (green > 1.5 * blue))


def orange_bodies(shot):
    """How many groups of columns, 30 pixels or more apart, hold the orange of a rover's body."""
    _, columns = orange(shot)
    columns = np.unique(columns)
    return 1 + int((np.diff(columns) >= 30).sum()) if len(columns) else 0


# --- the scene


def test_the_page_shows_both_rovers_and_they_drive(show):
    it, tab = show(demo_scenario("rover", 2))
    it.twin.pause()
    it.for_frames(3)
    before = picture(tab)
    assert orange_bodies(before) == 2
    it.twin.play()
    start = it.twin.time
    it.frames(lambda: it.twin.time > start + 1.0)
    it.twin.pause()
    it.for_frames(3)
    after = picture(tab)
    assert orange_bodies(after) == 2
    assert changed(before, after) > 1000


def test_meshcats_own_panel_is_not_shown(page):
    _, tab = page
    scene = tab.frame_locator("#scene")
    assert scene.locator("#meshcat-pane canvas").count() == 1
    assert not any(
        scene.locator(".dg.main").nth(index).is_visible() for index in range(scene.locator(".dg.main").count())
    )


# --- time


def test_the_play_button_pauses_and_goes_on(page):
    it, tab = page
    tab.get_by_role("button", name="Pause").click()
    it.frames(lambda: it.twin.paused)
    stopped = it.twin.time
    it.for_frames(5)
    assert it.twin.time == stopped
    it.seen(tab.locator("#time"), f"{stopped:.3f} s")
    it.seen(tab.locator("#factor"), "paused")
    tab.get_by_role("button", name="Play").click()
    it.frames(lambda: it.twin.time > stopped + 0.1)


def test_the_space_bar_pauses_also_after_a_click_into_the_scene(page):
    it, tab = page
    tab.locator("#scene").click()
    tab.keyboard.press("Space")
    it.frames(lambda: it.twin.paused)
    it.frames(lambda: tab.get_by_role("button", name="Play", exact=True).count() == 1)
    tab.keyboard.press("Space")
    it.frames(lambda: not it.twin.paused)


def test_step_makes_so_many_steps(page):
    it, tab = page
    it.twin.pause()
    before = it.twin.step_count
    tab.get_by_label("Number of steps").fill("25")
    tab.get_by_role("button", name="Step", exact=True).click()
    it.frames(lambda: it.twin.step_count == before + 25)
    tab.locator("#scene").click()
    tab.keyboard.press("n")
    it.frames(lambda: it.twin.step_count == before + 50)
    assert it.twin.paused


def test_run_to_stops_there(page):
    it, tab = page
    it.twin.pause()
    target = math.ceil(10 * it.twin.time + 1) / 10 + 0.5
    tab.get_by_label("Run to time in seconds").fill(str(target))
    tab.get_by_role("button", name="Go").click()
    it.frames(lambda: not it.twin.paused)
    it.frames(lambda: it.twin.paused)
    assert it.twin.time == pytest.approx(target)


def test_reset_goes_back_to_the_start(page):
    it, tab = page
    it.frames(lambda: it.twin.time > 0.3)
    it.twin.pause()
    tab.get_by_role("button", name="Reset").click()
    it.frames(lambda: it.twin.time == 0)
    it.seen(tab.locator("#time"), "0.000 s")


def test_the_speed_slider_sets_the_real_time_rate(page):
    it, tab = page
    number = tab.get_by_label("Real-time rate, number")
    number.fill("0.5")
    number.press("Enter")
    it.frames(lambda: it.twin.real_time_rate == 0.5)
    tab.get_by_label("Real-time rate", exact=True).press("End")
    it.frames(lambda: it.twin.real_time_rate == 10)
    tab.get_by_label("Real-time rate", exact=True).press("Home")
    it.frames(lambda: it.twin.real_time_rate == 0.1)


def test_the_physics_step_is_a_slider_with_the_real_time_factor_beside_it(page):
    it, tab = page
    number = tab.get_by_label("Physics step, number")
    if not hasattr(it.twin, "set_time_step"):
        it.frames(lambda: number.is_disabled())
        return
    number.fill("10")
    number.press("Enter")
    it.frames(lambda: it.twin.scenario.time_step == 0.01)
    it.frames(lambda: tab.locator("#factor-beside").inner_text() not in ("–", "paused"))
    tab.get_by_label("Physics step", exact=True).press("Home")
    it.frames(lambda: it.twin.scenario.time_step == 0.0001)


# --- robots


def test_a_joint_slider_commands_that_joint_by_number_and_by_mouse(page):
    it, tab = page
    number = folder(tab).get_by_label("rear_left_wheel_joint velocity, number")
    number.fill("3")
    number.press("Enter")
    it.frames(lambda: it.twin.command(WHEELS_1) is not None and it.twin.command(WHEELS_1).data[2] == 3.0)
    it.frames(lambda: abs(it.twin.robot_state("robot_1").velocities[2] - 3.0) < 0.05)
    slider = folder(tab).get_by_label("front_left_wheel_joint velocity", exact=False).first
    box = slider.bounding_box()
    tab.mouse.move(box["x"] + 0.5 * box["width"], box["y"] + 0.5 * box["height"])
    tab.mouse.down()
    tab.mouse.move(box["x"] + 0.9 * box["width"], box["y"] + 0.5 * box["height"], steps=5)
    tab.mouse.up()
    it.frames(lambda: it.twin.command(WHEELS_1).data[0] > 5.0)
    assert it.twin.command(WHEELS_1).data[2] == 3.0
    assert it.twin.command(WHEELS_1.replace("1", "2")) is None


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
    it.frames(lambda: it.twin.command(TRAJECTORY) is not None)
    it.frames(lambda: abs(it.twin.robot_state("arm").positions[1] - 0.3) < 0.02)


def test_a_controllers_switch_deactivates_and_activates_it(page):
    it, tab = page
    manager = it.twin.controller_manager("robot_1")
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
    for column, value in enumerate((state.positions[2], state.velocities[2])):
        it.frames(
            lambda column=column, value=value: float(row.locator("td").nth(column).inner_text()) == round(value, 4)
        )
    it.frames(lambda: float(row.locator("td").nth(2).inner_text()) == round(state.efforts[2], 3))


def test_the_joint_states_are_plotted_while_the_plots_are_open(page):
    it, tab = page
    plots = folder(tab).locator(".plots")
    it.twin.publish(WHEELS_1, [2, 2, 7, 2])
    it.frames(lambda: it.twin.time > 0.5)
    assert plots.locator("canvas").first.get_attribute("width") is None  # nothing is drawn that nobody looks at
    plots.locator("summary").click()
    velocity = plots.locator("figure").nth(1)
    it.seen(velocity.locator(".plot-upper"), "7.00")
    it.seen(velocity.locator(".plot-lower"), "2.00")
    it.twin.publish(WHEELS_1, [-4, 2, 7, 2])
    it.frames(lambda: float(velocity.locator(".plot-lower").inner_text()) < -3.9)
    shot = np.asarray(Image.open(io.BytesIO(velocity.locator("canvas").screenshot())).convert("RGB")).astype(int)
    red, green, blue = shot[..., 0], shot[..., 1], shot[..., 2]
    second, _ = np.nonzero((red > green + 40) & (green > blue + 20))  # orange
    third, _ = np.nonzero((green > red + 40) & (green > blue + 20))
    assert len(second) > 50
    assert len(third) > 50
    assert second.min() > third.max()  # 2 rad/s lies below 7 rad/s
    it.twin.reset()
    it.frames(lambda: float(velocity.locator(".plot-upper").inner_text()) < 0.1)  # what was before is gone


def test_the_real_time_factor_is_plotted(page):
    it, tab = page
    tab.locator("#factor-plot summary").click()
    upper = tab.locator("#factor-plot .plot-upper")
    it.frames(lambda: upper.inner_text() != "" and float(upper.inner_text()) > 0.1)


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


# --- driving


@pytest.fixture
def driven(show, tmp_path):
    return show(driven_rovers(tmp_path, 2).scenario())


def forward_speed(it):
    return it.twin.command(CMD_VEL) and it.twin.command(CMD_VEL).linear_x


def test_keys_drive_the_chosen_robot_and_letting_go_stops_it(driven):
    it, tab = driven
    tab.keyboard.down("w")
    it.for_frames(10)
    assert it.twin.command(CMD_VEL) is None  # no robot is chosen
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
    it.frames(lambda: it.twin.command(CMD_VEL) is not None and it.twin.command(CMD_VEL).angular_z == 1.0)
    tab.keyboard.up("ArrowLeft")
    it.frames(lambda: it.twin.command(CMD_VEL) is None or it.twin.command(CMD_VEL).angular_z == 0.0)
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
    it.frames(lambda: forward_speed(it) == 0.5 and it.twin.command(CMD_VEL).angular_z == -0.5)
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


# --- view


@pytest.mark.parametrize(
    ("label", "path"),
    [
        ("Frames (tf)", "frames"),
        ("Contact forces", "contact"),
        ("Collision shapes", "collision"),
        ("Inertia", "inertia"),
    ],
)
def test_an_overlay_is_drawn_and_taken_away(page, label, path):
    it, tab = page
    it.frames(lambda: it.twin.time > 0.3)
    it.twin.pause()
    it.for_frames(3)
    before = picture(tab)
    tab.get_by_label(label).click(force=True)
    it.frames(lambda: it.scene.has_path(f"{OVERLAYS}/{path}"))
    it.for_frames(5)
    assert changed(before, picture(tab)) > 200
    tab.get_by_label(label).click(force=True)
    it.frames(lambda: not it.scene.has_path(f"{OVERLAYS}/{path}"))
    it.for_frames(5)
    assert changed(before, picture(tab)) < 20


def test_the_camera_follows_a_robot_and_lets_it_go(page):
    it, tab = page
    tab.get_by_label("Camera follows").select_option("robot_1")
    it.frames(lambda: it.cockpit._camera.robot == "robot_1")
    it.twin.publish(WHEELS_1, [9, 9, 9, 9])
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 2.0)
    it.twin.pause()
    it.for_frames(5)
    shot = picture(tab)
    rows, columns = orange(shot)
    assert abs(np.median(columns) / shot.shape[1] - 0.5) < 0.1
    assert abs(np.median(rows) / shot.shape[0] - 0.5) < 0.15
    tab.get_by_label("Camera follows").select_option("")
    it.frames(lambda: it.cockpit._camera.robot == "")


def test_a_recording_is_downloaded_and_plays_without_a_network(show, browser, tmp_path):
    it, tab = show(demo_scenario("rover", 1))
    tab.get_by_role("button", name="Record").click()
    it.frames(lambda: tab.locator("#recording-badge").is_visible())
    start = it.twin.time
    it.frames(lambda: it.twin.time > start + 1)
    with tab.expect_download() as download:
        tab.get_by_role("button", name="Save as HTML").click()
        it.frames(lambda: it.cockpit._recording is None)
        it.for_frames(5)  # the page is told, and fetches it
    file = tmp_path / "run.html"
    download.value.save_as(file)
    offline = browser.new_context(offline=True)
    alone = offline.new_page()
    alone.goto(file.as_uri())
    assert alone.locator("#meshcat-pane canvas").count() == 1
    assert orange_bodies(np.asarray(Image.open(io.BytesIO(alone.screenshot())).convert("RGB")).astype(int)) == 1
    offline.close()
    it.frames(lambda: it.twin.time > start + 1.5)  # the live page goes on


def test_the_side_panel_is_folded_away(page):
    _, tab = page
    tab.get_by_label("Side panel").click()
    assert not tab.locator("#panel").is_visible()
    assert tab.get_by_label("Side panel").get_attribute("aria-expanded") == "false"
    tab.keyboard.press("p")
    assert tab.locator("#panel").is_visible()


def test_messages_are_on_a_line_and_all_of_them_in_a_list(page):
    it, tab = page
    it.twin.controller_manager("robot_1").switch_controller(deactivate=["forward_velocity_controller"])
    it.twin.publish(WHEELS_1, [1, 1, 1, 1])
    it.frames(lambda: "nobody hears this" in tab.locator("#message-text").inner_text())
    tab.locator("#messages-toggle").click()
    assert "nobody hears this" in tab.locator("#messages li").last.inner_text()


def test_what_is_refused_is_said(page):
    it, tab = page
    it.frames(lambda: it.twin.time > 0.1)
    tab.get_by_label("Run to time in seconds").fill("0.0001")
    tab.get_by_role("button", name="Go").click()
    it.frames(lambda: "lies in the past" in tab.locator("#message-text").inner_text())


# --- robots come and go


def test_a_robot_is_spawned_from_the_dialog_and_deleted_with_its_controls(page):
    it, tab = page
    if not hasattr(it.twin, "spawn"):
        assert not tab.get_by_role("button", name="Spawn…").is_visible()
        pytest.skip("this twin cannot spawn")
    tab.get_by_role("button", name="Spawn…").click()
    tab.get_by_label("Robot file").fill(ROVER)
    assert tab.get_by_label("Name").input_value() == "robot_3"
    tab.get_by_label("x m", exact=True).fill("2")
    tab.get_by_label("z m", exact=True).fill("0.13")
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


# --- tabs


def test_two_tabs_steer_one_twin_and_reloading_or_closing_one_changes_nothing(page):
    it, one = page
    other = it.tab()
    one.get_by_role("button", name="Pause").click()
    it.frames(lambda: it.twin.paused)
    it.frames(lambda: other.get_by_role("button", name="Play", exact=True).count() == 1)
    other.get_by_role("button", name="Play", exact=True).click()
    it.frames(lambda: not it.twin.paused)
    start = it.twin.time
    one.reload()
    it.frames(lambda: one.locator("body.ready").count() == 1)
    it.frames(lambda: it.twin.time > start + 0.2)
    other.close()
    it.tabs.remove(other)
    it.frames(lambda: len(it.served.server.clients) == 1)
    start = it.twin.time
    it.frames(lambda: it.twin.time > start + 0.2)
    one.get_by_role("button", name="Pause").click()
    it.frames(lambda: it.twin.paused)


def test_a_page_whose_twin_has_ended_says_so(page):
    it, tab = page
    it.served.server.close()
    tab.locator("#connection").wait_for(state="visible")
    assert "open the address that it printed" in tab.locator("#connection").inner_text()
    assert tab.locator("#stop-all").evaluate("node => node.inert")
    assert tab.locator("#panel").evaluate("node => node.inert")
    tab.keyboard.press("Space")
    assert "did not reach it" in tab.locator("#connection").inner_text()
    it.faults.clear()  # the browser's own lines about attempts to connect again


def test_a_stop_is_red_until_the_twin_has_confirmed_it(page):
    it, tab = page
    tab.get_by_role("button", name="Stop all").click()
    assert "waiting" in tab.locator("#stop-all").get_attribute("class")  # the twin's thread is not at work
    it.frames(lambda: all(it.twin.is_stopped(robot) for robot in it.twin.robots))
    it.frames(lambda: "waiting" not in (tab.locator("#stop-all").get_attribute("class") or ""))


def test_a_twin_that_is_busy_is_said_to_be(page):
    it, tab = page
    tab.locator("#connection", has_text="busy for").wait_for(state="visible")  # nobody calls obey
    it.frames(lambda: not tab.locator("#connection").is_visible())


# --- robots that are only displayed


def test_a_robot_that_is_only_displayed_has_joint_sliders_and_no_time(show):
    it, tab = show(TwinBuilder().robot("arm", ARM).scenario(), only_displayed=True)
    number = folder(tab, "arm").get_by_label("arm joint_4 position, number")
    number.fill("0.3")
    number.press("Enter")
    it.frames(lambda: it.twin.robot_state("arm").positions[-2:] == pytest.approx((0.3, -0.3)))
    assert it.twin.time == 0
    assert not tab.get_by_role("button", name="Play").is_visible()
    assert folder(tab, "arm").get_by_label("arm joint_5 position").count() == 0  # which follows
