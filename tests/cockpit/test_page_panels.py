"""Overlays and panels that others add to the page: registered by a decorator, or found by an entry point."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import logging
import sys
from importlib.metadata import EntryPoint

import pytest
from browser import BROWSER_TESTS, browser, open_tab, page, show
from conftest import rovers
from fake_page import FakePage
from pydrake.geometry import Rgba, Sphere
from pydrake.math import RigidTransform
from show_menu import press

from drake_twin import extensions
from drake_twin.cockpit import protocol
from drake_twin.cockpit.overlay import OVERLAY_KINDS, overlay
from drake_twin.cockpit.panel import PANEL_KINDS, panel
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.errors import InputError

PANELS = "drake_twin.page_panels"
SCRIPT = """
export default class {
  constructor(ask) {
    this.node = document.createElement("div");
    this.text = document.createElement("output");
    const button = document.createElement("button");
    button.textContent = "Honk";
    button.addEventListener("click", () => ask({ honk: 2 }));
    this.node.append(this.text, button);
  }
  state({ steps, honks }) {
    this.text.textContent = `${steps > 0 ? "moving" : "at the start"}, ${honks} honks`;
  }
}
"""


@pytest.fixture
def own_parts(tmp_path, monkeypatch):
    """An overlay and a panel that are not the twin's own."""
    for kinds in (OVERLAY_KINDS, PANEL_KINDS):
        monkeypatch.setattr(kinds, "_kinds", kinds._kinds.new_child())
    script = tmp_path / "horn.js"
    script.write_text(SCRIPT)

    @overlay("origin", "Origin of the world", "A red ball")
    class Origin:
        def __init__(self, scene, twin):
            self._scene = scene
            scene.set_object(f"{OVERLAYS}/origin", Sphere(0.1), Rgba(1, 0, 0))

        def draw(self):
            self._scene.set_transform(f"{OVERLAYS}/origin", RigidTransform())

        def remove(self):
            self._scene.delete(f"{OVERLAYS}/origin")

    @panel("horn", script)
    class Horn:
        def __init__(self, twin):
            self._twin = twin
            self._honks = 0

        def state(self):
            return {"steps": self._twin.clock.step_count, "honks": self._honks}

        def ask(self, data):
            if data["honk"] > 9:
                raise InputError("too loud")
            self._honks += data["honk"]


def test_an_overlay_of_others_is_listed_drawn_and_removed(own_parts):
    it = FakePage(rovers(1).build(), Scene())
    assert it.state
    listed = it.server.told["robots"]["overlays"]
    first = ["tracks", "starts", "goals", "contacts", "masses", "inertia"]
    assert [item["name"] for item in listed] == [*first, "collision", "frames", "joints", "sensors", "fluids", "origin"]
    assert listed[-1] == {"name": "origin", "label": "Origin of the world", "hint": "A red ball", "key": ""}
    it.ask(protocol.Show("origin", True))
    assert it.cockpit._scene.has_path(f"{OVERLAYS}/origin")
    it.ask(protocol.Show("origin", False))
    assert not it.cockpit._scene.has_path(f"{OVERLAYS}/origin")
    it.ask(protocol.Show("nothing", True))
    assert it.state
    assert "unknown overlay 'nothing'. Valid: collision, contacts," in it.messages[-1][1]
    it.cockpit.close()


def test_a_panel_of_others_is_served_asked_and_published(own_parts):
    it = FakePage(rovers(1).build(), Scene())
    assert it.server.files["panel_horn.js"] == SCRIPT.encode()
    it.ask(protocol.AskPanel("horn", '{"honk": 2}'))
    assert it.state["panels"]["horn"] == {"steps": 0, "honks": 2}
    assert it.server.told["robots"]["panels"] == [
        *("world", "own", "parameters", "spawn", "topics", "compare"),
        "horn",
    ]
    for name, data, reason in (
        ("horn", '{"honk": 99}', "too loud"),
        ("horn", "{", "panel 'horn' sent data that is not JSON: '{'"),
        ("bell", "1", "unknown panel 'bell'. Valid: world, own, parameters, spawn, topics, compare, horn"),
    ):
        it.ask(protocol.AskPanel(name, data))
        assert it.state["panels"]["horn"] == {"steps": 0, "honks": 2}
        assert reason in it.messages[-1][1]
    it.cockpit.close()


def test_two_parts_of_one_name_are_refused(own_parts):
    with pytest.raises(InputError, match=r"overlay 'frames' is registered by drake_twin\.cockpit\.\S+ and by"):
        overlay("frames", "Frames")(FakePage)
    with pytest.raises(InputError, match="'my overlay' cannot name a part of the page"):
        overlay("my overlay", "Mine")(FakePage)


@pytest.fixture
def entry_points(monkeypatch):
    """Sets the entry points of the group, and forgets what was loaded."""

    def set_(*entries):
        found = {PANELS: [EntryPoint(name, value, PANELS) for name, value in entries]}
        monkeypatch.setattr(extensions, "entry_points_of", lambda group: found.get(group, ()))
        extensions.load_extensions.cache_clear()

    yield set_
    extensions.load_extensions.cache_clear()


def test_entry_points_are_loaded_when_a_page_is_opened_and_a_broken_one_is_named(
    entry_points, tmp_path, monkeypatch, caplog
):
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.setattr(OVERLAY_KINDS, "_kinds", OVERLAY_KINDS._kinds.new_child())
    (tmp_path / "their_overlay.py").write_text(
        "from drake_twin.cockpit.overlay import overlay\n"
        "@overlay('theirs', 'Theirs')\n"
        "class Theirs:\n"
        "    def __init__(self, scene, twin): pass\n"
        "    def draw(self): pass\n"
        "    def remove(self): pass\n"
    )
    entry_points(("theirs", "their_overlay"), ("broken", "no_such_module:Panel"))
    twin = rovers(1).build()
    assert "their_overlay" not in sys.modules
    with caplog.at_level(logging.WARNING):
        it = FakePage(twin, Scene())
    assert "broken = no_such_module:Panel of drake_twin.page_panels cannot be loaded (ModuleNotFound" in caplog.text
    assert it.state
    assert it.server.told["robots"]["overlays"][-1]["name"] == "theirs"
    it.cockpit.close()


class TestInBrowser:
    """The same parts, used by a person."""

    pytestmark = BROWSER_TESTS

    def test_the_overlay_has_a_switch_and_the_panel_a_section(self, own_parts, page):
        it, tab = page
        section = tab.locator("[data-panel=horn]")
        it.frames(section.is_visible)  # what a page with panels of others is opened for
        open_tab(tab, "View")
        press(tab, "Origin of the world")
        it.frames(lambda: it.scene.has_path(f"{OVERLAYS}/origin"))
        open_tab(tab, "Panels")
        it.seen(section.locator("output"), "moving, 0 honks")
        section.get_by_role("button", name="Honk").click()
        it.seen(section.locator("output"), "moving, 2 honks")
