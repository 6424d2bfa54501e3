"""Topics, plots, frames and the diagram on the page, in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import io

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, folder, open_tab, show
from conftest import rovers
from PIL import Image

pytestmark = BROWSER_TESTS

STATES = "/robot_1/joint_states"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
WHEEL = "robot_1_front_left_wheel_joint"


@pytest.fixture
def driving(show):
    return show(rovers(2).command(COMMANDS, [2.0, 2.0, 2.0, 2.0]).scenario())


def choose(it, tab, topic):
    """Opens the list and chooses a topic in it."""
    open_tab(tab, "ROS")
    if not tab.get_by_label("Filter topics").is_visible():
        tab.locator(".topics-panel summary", has_text="Topics").click()
    it.frames(lambda: tab.locator(".topics button").count() > 5)
    tab.locator(".topics button", has_text=topic).first.click()
    it.frames(lambda: tab.locator(".topics button[aria-pressed=true]").count() == 1)


def rows(tab):
    return dict(
        zip(
            tab.locator(".echo th").all_inner_texts(),
            tab.locator(".echo td:not(.act)").all_inner_texts(),
            strict=False,
        )
    )


def test_topics_are_listed_filtered_and_echoed(driving):
    it, tab = driving
    choose(it, tab, STATES)
    it.frames(lambda: float(rows(tab).get(f"velocity[{WHEEL}]", 0)) > 1.9)
    names = tab.locator(".topics button")
    count = names.count()
    assert count == len(it.twin.graph.endpoints)
    tab.get_by_label("Filter topics").fill("joint_states")
    it.frames(lambda: 0 < names.count() < count)
    assert all("joint_states" in text for text in names.all_inner_texts())


def test_a_message_is_published_from_a_form(driving):
    it, tab = driving
    choose(it, tab, COMMANDS)
    form = tab.locator("form.publish")
    number = form.get_by_label(f"{WHEEL} velocity")
    it.frames(lambda: number.is_visible() and number.input_value() in ("0", "2"))
    place = [claim.joint for claim in it.twin.graph.command_limits(COMMANDS)].index(WHEEL)

    def published(said):
        form.get_by_role("button", name="Publish").click()
        it.frames(lambda: said in form.locator("[role=status]").inner_text())

    def refused(why):
        form.get_by_role("button", name="Publish").click()
        it.frames(lambda: why in form.locator("[role=alert]").inner_text())

    it.frames(lambda: it.twin.time > 0.1)
    number.fill("5.5")
    published("Published at")
    it.frames(lambda: it.twin.graph.command(COMMANDS).data[place] == 5.5)
    number.fill("fast")
    refused(f"{WHEEL} velocity: fast is not a value")
    number.fill('"fast"')
    refused("'fast' is not a float64")
    form.locator("summary", has_text="As YAML").click()
    text = form.get_by_label("Message as YAML")
    it.frames(text.is_visible)
    text.fill("data: [1.0]]")
    refused("this is not YAML")
    assert it.twin.graph.command(COMMANDS).data[place] == 5.5
    text.fill("data: [5.0, 5.0, 5.0, 5.0]")
    published("Published at")
    it.frames(lambda: list(it.twin.graph.command(COMMANDS).data) == [5.0] * 4)
    it.twin.control.manager("robot_1").switch_controller((), ["forward_velocity_controller"], 2)
    published("is not active and does not hear it")


SCALE = """async () => {
  const { x } = (await import("./plots.js")).plots.figures[0].plot.uplot.scales;
  return [x.min, x.max];
}"""


def plotted(tab):
    """The labels of the curves of all plots."""
    return tab.locator("#plots .legend .curve").all_inner_texts()


def value(tab, number=0):
    """The number that a curve's legend shows; None before the first."""
    text = tab.locator("#plots .legend output").nth(number).inner_text()
    return float(text) if text not in ("", "–") else None


def plot_wheel(it, tab):
    """Plots a wheel's velocity by a press in the list of joints."""
    folder(tab).locator("summary", has_text="Joint states").click()
    folder(tab).get_by_title(f"Plot the velocity of {WHEEL}").click()
    it.frames(lambda: tab.locator("#plots canvas").count() == 1 and value(tab) is not None)


