"""The page as a person sees it: a real Chromium, screenshots, clicks."""

import io
import shutil

import numpy as np
import pytest
from drake_twin.cockpit.panel import PLAY_PAUSE, RESET, STEP, Panel
from PIL import Image

from drake_twin import Twin
from drake_twin.cockpit.page import open_meshcat, set_scene
from drake_twin.launch.demo import demo_scenario

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


@pytest.fixture
def cockpit(browser):
    """A twin with two driving rovers, its panel, and the page that shows them."""
    meshcat = open_meshcat()
    twin = Twin(demo_scenario("rover", 2), meshcat)
    set_scene(meshcat, twin)
    panel = Panel(meshcat, twin)
    twin.draw()
    page = browser.new_page(viewport={"width": 1000, "height": 640})
    page.goto(meshcat.web_url())
    frames(twin, panel, until=lambda: meshcat.GetNumActiveConnections() > 0)
    yield twin, panel, page
    page.close()


def frames(twin, panel, until, most=600):
    """Runs frame by frame, as the program does, until something holds."""
    count = 0

    def each_frame():
        nonlocal count
        count += 1
        panel.obey()
        return not until() and count < most

    twin.run(each_frame=each_frame)
    assert until(), f"not within {most} frames"


def screenshot(page):
    page.wait_for_timeout(500)  # the page draws when the browser gets to it, and says nothing about it
    return np.asarray(Image.open(io.BytesIO(page.screenshot())).convert("RGB")).astype(int)


def orange_bodies(picture):
    """How many groups of columns, 30 pixels or more apart, hold the orange of a rover's body."""
    red, green, blue = picture[..., 0], picture[..., 1], picture[..., 2]
    columns = np.flatnonzero(((red > 130) & (red > 1.6 * green) & (green > 1.5 * blue)).sum(axis=0) > 2)
    return 1 + int((np.diff(columns) >= 30).sum()) if len(columns) else 0


def controls(page):
    page.get_by_text("Open Controls").click()
    return page


def test_the_page_shows_both_rovers_and_they_drive(cockpit):
    twin, panel, page = cockpit
    frames(twin, panel, until=lambda: twin.time > 0.3)
    before = screenshot(page)
    assert orange_bodies(before) == 2
    start = twin.time
    frames(twin, panel, until=lambda: twin.time > start + 1.0)
    after = screenshot(page)
    assert orange_bodies(after) == 2
    assert (np.abs(after - before).sum(axis=2) > 60).sum() > 1000  # pixels that changed


def test_the_pause_button_pauses_and_goes_on(cockpit):
    twin, panel, page = cockpit
    controls(page).get_by_text(PLAY_PAUSE).click()
    frames(twin, panel, until=lambda: twin.paused)
    stopped = twin.time
    seen = []
    frames(twin, panel, until=lambda: seen.append(twin.time) or len(seen) > 10)
    assert set(seen) == {stopped}
    page.get_by_text(PLAY_PAUSE).click()
    frames(twin, panel, until=lambda: twin.time > stopped + 0.1)


def test_the_step_and_reset_buttons_work(cockpit):
    twin, panel, page = cockpit
    controls(page).get_by_text(STEP, exact=True).click()
    frames(twin, panel, until=lambda: twin.paused)
    before = twin.step_count
    page.get_by_text(STEP, exact=True).click()
    frames(twin, panel, until=lambda: twin.step_count == before + 1)
    page.get_by_text(RESET, exact=True).click()
    frames(twin, panel, until=lambda: twin.time == 0)


def test_a_joint_slider_moved_in_the_page_commands_that_joint(cockpit):
    twin, panel, page = cockpit
    controls(page)
    row = page.locator(".number", has_text="robot_1/rear_left").first
    row.locator("input").fill("3")
    row.locator("input").press("Enter")
    topic = "/robot_1/forward_velocity_controller/commands"
    frames(twin, panel, until=lambda: twin.command(topic) is not None and twin.command(topic).data[2] == 3.0)
    frames(twin, panel, until=lambda: abs(twin.robot_state("robot_1").velocities[2] - 3.0) < 0.05)
