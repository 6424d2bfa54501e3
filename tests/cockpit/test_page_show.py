"""The menu of what is shown, in a real browser: reached by keys, searched, and kept for a scenario."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import pytest
from browser import BROWSER_TESTS, browser, open_tab, page, show
from conftest import ARM, rovers
from show_menu import close, switch

from drake_twin import TwinBuilder
from drake_twin.cockpit.overlay import OVERLAY_KINDS, overlay
from drake_twin.errors import InputError

pytestmark = BROWSER_TESTS


def rows(tab):
    """The labels that the menu lists, each with its key."""
    listed = tab.locator("#show-menu li:visible")
    return {row.locator("label").inner_text(): row.locator("kbd").inner_text() for row in listed.all()}


def test_each_has_a_key_of_its_own_and_the_key_switches_it(page):
    it, tab = page
    switch(tab, "Contact forces")
    listed = rows(tab)
    assert len(listed) == len(OVERLAY_KINDS) + 1  # and the names, which the browser draws
    keys = list(listed.values())
    assert "" not in keys
    assert len(set(keys)) == len(keys)
    close(tab)
    for label, name in {kind.label: kind.name for kind in OVERLAY_KINDS.values()}.items():
        tab.keyboard.press(listed[label].lower())
        it.frames(lambda name=name: name in it.cockpit._overlays)
        assert tab.locator("#show-said").inner_text() == f"{label}: on"
        tab.keyboard.press(listed[label].lower())
        it.frames(lambda name=name: name not in it.cockpit._overlays)


def test_the_keyboard_alone_opens_searches_switches_and_closes_it(page):
    it, tab = page
    tab.keyboard.press("v")
    assert tab.evaluate("document.activeElement.getAttribute('aria-label')") == "Search what can be shown"
    tab.keyboard.type("green shapes")  # of a hint
    assert list(rows(tab)) == ["Collision shapes"]
    tab.keyboard.press("Enter")
    it.frames(lambda: "collision" in it.cockpit._overlays)
    assert tab.locator("#show-button").inner_text() == "Show (1)"
    tab.keyboard.press("ArrowDown")
    tab.keyboard.press("Space")
    it.frames(lambda: not it.cockpit._overlays)
    tab.keyboard.press("ArrowUp")
    tab.keyboard.press("Control+a")
    tab.keyboard.type("nothing has this")
    assert rows(tab) == {}
    assert tab.locator("#show-menu p").inner_text() == "Nothing has these words."
    tab.keyboard.press("Escape")
    assert tab.locator("#show-menu").is_hidden()
    assert tab.locator("#show-button").get_attribute("aria-expanded") == "false"
    open_tab(tab, "View")
    tab.locator("#show-in-panel").click(force=True)
    assert tab.locator("#show-menu").is_visible()


def test_what_is_on_is_kept_for_the_scenario_and_not_for_another(show):
    it, tab = show(rovers(2).scenario())
    for label in ("Collision shapes", "Names"):
        switch(tab, label).click(force=True)
    it.frames(lambda: "collision" in it.cockpit._overlays)
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1)
    names = tab.frame_locator("#scene").locator(".name")
    it.frames(lambda: names.count() == 2 and switch(tab, "Names").is_checked())
    assert switch(tab, "Collision shapes").is_checked()
    # Another scenario at the same address.
    it.cockpit.close()
    for twin, shown in ((TwinBuilder().robot("arm", ARM), []), (rovers(2), ["collision"])):
        it.twin = twin.build()
        it.cockpit = it.served.show(it.twin)
        tab.reload()
        it.frames(lambda: tab.locator("body.ready").count() == 1)
        it.for_frames(10)
        assert sorted(it.cockpit._overlays) == shown


def test_the_help_lists_the_keys(page):
    _, tab = page
    tab.keyboard.press("?")
    text = tab.locator("#help").inner_text()
    assert all(f"Show: {kind.label}" in text for kind in OVERLAY_KINDS.values())


@pytest.mark.parametrize("key", ["t", "TT", "1", "ß"])
def test_a_key_that_is_not_a_letter_is_refused(key):
    with pytest.raises(InputError, match="is not a letter from A to Z"):
        overlay("mine", "Mine", key=key)
