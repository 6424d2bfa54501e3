"""One time on the page: the timeline, plots and messages show the same moment. Plots are saved as files."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import csv
import io

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, folder, show
from conftest import rovers
from PIL import Image
from rosbags.highlevel import AnyReader

from drake_twin.wires.bag_wire import BagWire
from drake_twin.wires.seam import Seam

pytestmark = BROWSER_TESTS

STATES = "/robot_1/joint_states"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
WHEEL = "robot_1_front_left_wheel_joint"
LINES = """async () => {
  const { plots } = await import("./plots.js");
  return plots.figures.map(({ plot }) => [plot.shownLine, plot.hoveredLine].map(
    (line) => (line.hidden || !line.isConnected ? null : plot.timeAt(parseFloat(line.style.left)))));
}"""
X_OF = """async (time) => {
  const { plot } = (await import("./plots.js")).plots.figures[0];
  return plot.uplot.over.getBoundingClientRect().left + plot.uplot.valToPos(time, "x");
}"""


@pytest.fixture
def plotted(show):
    """A rover that drives; its wheel's velocity and position are plotted, each in a plot of its own."""
    it, tab = show(rovers(1).command(COMMANDS, [2.0, 2.0, 2.0, 2.0]).scenario())
    folder(tab).locator("summary", has_text="Joint states").click()
    folder(tab).get_by_title(f"Plot the velocity of {WHEEL}").click()
    tab.get_by_role("button", name="New plot").click()
    folder(tab).get_by_title(f"Plot the position of {WHEEL}").click()
    it.frames(lambda: tab.locator("#plots canvas").count() == 2)
    began = it.twin.time
    it.frames(lambda: it.twin.time > began + 2.0)
    return it, tab


def middle(it):
    """A time at which the page drew and plotted."""
    return it.twin.time - 1.0


def closest(it, time):
    """The picture that was drawn closest to a time; a slow machine draws few."""
    return min(it.cockpit._timeline._pictures, key=lambda picture: abs(picture.time - time)).time


def pause(it, tab):
    it.twin.pause()
    heard = it.cockpit.panels["topics"]._heard[STATES]
    drawn = "async () => (await import('./plots.js')).plots.figures[1].plot.bounds()[1]"
    it.frames(lambda: tab.evaluate(drawn) == pytest.approx(heard.time, abs=1e-6))
    it.frames(lambda: tab.locator("#play").get_attribute("aria-label") == "Play")


def saved(it, tab, label):
    with tab.expect_download() as download:
        tab.get_by_role("button", name=label).first.press("Enter")
    return download.value.path().read_bytes()


def test_the_numbers_that_are_saved_are_those_of_a_bag(plotted, tmp_path):
    it, tab = plotted
    seam = Seam(it.twin, [BagWire(tmp_path / "bag")])
    began = it.twin.time
    it.twin.publish(COMMANDS, [5.0, -1.0, 3.0, 0.1])
    it.frames(lambda: it.twin.time > began + 1.0)
    pause(it, tab)
    seam.close()
    head, *rows = csv.reader(io.StringIO(saved(it, tab, "Save the numbers as a table (CSV)").decode()))
    assert head == ["time [s]", f"{STATES}.velocity[{WHEEL}] [rad/s]"]
    sampled = {round(float(time), 6): float(value) for time, value in rows}
    assert [float(time) for time, _ in rows] == sorted(float(time) for time, _ in rows)
    with AnyReader([tmp_path / "bag"]) as reader:
        own = [item for item in reader.connections if item.topic == STATES]
        recorded = {}
        for connection, time, data in reader.messages(own):
            message = reader.deserialize(data, connection.msgtype)
            recorded[round(time * 1e-9, 6)] = message.velocity[message.name.index(WHEEL)]
    common = sorted(sampled.keys() & recorded.keys())
    assert len(common) > 40
    assert [sampled[time] for time in common] == [recorded[time] for time in common]
    inside = [time for time in sampled if min(recorded) <= time <= max(recorded)]
    assert len(common) == len(inside)  # nothing was made up


def test_a_picture_of_the_plot_is_saved(plotted):
    it, tab = plotted
    pause(it, tab)
    shot = np.asarray(Image.open(io.BytesIO(saved(it, tab, "Save a picture of the plot (PNG)"))).convert("RGB"))
    red, green, blue = (shot[..., index].astype(int) for index in range(3))
    assert ((blue > red + 60) & (blue > green + 30)).sum() > 100  # the curve, and its line in the legend
    assert shot[-2, 2].min() > 200  # a background


def test_axis_and_legend_tell_the_unit(plotted):
    _, tab = plotted
    assert tab.locator("#plots .legend .unit").all_inner_texts() == ["rad/s", "rad"]
    labels = "async () => (await import('./plots.js')).plots.figures.map(({ plot }) => plot.uplot.axes[1].label)"
    assert tab.evaluate(labels) == ["rad/s", "rad"]


