"""The shape of the page in a real browser: the tabs of the side panel, and what is kept of them."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

from browser import BROWSER_TESTS, browser, folder, open_tab, page, show
from conftest import rovers
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
