"""The shape of the page in a real browser: the tabs of the side panel, and what is kept of them."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, folder, open_tab, page, show
from conftest import rovers
from in_scene import tools
from robots_to_steer import WHEELS_1

pytestmark = BROWSER_TESTS


def chosen(tab):
    """The name of the chosen tab, whose page alone is shown."""
    names = tab.locator("[role=tab][aria-selected=true]").all_inner_texts()
    assert len(names) == 1
    assert tab.locator("[role=tabpanel]:visible").get_attribute("id") == f"page-{names[0].lower()}"
    return names[0]


def test_tabs_are_chosen_by_the_keys_that_tabs_have(page):
    _, tab = page
    names = tab.locator("[role=tab]:visible").all_inner_texts()
    assert names == ["Robots", "World", "ROS", "View", "Time"]  # there are no sensors
    assert chosen(tab) == "Robots"
    tab.get_by_role("tab", name="Robots").focus()
    for key, name in (
        ("ArrowRight", "World"),
        ("ArrowRight", "ROS"),
        ("ArrowLeft", "World"),
        ("End", "Time"),
        ("ArrowRight", "Robots"),
        ("ArrowLeft", "Time"),
        ("Home", "Robots"),
    ):
        tab.keyboard.press(key)
        assert chosen(tab) == name
        assert tab.evaluate("document.activeElement.textContent") == name
        assert tab.locator("[role=tab][tabindex='0']").all_inner_texts() == [name]  # the only one that Tab comes to
    tab.keyboard.press("Tab")
    assert tab.evaluate("document.activeElement.closest('[role=tabpanel]')?.id") == "page-robots"


def test_the_tab_is_kept(page):
    it, tab = page
    open_tab(tab, "ROS")
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1)
    assert chosen(tab) == "ROS"


def test_what_a_hidden_tab_shows_is_not_updated_until_it_is_shown(page):
    it, tab = page
    folder(tab).get_by_text("Joint states").click()
    cell = folder(tab).locator("tbody td").nth(1)  # the first wheel's velocity
    it.frames(lambda: cell.inner_text() not in ("", "–"))
    open_tab(tab, "View")
    tab.evaluate("""() => {
      window.changes = 0;
      const kinds = { subtree: true, childList: true, characterData: true, attributes: true };
      const observer = new MutationObserver((all) => { window.changes += all.length; });
      observer.observe(document.querySelector("#page-robots"), kinds);
    }""")
    it.twin.publish(WHEELS_1, [3, 3, 3, 3])
    it.frames(lambda: it.twin.robot_state("robot_1").velocities[0] > 2.5)
    it.for_frames(10)
    assert tab.evaluate("window.changes") == 0
    open_tab(tab, "Robots")
    it.frames(lambda: float(cell.inner_text()) > 2.5)


NODES = "document.querySelectorAll('*').length"


def test_a_hundred_robots_are_hardly_more_elements_than_thirty(show):
    counts = {}
    for many in (30, 100):
        it, tab = show(rovers(many).scenario())
        it.twin.pause()
        it.frames(lambda many=many, tab=tab: tab.locator(".robot").count() == many)
        open_tab(tab, "World")
        it.frames(lambda tab=tab: tab.locator(".tree li").count() > 30)
        open_tab(tab, "ROS")
        tab.locator(".topics-panel summary", has_text="Topics").click()
        it.frames(lambda tab=tab: tab.locator(".topics li").count() > 30)
        open_tab(tab, "Robots")
        it.frames(lambda tab=tab: tab.locator(".robot summary").count() > 5)
        counts[many] = tab.evaluate(NODES)
        tab.locator(".page:visible").evaluate("page => { page.scrollTop = page.scrollHeight; }")
        it.frames(lambda many=many, tab=tab: folder(tab, f"robot_{many}").locator("summary").count() == 1)
        assert folder(tab, "robot_1").locator("summary").count() == 0
        tab.close()
        it.tabs.clear()
    assert counts[100] < 1.2 * counts[30]


def test_the_tab_side_filters_and_camera_are_kept_for_a_scenario(show):
    it, tab = show(rovers(5).scenario())
    tab.get_by_label("Filter robots").fill("_4")
    open_tab(tab, "View")
    tab.get_by_role("button", name="Controls on the other side").click()
    assert tab.locator("#panel").bounding_box()["x"] == 0
    tools(tab, "placeCamera([3, 4, 5, 0.5, 0, 0])")
    it.for_frames(5)
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1)
    it.frames(lambda: tools(tab, "cameraPlace()") == pytest.approx([3, 4, 5, 0.5, 0, 0]))
    assert chosen(tab) == "View"
    assert tab.locator("#panel").bounding_box()["x"] == 0
    open_tab(tab, "Robots")
    assert tab.locator(".robot:visible").evaluate_all("all => all.map(({ dataset }) => dataset.robot)") == ["robot_4"]


PHONE = {"width": 390, "height": 844}
SMALL = """() => [...document.querySelectorAll("button, summary, select, input, [role=treeitem]")]
  .filter((node) => node.checkVisibility() && !node.matches("input[type=range], input[type=checkbox]"))
  .map((node) => [node.outerHTML.slice(0, 80), node.getBoundingClientRect().height])
  .filter(([, height]) => height < 39.5)"""


def test_on_a_phone_nothing_is_cut_off_and_a_thumb_meets_every_control(page):
    it, tab = page
    tab.set_viewport_size(PHONE)
    it.for_frames(5)
    for name in tab.locator("[role=tab]:visible").all_inner_texts():
        if tab.locator("[role=tab][aria-selected=true]").inner_text() != name:
            open_tab(tab, name)
        it.for_frames(3)
        assert tab.evaluate("document.documentElement.scrollWidth") <= 390, name
        assert tab.locator(".page:visible").evaluate("page => page.scrollWidth <= page.clientWidth"), name
    before = tab.locator(".scene").bounding_box()["height"]
    open_tab(tab, chosen(tab))
    it.frames(lambda: tab.locator(".scene").bounding_box()["height"] > before + 100)
    assert tab.locator("[role=tab]").first.is_visible()
    open_tab(tab, "World")
    it.frames(lambda: tab.locator(".tree").is_visible())
