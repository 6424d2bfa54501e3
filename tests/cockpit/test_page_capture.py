"""Pictures, videos and distances on the page, in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import base64
import io

import numpy as np
import pytest
from browser import BROWSER_TESTS, PIXELS, browser, draw, open_tab, orange, show
from conftest import rovers
from in_scene import look_at, place_of, tools
from PIL import Image

pytestmark = BROWSER_TESTS

KEEP = """() => {
  window.saved = [];
  URL.createObjectURL = (blob) => {
    const reader = new FileReader();
    reader.onload = () => window.saved.push(reader.result);
    reader.readAsDataURL(blob);
    return "data:,";
  };
  HTMLAnchorElement.prototype.click = function () { window.savedName = this.download; };
  window.recorded = 0;
  const start = MediaRecorder.prototype.start;
  MediaRecorder.prototype.start = function (...args) {
    this.addEventListener("dataavailable", ({ data }) => { window.recorded += data.size; });
    start.apply(this, args);
  };
}"""


@pytest.fixture
def page(show):
    it, tab = show(rovers(1).scenario())
    it.twin.pause()
    it.for_frames(5)
    look_at(tab, "robot_1")
    draw(tab)
    tab.evaluate(KEEP)
    open_tab(tab, "View")
    return it, tab


def saved(it, tab):
    it.frames(lambda: tab.evaluate("window.saved.length") == 1)
    head, _, data = tab.evaluate("window.saved[0]").partition(",")
    return head, base64.b64decode(data)


def test_a_picture_is_what_the_scene_shows(page):
    it, tab = page
    tab.get_by_role("button", name="Picture", exact=True).click()
    head, data = saved(it, tab)
    assert head.startswith("data:image/png")
    assert tab.evaluate("window.savedName") == "drake_twin.png"
    shot = np.asarray(Image.open(io.BytesIO(data)).convert("RGB")).astype(int)
    box = tab.locator("#scene").bounding_box()
    assert shot.shape[:2] == pytest.approx((PIXELS * box["height"], PIXELS * box["width"]), abs=1)
    assert len(orange(shot)[0]) > 1000


def test_a_video_is_recorded(page):
    it, tab = page
    tab.get_by_role("button", name="Video").click()
    it.twin.play()
    it.frames(lambda: tab.evaluate("window.recorded") > 1000)  # a busy machine encodes its first picture late
    tab.get_by_role("button", name="End video").click()
    head, data = saved(it, tab)
    assert head.startswith("data:video/")
    assert len(data) > 1000
    assert tab.get_by_role("button", name="Video", exact=True).count() == 1


def test_a_distance_is_measured_between_two_points(page):
    it, tab = page
    tools(tab, "fit(['robot_1'], [0, 0, 1])")
    it.for_frames(3)
    tab.get_by_role("button", name="Measure").click()
    text = tab.locator("#capture output")
    for point in ((0.5, 0.0, 0.0), (0.5, 0.4, 0.0)):
        tab.mouse.click(*place_of(tab, point))
        it.for_frames(2)
    it.frames(lambda: " m (" in text.inner_text())
    assert float(text.inner_text().split()[0]) == pytest.approx(0.4, abs=0.01)
    tab.get_by_role("button", name="Measure").click()
    it.frames(lambda: text.inner_text() == "")
    assert tools(tab, "clickOwner") is None
    assert tools(tab, "line") is None


def test_a_click_has_one_taker_and_who_loses_it_is_told(page):
    it, tab = page
    measure = tab.get_by_role("button", name="Measure")
    measure.click()
    open_tab(tab, "Robots")
    tab.get_by_role("button", name="Spawn…").click()
    tab.get_by_role("button", name="Click in the scene…").click()
    open_tab(tab, "View")
    assert measure.get_attribute("aria-pressed") == "false"
    assert tab.locator("#capture output").inner_text() == ""
    measure.click()  # the dialog has lost the click, and is back
    it.frames(lambda: tab.locator("#spawn-dialog").is_visible())
    tab.get_by_role("button", name="Cancel").click()
    assert measure.get_attribute("aria-pressed") == "true"
    tab.keyboard.press("Escape")
    assert tools(tab, "clickOwner") is None


def test_up_to_four_views_each_with_its_camera(page):
    it, tab = page
    views = tab.locator(".scene iframe")
    button = tab.get_by_role("button", name="Views")
    button.click()
    it.frames(lambda: views.count() == 2)
    button.click()
    it.frames(lambda: views.count() == 4)
    it.twin.play()  # what is drawn comes to all of them
    it.frames(lambda: len(it.served.server._viewers) == 4)
    seen = "frame => frame.contentWindow.sceneTools?.measure(['robot_1'])?.meshes ?? 0"
    it.frames(lambda: all(view.evaluate(seen) > 5 for view in views.all()))
    it.for_frames(30)
    places = [view.evaluate("frame => frame.contentWindow.sceneTools.cameraPlace().join()") for view in views.all()]
    assert len(set(places)) == 4
    boxes = [view.bounding_box() for view in views.all()]
    assert len({(round(box["x"]), round(box["y"])) for box in boxes}) == 4
    button.click()
    it.frames(lambda: views.count() == 1)
