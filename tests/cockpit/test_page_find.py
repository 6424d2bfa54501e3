"""Find (Ctrl K) on the page, in a real browser: what is on it is reached and operated by the keyboard alone."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, folder, open_tab, page, show
from conftest import rovers

pytestmark = BROWSER_TESTS


def find(tab, words, *, enter=True):
    """Type words into Find, opened by its keys."""
    tab.keyboard.press("Control+k")
    tab.keyboard.type(words)
    if enter:
        tab.keyboard.press("Enter")


def found(tab):
    return tab.locator("#palette li span").all_inner_texts()


def test_the_seventh_of_eight_robots_is_stopped_and_its_slider_reached_though_it_is_folded(show):
    it, tab = show(rovers(8).scenario())
    assert not folder(tab, "robot_7").locator("details").first.evaluate("element => element.open")
    find(tab, "stop robot_7")
    it.frames(lambda: tab.locator(".robot.stopped").count() == 1)
    assert folder(tab, "robot_7").get_attribute("class") == "robot stopped"
    find(tab, "robot_7 rear_left velocity number")
    focused = tab.evaluate("document.activeElement.getAttribute('aria-label')")
    assert focused == "robot_7 robot_7_rear_left_wheel_joint velocity, number"
    assert folder(tab, "robot_7").locator("details").first.evaluate("element => element.open")


def test_a_topic_is_found_by_a_part_of_its_name(page):
    it, tab = page
    find(tab, "robot_2 joint_states", enter=False)
    it.frames(lambda: found(tab)[:1] == ["/robot_2/joint_states"])
    tab.keyboard.press("Enter")
    chosen = tab.locator(".topics [aria-pressed=true]")
    it.frames(lambda: chosen.count() == 1 and chosen.inner_text().startswith("/robot_2/joint_states"))


def test_switches_and_what_is_in_the_world_are_found(page):
    it, tab = page
    find(tab, "contact forces")
    it.frames(lambda: "contacts" in it.cockpit._overlays)
    find(tab, "robot_2 base_link", enter=False)
    it.frames(lambda: len(found(tab)) > 0)
    tab.keyboard.press("Enter")
    it.frames(lambda: "base_link" in tab.locator(".tree [aria-selected=true]").inner_text())


def test_what_switches_something_off_is_no_first_choice_where_something_else_has_the_words(page):
    it, tab = page
    find(tab, "joint_state", enter=False)
    it.frames(lambda: "/robot_1/joint_states" in found(tab))
    switch = tab.locator("#palette li", has_text="robot_1 joint_state_broadcaster")
    assert switch.locator("small").inner_text() == "Robots · switch, on"
    assert "joint_states" in found(tab)[0]


def test_arrows_choose_and_escape_leaves_all_as_it_was(page):
    _, tab = page
    find(tab, "", enter=False)
    rows = tab.locator("#palette li")
    assert rows.count() == 40
    for key, at in (("ArrowDown", 1), ("ArrowDown", 2), ("ArrowUp", 1), ("PageDown", 11), ("PageUp", 1)):
        tab.keyboard.press(key)
        assert rows.nth(at).get_attribute("aria-selected") == "true"
        assert tab.evaluate("document.activeElement.getAttribute('aria-activedescendant')") == f"found-{at}"
    tab.keyboard.type("nothing has this name")
    assert (rows.count(), tab.locator("#palette p").inner_text()) == (0, "Nothing has these words.")
    tab.keyboard.press("Enter")
    assert tab.locator("#palette").evaluate("element => element.open")
    tab.keyboard.press("Escape")
    assert not tab.locator("#palette").evaluate("element => element.open")


def test_the_panels_width_and_folded_groups_are_kept(page):
    it, tab = page
    edge, panel = tab.locator(".edge.beside"), tab.locator("#panel")
    before = panel.bounding_box()["width"]
    edge.focus()
    for key in ("ArrowLeft", "ArrowLeft", "ArrowLeft", "ArrowRight"):
        tab.keyboard.press(key)
    assert panel.bounding_box()["width"] == before + 40
    assert edge.get_attribute("aria-valuenow") == str(round(before + 40))
    box = edge.bounding_box()
    tab.mouse.move(box["x"] + 4, box["y"] + 300)
    tab.mouse.down()
    tab.mouse.move(box["x"] - 96, box["y"] + 320, steps=4)
    tab.mouse.up()
    assert panel.bounding_box()["width"] == pytest.approx(before + 140, abs=6)
    wide = panel.bounding_box()["width"]
    open_tab(tab, "View")
    tab.get_by_role("button", name="Camera", exact=True).click(force=True)
    assert tab.locator("#follow").is_hidden()
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1)
    assert panel.bounding_box()["width"] == wide
    assert tab.locator("#follow").is_hidden()
    open_tab(tab, "ROS")
    find(tab, "camera follows")  # chooses its tab, and unfolds it
    it.frames(lambda: tab.locator("#follow").is_visible())
    edge.dblclick(force=True)
    assert panel.bounding_box()["width"] == before


def test_the_plots_height_is_kept(page):
    it, tab = page
    plot = "async (path) => { (await import('./plots.js')).plots.add(path); }"
    edge, plots = tab.locator(".edge.below"), tab.locator("#plots")
    assert edge.is_hidden()
    it.frames(lambda: tab.evaluate("async () => (await import('./plots.js')).plots.key !== null"))  # it knows its store
    tab.evaluate(plot, "/robot_1/joint_states.velocity[0]")
    it.frames(lambda: tab.locator("#plots canvas").count() == 1)
    before = plots.bounding_box()["height"]
    edge.focus()
    for key in ("ArrowUp", "ArrowUp", "ArrowUp", "ArrowDown"):
        tab.keyboard.press(key)
    assert plots.bounding_box()["height"] == before + 40
    box = edge.bounding_box()
    tab.mouse.move(box["x"] + 200, box["y"] + 4)
    tab.mouse.down()
    tab.mouse.move(box["x"] + 220, box["y"] - 56, steps=4)
    tab.mouse.up()
    assert plots.bounding_box()["height"] == pytest.approx(before + 100, abs=6)
    high = plots.bounding_box()["height"]
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1 and tab.locator("#plots canvas").count() == 1)
    assert plots.bounding_box()["height"] == high
    edge.dblclick(force=True)
    assert plots.bounding_box()["height"] == before
    tab.set_viewport_size({"width": 390, "height": 844})
    assert edge.is_hidden()
