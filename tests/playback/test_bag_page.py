"""All that a bag holds on the page, and two runs laid over each other, in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import csv
import io
import sys
from pathlib import Path

import numpy as np
import pytest

sys.path.append(str(Path(__file__).resolve().parents[1] / "cockpit"))

from browser import BROWSER_TESTS, browser, open_tab
from conftest import rovers
from playback.recorded_bags import cart_messages, record, write
from played_bag import Played
from rosbags.highlevel import AnyReader

from drake_twin.messages import Header, Image, LaserScan, time_message
from drake_twin.messages.interface_types import make

pytestmark = BROWSER_TESTS

STATES = "/robot_1/joint_states"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
WHEEL = "robot_1_rear_left_wheel_joint"
LINE = """async () => {
  const { plot } = (await import("./plots.js")).plots.figures[0];
  return plot.shownLine.hidden ? null : plot.timeAt(parseFloat(plot.shownLine.style.left));
}"""
X_OF = """async (time) => {
  const { plot } = (await import("./plots.js")).plots.figures[0];
  return plot.uplot.over.getBoundingClientRect().left + plot.uplot.valToPos(time, "x");
}"""
CURVES = """async () => {
  const { plot } = (await import("./plots.js")).plots.figures[0];
  return [...plot.curves.values()].map(({ times, values }) => [times, values]);
}"""
ADD = "async (path) => { (await import('./plots.js')).plots.add(path); }"


@pytest.fixture
def play(browser):
    played = []

    def play_(folder):
        played.append(Played(browser, folder))
        return played[-1]

    yield play_
    for it in played:
        it.close()


@pytest.fixture(scope="module")
def bags(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bags")
    for name, speed in (("first", 2.0), ("same", 2.0), ("other", 3.0)):
        record(rovers(1).command(COMMANDS, [2.0, 2.0, speed, 2.0]).build(), folder / name, 2.0)
    return folder


def recorded(folder, number):
    """The times (s) and numbers of the messages of a bag, by rosbags."""
    with AnyReader([folder]) as reader:
        own = [item for item in reader.connections if item.topic == STATES]
        found = []
        for connection, time, data in reader.messages(own):
            found.append(((time - reader.start_time) * 1e-9, number(reader.deserialize(data, connection.msgtype))))
    return np.array(found)


def speed_of_wheel(message):
    return message.velocity[message.name.index(WHEEL)]


def test_a_curve_of_the_whole_bag_is_saved_as_the_messages_are(play, bags):
    it = play(bags / "first")
    it.tab.evaluate(ADD, f"{STATES}.velocity[{WHEEL}]")
    it.frames(lambda: it.tab.locator("#plots .legend .unit").all_inner_texts() == ["rad/s"])
    with it.tab.expect_download() as download:
        it.tab.get_by_role("button", name="Save the numbers as a table (CSV)").press("Enter")
    head, *rows = csv.reader(io.StringIO(download.value.path().read_text()))
    assert head == ["time [s]", f"{STATES}.velocity[{WHEEL}] [rad/s]"]
    np.testing.assert_allclose(np.array(rows, dtype=float), recorded(bags / "first", speed_of_wheel), atol=1e-9, rtol=0)


def test_plots_slider_and_bag_show_one_time(play, bags):
    it = play(bags / "first")
    it.tab.evaluate(ADD, f"{STATES}.velocity[{WHEEL}]")
    it.frames(lambda: it.tab.locator("#plots canvas").count() == 1)
    it.frames(lambda: it.tab.locator("#plots .legend .unit").all_inner_texts() == ["rad/s"])
    area = it.tab.locator("#plots .u-over").bounding_box()
    it.tab.mouse.click(it.tab.evaluate(X_OF, 1.25), area["y"] + 40)
    it.frames(lambda: it.player.time == pytest.approx(1.25, abs=0.02))
    it.frames(lambda: it.tab.evaluate(LINE) == pytest.approx(it.player.time, abs=0.02))
    it.tab.mouse.move(5, 5)
    slider = it.tab.get_by_label("Time to look at")
    slider.press("Home")
    it.frames(lambda: it.tab.evaluate(LINE) == pytest.approx(0.0, abs=0.02))
    it.tab.get_by_role("button", name="One picture on").press("Enter")
    it.frames(lambda: it.player.time == pytest.approx(1 / 30))
    it.tab.locator("body").press("Shift+N")
    it.frames(lambda: it.player.time == 0.0)


def test_a_bag_plays_in_a_loop(play, bags):
    it = play(bags / "first")
    it.tab.get_by_role("button", name="Begin again at the end").press("Enter")
    it.frames(lambda: it.player.loop)
    it.tab.get_by_role("button", name="Play", exact=True).press("Enter")
    it.frames(lambda: it.player.time > 1.5)
    it.frames(lambda: it.player.time < 0.5)
    assert not it.player.paused


def seen_messages():
    """A cart with a camera, a lidar and a log."""
    yield from cart_messages()
    for index in range(20):
        header = Header(time_message(index / 10), "base")
        shade = np.full((4, 6, 3), 10 * index, np.uint8)
        yield "/camera", "sensor_msgs/msg/Image", index / 10, Image(header, 4, 6, "rgb8", 0, 18, shade.ravel())
    scan = LaserScan(
        Header(time_message(0.0), "base"),
        0.0,
        1.0,
        0.5,
        0.0,
        0.0,
        0.1,
        9.0,
        np.array([1.0, 2.0, 3.0], np.float32),
        np.zeros(0, np.float32),
    )
    yield "/scan", "sensor_msgs/msg/LaserScan", 0.5, scan
    log = {"level": 30, "name": "driver", "msg": "it is hot"}
    yield "/rosout", "rcl_interfaces/msg/Log", 1.2, make("rcl_interfaces/msg/Log", log)


SHADE = "(canvas) => canvas.getContext('2d').getImageData(1, 1, 1, 1).data[0]"


def test_pictures_rays_and_logs_follow_the_bag(play, tmp_path):
    it = play(write(tmp_path / "bag", sorted(seen_messages(), key=lambda item: item[2])))
    open_tab(it.tab, "Sensors")
    it.tab.get_by_role("switch", name="camera").press("Space")
    it.tab.get_by_role("switch", name="scan").press("Space")
    canvas = it.tab.locator("#sensors canvas")
    it.frames(lambda: canvas.count() == 1 and canvas.evaluate(SHADE) == 0)
    assert not it.scene.has_path("/overlays/measured/scan")
    it.tab.locator("#messages-toggle").press("Enter")
    row = it.tab.locator("#messages li", has_text="driver: it is hot")
    it.frames(lambda: row.count() == 1 and "later" in row.get_attribute("class"))
    row.get_by_role("button").press("Enter")
    it.frames(lambda: it.player.time == pytest.approx(1.2))
    it.frames(lambda: canvas.evaluate(SHADE) == 120)
    it.frames(lambda: it.scene.has_path("/overlays/measured/scan"))
    it.frames(lambda: "later" not in (row.get_attribute("class") or ""))


def test_another_bag_is_laid_over_it(play, bags):
    it = play(bags / "first")
    it.tab.evaluate(ADD, f"{STATES}.velocity[{WHEEL}]")
    open_tab(it.tab, "Time")
    folder = it.tab.get_by_label("Bag to compare with")
    dashed = it.tab.locator("#plots .legend .dash.like")
    status = it.tab.locator(".compare-panel [role=status]")
    found = it.tab.locator(".differences tbody tr")
    for name, rows in (("same", 0), ("other", 8)):
        folder.fill(str(bags / name))
        folder.press("Enter")
        it.frames(lambda: dashed.count() == 1)
        it.frames(lambda: "that both have" in status.inner_text())
        it.frames(lambda rows=rows: (found.count() > rows) == (rows > 0))
        assert status.inner_text().startswith("No difference") == (rows == 0)
        if name == "other":
            break
        it.tab.get_by_role("button", name="End the comparison").press("Enter")
        it.frames(lambda: dashed.count() == 0)
    own, beside = (np.array(curve).T for curve in it.tab.evaluate(CURVES))
    np.testing.assert_allclose(own, recorded(bags / "first", speed_of_wheel), atol=1e-9, rtol=0)
    np.testing.assert_allclose(beside, recorded(bags / "other", speed_of_wheel), atol=1e-9, rtol=0)
    found.first.get_by_role("button").press("Enter")
    it.frames(lambda: it.player.time > 0.01)
    folder = it.tab.get_by_role("button", name="End the comparison")
    folder.press("Enter")
    it.frames(lambda: not it.scene.has_path("/compared"))


def test_what_cannot_be_compared_is_said(play, bags, tmp_path):
    it = play(bags / "first")
    open_tab(it.tab, "Time")
    it.tab.get_by_label("Bag to compare with").fill(str(tmp_path / "nothing"))
    it.tab.get_by_role("button", name="Lay over").press("Enter")
    it.frames(lambda: "the bag does not exist" in it.tab.locator(".compare-panel [role=alert]").inner_text())