def test_numbers_are_plotted_from_the_echo(driving):
    it, tab = driving
    it.twin.graph.silence(COMMANDS)
    choose(it, tab, STATES)
    path = f"velocity[{WHEEL}]"
    it.frames(lambda: path in rows(tab))
    tab.get_by_role("button", name=f"Plot: {path}").click()
    it.frames(lambda: tab.locator("#plots canvas").count() == 1)
    other = path.replace("front_left", "rear_right")
    tab.get_by_role("button", name=f"Plot: {other}").click()
    it.frames(lambda: plotted(tab) == [f"{STATES}.{path}", f"{STATES}.{other}"])
    order = [claim.joint for claim in it.twin.graph.command_limits(COMMANDS)]
    it.twin.publish(COMMANDS, [{WHEEL: 7.0}.get(name, -3.0) for name in order])
    it.frames(lambda: value(tab, 0) == pytest.approx(7, abs=0.01) and value(tab, 1) == pytest.approx(-3, abs=0.01))
    it.for_frames(40)
    shot = np.asarray(Image.open(io.BytesIO(tab.locator("#plots canvas").screenshot())).convert("RGB")).astype(int)
    red, green, blue = shot[..., 0], shot[..., 1], shot[..., 2]
    first, _ = np.nonzero((blue > red + 60) & (blue > green + 30))
    second, _ = np.nonzero((red > green + 60) & (green > blue + 20))
    assert len(first) > 50
    assert len(second) > 50
    assert np.median(first) < np.median(second)  # 7 rad/s lies above -3 rad/s
    tab.get_by_role("button", name=f"Plot in a plot of its own: effort[{WHEEL}]").click()
    it.frames(lambda: tab.locator("#plots canvas").count() == 2)
    for left in (2, 1, 0):
        tab.locator("#plots .legend").get_by_label("Remove").first.click()
        it.frames(lambda left=left: len(plotted(tab)) == left)
    it.frames(lambda: not tab.locator("#plots").is_visible())
    it.frames(lambda: [*it.cockpit.panels["topics"]._heard] == [STATES])  # the echo
    tab.locator(".topics-panel summary", has_text="Topics").click()
    it.frames(lambda: it.cockpit.panels["topics"]._heard == {})


def test_the_layout_is_kept(driving):
    it, tab = driving
    plot_wheel(it, tab)
    tab.get_by_role("button", name="New plot").click()
    folder(tab).get_by_title(f"Plot {WHEEL}").click()
    it.frames(lambda: tab.locator("#plots canvas").count() == 2)
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1 and tab.locator("#plots canvas").count() == 2)
    assert plotted(tab) == [f"{STATES}.velocity[{WHEEL}]", f"{STATES}.position[{WHEEL}]"]
    it.frames(lambda: value(tab) is not None)
    for left in (1, 0):
        tab.get_by_label("Close the plot").first.click()
        it.frames(lambda left=left: tab.locator("#plots canvas").count() == left)
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1)
    it.for_frames(20)
    assert plotted(tab) == []


def test_a_browser_that_forbids_storage_plots_too(driving):
    it, tab = driving
    refusal = "() => { throw new DOMException('no', 'SecurityError'); }"
    tab.add_init_script(f"if (window === top) Storage.prototype.getItem = Storage.prototype.setItem = {refusal};")
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1)
    plot_wheel(it, tab)


def test_what_cannot_be_plotted_is_said(driving):
    it, tab = driving
    tab.evaluate("async () => { (await import('./plots.js')).plots.add('/robot_1/nothing.x'); }")
    it.seen(tab.locator("#plots .refusal"), "Nothing is published on /robot_1/nothing.")


