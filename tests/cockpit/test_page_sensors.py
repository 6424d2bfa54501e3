"""The panel of sensors in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, changed, open_tab, picture, show
from seeing_robot import seeing
from show_menu import press

from drake_twin import messages
from drake_twin.cockpit.scene import OVERLAYS

pytestmark = BROWSER_TESTS

PIXELS = """canvas => {
  const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
  return [0, 1, 2].map((channel) => data.filter((_, index) => index % 4 === channel).reduce((a, b) => a + b, 0));
}"""


def test_a_scan_is_drawn_and_taken_away(show, tmp_path):
    it, tab = show(seeing(tmp_path).scenario())
    open_tab(tab, "Sensors")
    switch = tab.get_by_label("Show box_0's lidar")
    switch.click(force=True)
    it.frames(lambda: it.scene.has_path(f"{OVERLAYS}/measured"))
    switch.click(force=True)
    it.frames(lambda: not it.scene.has_path(f"{OVERLAYS}/measured"))


def test_numbers_are_plotted_while_they_are_shown(show, tmp_path):
    it, tab = show(seeing(tmp_path).scenario())
    open_tab(tab, "Sensors")
    switch, plots = tab.get_by_label("Show box_0's imu"), tab.locator("#sensors .plot")
    switch.click(force=True)
    it.frames(lambda: plots.count() == 3)
    switch.click(force=True)
    it.frames(lambda: plots.count() == 0)


def test_a_picture_is_a_tile(show, tmp_path):
    it, tab = show(seeing(tmp_path).scenario())
    it.twin.pause()  # the camera takes no picture of its own
    it.for_frames(3)
    key, topic = "box_0/box/camera", "/box_0/camera"
    open_tab(tab, "Sensors")
    tab.get_by_label("Show box_0's camera").click(force=True)
    it.frames(lambda: key in it.cockpit.sensors.state())
    it.for_frames(5)
    red = np.zeros((480, 640, 3), dtype=np.uint8)
    red[..., 0] = 200
    message = messages.Image(messages.header(0.0, "f"), 480, 640, "rgb8", 0, 1920, red.ravel())
    it.cockpit.sensors._shown[key]._picture(topic, message)
    tile = tab.locator("#sensors .picture canvas")
    it.frames(lambda: tile.count() == 1)
    assert tile.evaluate("canvas => [canvas.width, canvas.height]") == [320, 240]
    assert tile.evaluate(PIXELS) == [200 * 320 * 240, 0, 0]


def ends(locator):
    """The numbers at the ends of a bar of colors."""
    return [float(text.removesuffix(" m")) for text in locator.locator("output").all_inner_texts()]


def test_the_bar_of_a_depth_picture_has_the_ends_that_drake_has_drawn(show, tmp_path):
    it, tab = show(seeing(tmp_path, camera="rgbd_camera").scenario())
    if it.twin.sensor("box_0", "camera").depth is None:
        pytest.skip("pictures need Mesa: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri")
    tab.get_by_label("Show box_0's camera").click(force=True)
    figure = tab.locator("#sensors figure", has_text="depth_image")
    bar = figure.locator(".color-bar")
    it.frames(lambda: figure.count() == 1 and bar.is_visible())
    it.twin.pause()  # the robot stands still
    depth = it.twin.sensor("box_0", "camera").depth
    known = depth[np.isfinite(depth)]
    it.frames(lambda: ends(bar) == pytest.approx([known.min(), known.max()], abs=0.01))
    assert known.max() > known.min() + 0.1
    assert "640 × 480, 32FC1, 10 Hz" in figure.inner_text()
    assert bar.locator("span").get_attribute("aria-label").startswith("Colors: depth, from ")
    color = tab.locator("#sensors figure", has_text="/box_0/camera/image")
    assert not color.locator(".color-bar").is_visible()
    assert "640 × 480, rgb8, 10 Hz" in color.inner_text()


def test_the_points_of_a_scan_are_colored_by_what_is_chosen(show, tmp_path):
    it, tab = show(seeing(tmp_path).scenario())
    tab.get_by_label("Show box_0's lidar").click(force=True)
    choice = tab.get_by_label("What colors the points of box_0's lidar")
    bar = tab.locator("#sensors .colors .color-bar").first
    it.frames(lambda: choice.is_visible() and bar.is_visible())
    ranges = it.twin.sensor("box_0", "lidar").ranges
    it.frames(lambda: ends(bar) == pytest.approx([ranges.min(), ranges.max()], abs=2e-3))
    choice.press("ArrowDown")
    it.frames(lambda: it.cockpit.sensors.state()["box_0/box/lidar"]["colored_by"] == "height")
    other = it.tab()
    it.frames(lambda: other.get_by_label("What colors the points of box_0's lidar").input_value() == "height")
    other.get_by_label("What colors the points of box_0's lidar").select_option("one color")
    it.frames(lambda: not bar.is_visible())


def test_the_views_of_sensors_are_lines(show, tmp_path):
    it, tab = show(seeing(tmp_path).scenario())
    it.twin.pause()
    before = picture(tab)
    press(tab, "Sensors' views")
    it.frames(lambda: it.scene.has_path(f"{OVERLAYS}/sensors"))
    it.frames(lambda: changed(before, picture(tab)) > 100, most=200)