def test_the_moment_that_is_looked_at_stands_in_all_plots(plotted):
    it, tab = plotted
    pause(it, tab)
    slider = tab.get_by_label("Time to look at")
    slider.evaluate("(slider, time) => { slider.value = time; slider.dispatchEvent(new Event('input')); }", middle(it))
    it.frames(lambda: it.cockpit._timeline._looked is not None)
    looked = it.cockpit._timeline._looked.time
    it.frames(lambda: [line[0] for line in tab.evaluate(LINES)] == pytest.approx([looked, looked], abs=0.02))
    position = "async () => { const c = [...(await import('./plots.js')).plots.figures[1].plot.curves.values()][0];"
    times, values = tab.evaluate(position + " return [c.times, c.values]; }")
    at = np.searchsorted(times, looked + 1e-9) - 1
    it.frames(lambda: float(tab.locator("#plots output").nth(1).inner_text()) == pytest.approx(values[at], abs=1e-4))
    tab.get_by_role("button", name="Back to now").click()
    it.frames(lambda: [line[0] for line in tab.evaluate(LINES)] == [None, None])


def test_a_click_in_a_plot_goes_there_while_time_stands_still(plotted):
    it, tab = plotted
    area = tab.locator("#plots .u-over").first.bounding_box()
    tab.mouse.click(area["x"] + 40, area["y"] + 40)
    it.for_frames(6)
    assert it.cockpit._timeline._looked is None  # it runs
    pause(it, tab)
    clicked = middle(it)
    tab.mouse.click(tab.evaluate(X_OF, clicked), area["y"] + 40)
    it.frames(lambda: it.cockpit._timeline._looked is not None)
    assert it.cockpit._timeline._looked.time == pytest.approx(closest(it, clicked), abs=0.04)
    first = it.cockpit._timeline._pictures[0].time
    it.frames(lambda: tab.locator(".timeline .hovered").count() == 1)

    def share():
        strip = tab.locator(".timeline .marks").bounding_box()  # it is narrower once its buttons have come
        return (tab.locator(".timeline .hovered").bounding_box()["x"] - strip["x"]) / strip["width"]

    it.frames(lambda: share() == pytest.approx((clicked - first) / (it.twin.time - first), abs=0.03))
    strip = tab.locator(".timeline .marks").bounding_box()
    tab.mouse.move(strip["x"] + strip["width"] / 2, strip["y"] + 10)
    half = (it.twin.time + first) / 2
    it.frames(lambda: [line[1] for line in tab.evaluate(LINES)] == pytest.approx([half, half], abs=0.03))
    tab.mouse.move(5, 5)
    it.frames(lambda: [line[1] for line in tab.evaluate(LINES)] == [None, None])


def test_a_message_goes_to_its_moment(plotted):
    it, tab = plotted
    it.cockpit._log.time = when = closest(it, middle(it))
    it.cockpit._log.add("info", "a thing happened")
    it.cockpit._log.time = when + 0.5
    it.cockpit._log.add("info", "a later thing")
    tab.locator("#messages-toggle").click()
    row = tab.locator("#messages li", has_text="a thing happened")
    it.frames(lambda: row.count() == 1)
    row.get_by_role("button").press("Enter")
    it.frames(lambda: it.cockpit._timeline._looked is not None)
    assert it.cockpit._timeline._looked.time == pytest.approx(when, abs=1e-3)
    assert it.twin.clock.paused
    later = tab.locator("#messages li.later")
    it.frames(lambda: any("a later thing" in text for text in later.all_inner_texts()))


def test_the_last_minute_plays_again_by_keyboard(plotted):
    it, tab = plotted
    pause(it, tab)
    timeline = it.cockpit._timeline
    tab.locator("body").press("Shift+N")
    it.frames(lambda: timeline._looked is timeline._pictures[-2])
    tab.get_by_role("button", name="One picture on").press("Enter")
    it.frames(lambda: timeline._looked is timeline._pictures[-1])
    loop = tab.get_by_role("button", name="Begin again at the end")
    loop.press("Enter")
    it.frames(lambda: loop.get_attribute("aria-pressed") == "true")
    tab.get_by_role("button", name="Play the last minute again").press("Enter")
    it.frames(lambda: timeline._replayed is not None)
    seen = set()
    it.frames(lambda: seen.add(timeline._looked.time) or len(seen) > 5)
    assert it.twin.clock.paused


def test_what_happened_is_found(plotted):
    it, tab = plotted
    pause(it, tab)  # what has happened is the present, for the page
    it.twin.control.emergency_stop("robot_1")
    stopped = it.twin.time
    it.frames(lambda: tab.locator(".marks i[title*='emergency stop']").count() == 1)
    tab.locator("body").press("Control+k")
    tab.get_by_role("combobox", name="Find").fill("emergency stop robot_1 command")
    it.frames(lambda: "command at" in tab.locator("#found li").first.inner_text())
    tab.get_by_role("combobox", name="Find").press("Enter")
    it.frames(lambda: it.cockpit._timeline._looked is not None)
    assert it.cockpit._timeline._looked.time == closest(it, stopped)