def test_plots_zoom_by_mouse_and_by_buttons(driving):
    it, tab = driving
    plot_wheel(it, tab)
    it.frames(lambda: it.twin.time > 1.5 and value(tab) == pytest.approx(2, abs=0.01))
    it.twin.publish(COMMANDS, [-1.0, -1.0, -1.0, -1.0])
    it.frames(lambda: value(tab) == pytest.approx(-1, abs=0.01))
    it.twin.pause()
    heard = it.cockpit.panels["topics"]._heard[STATES]
    it.frames(lambda: tab.evaluate(SCALE)[1] == pytest.approx(heard.time, abs=1e-5))  # all is there
    first, last = tab.evaluate(SCALE)
    width = last - first

    def press(name, expected):
        tab.get_by_role("button", name=name, exact=True).press("Enter")
        it.frames(lambda: tab.evaluate(SCALE) == pytest.approx(expected, abs=1e-3))

    press("Zoom in", [first + width / 4, last - width / 4])
    press("Earlier", [first + width / 8, last - 3 * width / 8])
    press("Later", [first + width / 4, last - width / 4])
    press("Zoom out", [first, last])
    area = tab.locator("#plots .u-over").bounding_box()
    y = area["y"] + area["height"] / 2
    tab.mouse.move(area["x"] + area["width"] / 2, y)
    tab.mouse.down()
    tab.mouse.move(area["x"] + area["width"] * 0.75, y, steps=4)
    tab.mouse.up()
    it.frames(lambda: tab.evaluate(SCALE) == pytest.approx([first + width / 2, last - width / 4], abs=0.02 * width))
    if it._browser.browser_type.name == "firefox":  # whose driver sends two single clicks
        tab.locator("#plots .u-over").dispatch_event("dblclick")
    else:
        tab.mouse.dblclick(area["x"] + 30, y)
    it.frames(lambda: tab.evaluate(SCALE) == pytest.approx([first, last]))
    tab.mouse.move(area["x"] + 1, y)
    began = tab.evaluate("async () => (await import('./plots.js')).plots.figures[0].plot.uplot.data[1][0]")
    it.frames(lambda: value(tab) == pytest.approx(began, abs=1e-3) and began > -0.1)  # not the last
    press("Zoom in", [first + width / 4, last - width / 4])
    press("Show all times", [first, last])
    curve = tab.locator("#plots .legend button").first
    curve.press("Enter")
    it.frames(lambda: curve.get_attribute("aria-pressed") == "false")


def test_a_reset_takes_away_what_is_later(driving):
    it, tab = driving
    plot_wheel(it, tab)
    it.frames(lambda: it.twin.time > 1)
    it.twin.reset()
    it.for_frames(4)
    it.frames(lambda: tab.evaluate(SCALE)[1] < 1)


def test_frames_are_a_tree(driving):
    it, tab = driving
    open_tab(tab, "ROS")
    tab.locator(".topics-panel summary", has_text="Frames").click()
    items = tab.locator(".frames li")
    it.frames(lambda: items.count() > 8)
    assert tab.locator(".frames > li").first.inner_text().startswith("world")
    wheel = tab.locator(".frames li li li", has_text="robot_2_rear_left_wheel")
    assert wheel.count() == 1


def chosen(tab):
    return tab.locator(".topics button[aria-pressed=true]").all_inner_texts()


def open_diagram(it, tab):
    open_tab(tab, "ROS")
    tab.get_by_role("button", name="Diagram…").click()
    it.frames(lambda: tab.locator("dialog.drawing svg").count() == 1)


def test_the_systems_of_the_diagram_lead_to_their_topics(driving):
    it, tab = driving
    open_diagram(it, tab)
    dialog = tab.locator("dialog.drawing")
    port = dialog.locator("svg text", has_text="robot_2/joint_states").first
    port.click()
    it.frames(lambda: not dialog.is_visible())
    it.frames(lambda: len(chosen(tab)) == 1 and chosen(tab)[0].startswith("/robot_2/joint_states"))
    open_diagram(it, tab)
    system = dialog.locator("svg g.node", has_text="name=forward_velocity_controller").last
    system.focus()
    system.press("Enter")
    it.frames(lambda: not dialog.is_visible())
    it.frames(lambda: len(chosen(tab)) == 1 and "forward_velocity_controller" in chosen(tab)[0])
    open_diagram(it, tab)
    dialog.get_by_role("button", name="Close").click()
    it.frames(lambda: not dialog.is_visible())


def test_the_focus_stays_on_a_topic_when_others_come(driving):
    it, tab = driving
    open_tab(tab, "ROS")
    tab.locator(".topics-panel summary", has_text="Topics").press("Enter")
    button = tab.get_by_title("/robot_2/joint_states", exact=True)
    it.frames(lambda: button.count() == 1)
    button.focus()
    it.twin.entities.delete("robot_1")
    it.frames(lambda: tab.locator(".topics [title^='/robot_1/']").count() == 0)
    assert tab.evaluate("document.activeElement.title") == "/robot_2/joint_states"
