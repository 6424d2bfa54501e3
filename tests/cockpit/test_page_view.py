"""The scene, overlays, camera and recording on the page, in a real Chromium."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import io

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, changed, open_tab, orange, orange_bodies, page, picture, show
from PIL import Image
from playwright.sync_api import expect
from robots_to_steer import WHEELS_1
from show_menu import press
from show_menu import switch as show_switch

from drake_twin.builder.demo import demo_scenario
from drake_twin.cockpit.scene import OVERLAYS

pytestmark = BROWSER_TESTS


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


def test_each_overlay_is_drawn_and_taken_away(page):
    it, tab = page
    it.frames(lambda: it.twin.time > 0.3)
    it.twin.pause()
    it.for_frames(3)
    before = picture(tab)
    open_tab(tab, "View")
    overlays = {
        "Frames (tf)": "frames",
        "Contact forces": "contacts",
        "Collision shapes": "collision",
        "Inertia": "inertia",
    }
    for label, path in overlays.items():
        press(tab, label)
        it.frames(lambda path=path: it.scene.has_path(f"{OVERLAYS}/{path}"))
        it.frames(lambda: changed(before, picture(tab)) > 200, most=200)
        press(tab, label)
        it.frames(lambda path=path: not it.scene.has_path(f"{OVERLAYS}/{path}"))
        it.frames(lambda: changed(before, picture(tab)) < 20, most=200)


def test_the_camera_follows_a_robot_and_lets_it_go(page):
    it, tab = page
    open_tab(tab, "View")
    tab.get_by_label("Camera follows").select_option("robot_1")
    it.frames(lambda: it.cockpit._camera.robot == "robot_1")
    it.twin.publish(WHEELS_1, [9, 9, 9, 9])
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 2.0)
    it.twin.pause()

    def is_in_the_middle():
        shot = picture(tab)
        rows, columns = orange(shot)
        is_across = abs(np.median(columns) / shot.shape[1] - 0.5) < 0.1
        return is_across and abs(np.median(rows) / shot.shape[0] - 0.5) < 0.15

    it.frames(is_in_the_middle, most=200)
    tab.get_by_label("Camera follows").select_option("")
    it.frames(lambda: it.cockpit._camera.robot == "")


@pytest.mark.parametrize("browser", ["chromium"], indirect=True)  # Playwright hears of no download in this Firefox
def test_a_recording_is_downloaded_and_plays_without_a_network(show, browser, tmp_path):
    it, tab = show(demo_scenario("rover", 1))
    open_tab(tab, "View")
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


def test_a_switch_keeps_what_was_pressed_until_the_twin_has_heard_of_it(page):
    it, tab = page
    switch = show_switch(tab, "Contact forces")
    switch.click(force=True)
    it.cockpit.publish(7.77)  # a state from before the request
    expect(tab.locator("#factor")).to_have_text("7.77")
    assert switch.is_checked()
    assert it.cockpit._overlays == {}
    it.frames(lambda: len(it.cockpit._overlays) == 1)
    switch.click(force=True)
    it.frames(lambda: it.cockpit._overlays == {} and not switch.is_checked())
