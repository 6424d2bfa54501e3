"""Panels of a user's own in a real browser: operated by keyboard, in two tabs, with hostile names and faults."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import base64

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, changed, picture, show
from conftest import rovers
from docs.draw_panel import saved
from robots_to_steer import WHEELS_1

from drake_twin.cli.plugins import load_panels
from drake_twin.cockpit.page_panel import PAGE_PANELS

pytestmark = BROWSER_TESTS

HOSTILE = '<img src=x onerror="window.hacked = 1"><script>window.hacked = 1</script>'


@pytest.fixture
def shown(show):
    """A page of two rovers, a tab, and what adds a panel."""
    it, tab = show(rovers(2).scenario())
    return it, tab, it.cockpit.panels["own"].add


def fill(panel, twin, heard):
    """One of everything; what is set or pressed is noted."""
    controls = {
        "width": panel.slider("width", 0, 0.08, step=0.01, unit="m", on_change=lambda v: heard.append(("width", v))),
        "mass": panel.number("mass", 1.0, lower=0, unit="kg", on_change=lambda v: heard.append(("mass", v))),
        "closed": panel.checkbox("closed", on_change=lambda v: heard.append(("closed", v))),
        "gait": panel.choice("gait", ["walk", "trot"], on_change=lambda v: heard.append(("gait", v))),
        "note": panel.text("note", on_change=lambda v: heard.append(("note", v))),
        "Close": panel.button("Close", on_press=lambda: heard.append(("Close", None))),
    }
    more = panel.folder("More")
    more.plot("height", lambda: {"robot_1": twin.robot_state("robot_1").base_pose[2]}, unit="m")
    more.table(
        "poses",
        lambda: {name: twin.robot_state(name).base_pose[:2] for name in twin.robots},
        columns=("robot", "x", "y"),
    )
    more.image("eye", lambda: np.full((20, 30, 3), (200, 10, 60), dtype=np.uint8))
    more.marker("goal", (0, 0, 1), size=0.5, color=(0.1, 0.2, 0.9))
    return controls


def test_each_control_is_operated_by_keyboard(shown):
    it, tab, add = shown
    heard = []
    panel = add("Gripper")
    controls = fill(panel, it.twin, heard)
    section = tab.get_by_role("region", name="Gripper")
    it.frames(lambda: section.count() == 1)
    section.get_by_role("slider", name="width").press("ArrowRight")
    it.frames(lambda: heard == [("width", 0.01)])
    mass = section.get_by_label("mass")
    mass.fill("2.5")
    mass.press("Enter")
    it.frames(lambda: heard[-1] == ("mass", 2.5))
    section.get_by_role("switch", name="closed").press("Space")
    it.frames(lambda: heard[-1] == ("closed", True))
    section.get_by_label("gait").press("ArrowDown")
    it.frames(lambda: heard[-1] == ("gait", "trot"))
    note = section.get_by_label("note")
    note.fill("a word")
    note.press("Enter")
    it.frames(lambda: heard[-1] == ("note", "a word"))
    section.get_by_role("button", name="Close").press("Enter")
    it.frames(lambda: heard[-1] == ("Close", None))
    assert len(heard) == 6
    assert [control.value for control in controls.values()] == [0.01, 2.5, True, "trot", "a word", None]


def test_what_a_slider_refuses_is_said_and_the_page_returns_to_its_value(shown):
    it, tab, add = shown
    width = add("Gripper").slider("width", 0, 0.08, value=0.02, unit="m")
    number = tab.get_by_label("width, number")
    it.frames(lambda: number.count() == 1)
    number.fill("0.09")
    number.press("Enter")
    it.frames(lambda: "0.09 m lies outside of its range from 0 to 0.08" in tab.locator("#message-text").inner_text())
    tab.locator("#play").focus()
    it.frames(lambda: number.input_value() == "0.0200")
    assert width.value == 0.02


def test_two_tabs_show_the_same_values_and_those_that_the_program_sets(shown):
    it, one, add = shown
    heard = []
    controls = fill(add("Gripper"), it.twin, heard)
    two = it.tab()
    one, two = (tab.get_by_role("region", name="Gripper") for tab in (one, two))
    it.frames(lambda: [tab.get_by_label("mass").count() for tab in (one, two)] == [1, 1])
    one.get_by_role("slider", name="width").press("End")
    it.frames(lambda: two.get_by_label("width, number").input_value() == "0.08")
    two.get_by_label("gait").select_option("trot")
    it.frames(lambda: one.get_by_label("gait").input_value() == "trot")
    for name, value in (("mass", 7.0), ("note", "of the program"), ("closed", True)):
        controls[name].value = value
    for tab in (one, two):
        it.frames(lambda tab=tab: tab.get_by_label("mass").input_value() == "7")
        it.frames(lambda tab=tab: tab.get_by_label("note").input_value() == "of the program")
        it.frames(lambda tab=tab: tab.get_by_role("switch", name="closed").is_checked())
    assert heard == [("width", 0.08), ("gait", "trot")]


def test_a_marker_is_drawn_in_the_scene(shown):
    it, tab, add = shown
    it.twin.pause()
    before = picture(tab)
    add("Gripper").marker("goal", (0, 0, 1), size=0.5, color=(0.1, 0.2, 0.9))
    it.frames(lambda: it.scene.has_path("/overlays/own"))
    it.frames(lambda: changed(before, picture(tab)) > 100, most=200)


def test_plots_tables_images_and_markers_are_shown_and_follow_robots(shown):
    it, tab, add = shown
    panel = add("Gripper")
    fill(panel, it.twin, [])
    plot, table, image = (tab.locator(f".own {what}") for what in (".plot .legend output", "tbody", "img"))
    it.frames(lambda: image.count() == 1 and image.is_visible())
    it.frames(lambda: plot.count() == 1 and float(plot.inner_text()) == pytest.approx(0.13, abs=0.05))
    it.frames(lambda: [row.split("\t")[0] for row in table.inner_text().splitlines()] == ["robot_1", "robot_2"])
    sent = image.evaluate("image => image.src").removeprefix("data:image/png;base64,")
    assert base64.b64decode(sent).startswith(b"\x89PNG")
    assert image.evaluate("image => [image.naturalWidth, image.naturalHeight]") == [30, 20]
    it.frames(lambda: it.scene.has_path("/overlays/own"))
    robot = it.twin.scenario.robots[0]
    it.twin.entities.delete("robot_1")
    it.frames(lambda: [row.split("\t")[0] for row in table.inner_text().splitlines()] == ["robot_2"])
    problem = tab.locator(".own .refusal", has_text="robot_1")
    it.frames(lambda: problem.count() == 1 and problem.is_visible())
    it.twin.entities.spawn(robot)
    it.frames(lambda: problem.count() == 0)
    tab.get_by_role("switch", name="goal").press("Space")
    it.frames(lambda: not it.scene.has_path("/overlays/own"))


def test_what_is_folded_or_in_no_tab_is_not_read(shown):
    it, tab, add = shown
    calls = []
    add("Gripper").plot("height", lambda: calls.append(1) or 1.0)
    fold = tab.get_by_role("button", name="Gripper")
    it.frames(lambda: len(calls) > 3)
    fold.press("Enter")
    own = it.cockpit.panels["own"]
    it.frames(lambda: own._looks and not any(own._looks))  # only looks at no panel
    seen = len(calls)
    it.for_frames(10)
    assert len(calls) == seen
    fold.press("Enter")
    it.frames(lambda: len(calls) > seen)


def test_names_of_strangers_are_text(shown):
    it, tab, add = shown
    panel = add(HOSTILE)
    panel.slider(HOSTILE, 0, 1, unit=HOSTILE, hint=HOSTILE)
    folder = panel.folder(HOSTILE + "folder")
    folder.choice(HOSTILE, [HOSTILE, "b"])
    folder.table("table", lambda: {HOSTILE: HOSTILE}, columns=[HOSTILE, "b"])
    folder.plot("plot", lambda: {HOSTILE: 1.0}, unit=HOSTILE)
    folder.button(HOSTILE + "button")
    folder.marker(HOSTILE + "marker", (0, 0, 0))
    folder.text("text", HOSTILE)
    it.frames(lambda: tab.locator(".own .legend output").count() == 1 and tab.locator(".own tbody td").count() == 1)
    assert tab.locator(".own tbody td").inner_text() == HOSTILE
    assert tab.locator(".own-panel h2").inner_text() == HOSTILE
    assert tab.evaluate("[window.hacked, document.querySelectorAll('.own script, .own img').length]") == [None, 0]


def test_a_callback_that_raises_is_said_at_its_control_and_the_rest_continues(shown):
    it, tab, add = shown
    panel = add("Gripper")
    panel.button("Close", on_press=lambda: 1 / 0)
    speed = panel.slider("speed", -5, 5, on_change=lambda value: it.twin.publish(WHEELS_1, [value] * 4))
    close = tab.get_by_role("button", name="Close", exact=True)
    it.frames(lambda: close.count() == 1)
    close.press("Enter")
    what = (
        "button 'Close' of the panel 'Gripper' has failed, and is not called again: ZeroDivisionError: division by zero"
    )
    it.frames(lambda: what in tab.locator(".own .refusal:visible").inner_text())
    it.frames(close.is_disabled)
    assert what in tab.locator("#message-text").inner_text()
    tab.get_by_role("slider", name="speed").press("End")
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 0.02)
    assert speed.value == 5


def test_a_panel_comes_goes_and_is_found(shown):
    it, tab, add = shown
    heard = []
    panel = add("Gripper")
    panel.button("Open wide", on_press=lambda: heard.append(1))
    it.frames(lambda: tab.get_by_role("button", name="Open wide").count() == 1)
    tab.keyboard.press("Control+k")
    tab.keyboard.type("gripper open")
    assert tab.locator("#found li").first.inner_text().splitlines() == ["Open wide", "Panels · Gripper"]
    tab.keyboard.press("Enter")
    it.frames(lambda: heard == [1])
    other = add("Other")
    other.text("text")
    it.frames(lambda: tab.locator(".own-panel").count() == 2)
    panel.remove()
    it.frames(lambda: tab.locator(".own-panel").count() == 1)
    assert tab.locator(".own-panel h2").inner_text() == "Other"


def test_the_panel_of_the_documentation_drives_its_rover(show, tmp_path, monkeypatch):
    monkeypatch.setattr(PAGE_PANELS, "_kinds", PAGE_PANELS._kinds.new_child())
    load_panels([saved(tmp_path)])
    it, tab = show(rovers(1).scenario())
    section = tab.get_by_role("region", name="Rover")
    it.frames(lambda: section.locator("img:visible, tbody td").count() == 5)
    section.get_by_role("slider", name="speed").press("End")
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 0.05)
    section.get_by_role("button", name="Stop").press("Enter")
    it.frames(lambda: section.get_by_label("speed, number").input_value() == "0.0")
    it.frames(lambda: np.abs(it.twin.joint_states("robot_1").velocity).max() < 1e-3)
    section.get_by_label("goal at x").fill("1")
    section.get_by_label("goal at x").press("Enter")
    distance = section.locator(".plot output")
    x, y, z = it.twin.robot_state("robot_1").base_pose[:3]
    there = np.linalg.norm([x - 1.0, y - 1.0, z - 0.15])
    it.frames(lambda: float(distance.inner_text()) == pytest.approx(there, abs=1e-2))
    assert section.locator(".refusal:visible").count() == 0
