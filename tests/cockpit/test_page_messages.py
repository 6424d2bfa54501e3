"""The page's messages and numbers, in a real browser."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, folder, open_tab, show
from conftest import rovers

from drake_twin.builder.demo import demo_scenario

pytestmark = BROWSER_TESTS

# Texts with a digit that reach beyond an ancestor that hides what overflows, and fields that are too narrow.
CLIPPED = """body => {
  const found = [];
  const texts = document.createTreeWalker(body, NodeFilter.SHOW_TEXT);
  while (texts.nextNode()) {
    const item = texts.currentNode.parentElement;
    if (!/[0-9]/.test(texts.currentNode.data) || !item.checkVisibility({ visibilityProperty: true })) continue;
    const range = document.createRange();
    range.selectNodeContents(texts.currentNode);
    const box = range.getBoundingClientRect();
    for (let above = item; box.width && above; above = above.parentElement) {
      const { overflowX, position } = getComputedStyle(above);
      if (["auto", "scroll"].includes(overflowX) || position === "fixed") break;
      if (overflowX === "visible" && above !== body) continue;
      const edge = above.getBoundingClientRect();
      if (box.left < edge.left - 1 || box.right > edge.right + 1) found.push(item.outerHTML.slice(0, 160));
    }
  }
  const fields = [...body.querySelectorAll("input[type=number]")].filter((item) => item.checkVisibility());
  const narrow = fields.filter((item) => item.clientWidth && item.scrollWidth > item.clientWidth + 1);
  return [...found, ...narrow.map((item) => item.outerHTML.slice(0, 160))];
}"""


def test_a_stopped_robots_schedule_is_one_message(show):
    it, tab = show(demo_scenario("rover", 2))
    tab.locator("#stop-all").click()
    it.frames(lambda: it.twin.control.is_stopped("robot_1") and it.twin.control.is_stopped("robot_2"))
    it.twin.clock.real_time_rate = 20.0
    it.frames(lambda: it.twin.time > 16.0, most=3000)  # the schedule commands every three to six seconds
    tab.locator("#messages-toggle").click()
    it.for_frames(5)
    lines = [line for line in tab.locator("#messages li").all_inner_texts() if "emergency stop" in line]
    assert len(lines) == 2
    refused = [entry for entry in it.cockpit._log.as_plain() if "emergency stop" in entry["text"]]
    assert len(refused) == 2
    due = [command for command in it.twin.scenario.commands if command.time <= it.twin.time]
    assert len(due) > 2  # that were refused


def test_messages_are_searched_filtered_and_copied(show):
    it, tab = show(rovers(2).scenario())
    for robot, text in (("robot_1", "is late"), ("robot_2", "is late"), ("robot_1", "has no wheel")):
        it.cockpit._log.add("warning" if "late" in text else "error", f"{robot} {text}")
    tab.locator("#messages-toggle").click()
    lines = tab.locator("#messages li")
    it.frames(lambda: lines.count() == 3)
    tab.get_by_label("Search messages").fill("robot_1")
    it.frames(lambda: lines.count() == 2)
    tab.get_by_label("Kind of message").select_option("error")
    it.frames(lambda: lines.count() == 1)
    assert "robot_1 has no wheel" in lines.inner_text()
    tab.evaluate("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    tab.get_by_role("button", name="Copy").click()
    it.frames(lambda: tab.evaluate("window.copied ?? ''") != "")
    time = it.cockpit._log.as_plain()[-1]["time"]
    assert tab.evaluate("window.copied") == f"error\t{time:.2f} s\trobot_1 has no wheel"


@pytest.mark.parametrize("size", [(1280, 800), (390, 844)], ids=["wide", "phone"])
def test_no_number_is_cut_off(show, size):
    it, tab = show(demo_scenario("rover", 1))
    tab.set_viewport_size({"width": size[0], "height": size[1]})
    for summary in tab.locator("#panel summary").all():
        summary.evaluate("element => { element.parentElement.open = true; }")
    it.twin.clock.real_time_rate = 20.0
    it.frames(lambda: it.twin.time > 11.0, most=1500)
    it.twin.pause()
    for name in tab.locator("[role=tab]:visible").all_inner_texts():
        open_tab(tab, name)
        it.for_frames(5)
        assert tab.locator("body").evaluate(CLIPPED) == [], name
    tab.evaluate("document.querySelector('#time').parentElement.style.cssText = 'overflow: hidden; width: 1em'")
    assert tab.locator("body").evaluate(CLIPPED) != []
