"""Panels of a user's own, without a browser: what they hold, what they are asked, what misbehaves."""

import base64
import io
import json
import logging

import numpy as np
import pytest
from conftest import rovers
from fake_page import FakePage
from PIL import Image
from robots_to_steer import WHEELS_1

from drake_twin import InputError, replay
from drake_twin.cockpit import protocol
from drake_twin.cockpit.page_controls import MOST_PARTS
from drake_twin.cockpit.page_panel import PAGE_PANELS, page_panel
from drake_twin.findings import Kind, texts

NAN = float("nan")


@pytest.fixture
def page():
    page = FakePage(rovers(2).build())
    yield page
    page.cockpit.close()


@pytest.fixture
def panel(page):
    return page.cockpit.panels["own"].add("Gripper")


def ask(page, do, **fields):
    page.ask(protocol.AskPanel("own", json.dumps({"do": do, **fields})))


def look(page, version=0, images=0, shown=()):
    """Look as a tab does, without a snapshot in between."""
    page.cockpit.panels["own"].ask({"do": "Look", "version": version, "images": images, "shown": list(shown)})


def numbers(page):
    """Label → number of everything in all panels, from what a new tab is sent."""
    look(page)
    found = {}

    def add(item):
        found[item["label"]] = item["id"]
        for each in item.get("items", ()):
            add(each)

    for each in page.cockpit.panels["own"].state()["panels"]:
        add(each)
    return found


def shown(page):
    """What a tab that shows all panels is sent."""
    look(page, shown=numbers(page).values())
    return page.cockpit.panels["own"].state()


def test_a_page_without_panels_is_sent_nothing(page):
    assert page.state["panels"]["own"] is None


def test_each_control_has_its_first_value_and_is_set_by_a_tab(page, panel):
    heard = []
    controls = [
        panel.slider("width", 0, 0.08, unit="m", on_change=heard.append),
        panel.number("mass", 1.5, lower=0, unit="kg", on_change=heard.append),
        panel.checkbox("closed", on_change=heard.append),
        panel.choice("gait", ["walk", "trot"], on_change=heard.append),
        panel.text("note", on_change=heard.append),
    ]
    assert [control.value for control in controls] == [0, 1.5, False, "walk", ""]
    known = numbers(page)
    for control, value in zip(controls, (0.05, 2, True, "trot", "a <b>"), strict=True):
        ask(page, "Set", control=known[control.label], value=value)
        assert control.value == value
    assert heard == [0.05, 2.0, True, "trot", "a <b>"]
    assert {type(value) for value in heard} == {float, bool, str}
    assert [*shown(page)["values"].values()] == heard


def test_the_program_sets_a_value_without_its_callback(page, panel):
    heard = []
    width = panel.slider("width", 0, 0.08, on_change=heard.append)
    width.value = 0.02
    assert shown(page)["values"] == {numbers(page)["width"]: 0.02}
    assert heard == []
    with pytest.raises(InputError, match=r"^slider 'width' of the panel 'Gripper': 0\.1 lies outside of"):
        width.value = 0.1


@pytest.mark.parametrize("value", [0.081, -1, True, "0.01", None, [0.01], NAN, 10**400])
def test_a_slider_refuses_what_is_not_in_its_range(page, panel, value):
    heard = []
    width = panel.slider("width", 0, 0.08, unit="m", on_change=heard.append)
    ask(page, "Set", control=numbers(page)["width"], value=value)
    assert (width.value, heard) == (0.0, [])
    page.cockpit.publish()
    level, text = page.messages[-1]
    assert level == "error"
    assert text.startswith("slider 'width' of the panel 'Gripper': ")


def test_a_refusal_names_value_unit_and_range(page, panel):
    panel.slider("width", 0, 0.08, unit="m")
    panel.number("mass", 1.0, lower=0.5, unit="kg")
    panel.choice("gait", ["walk", "trot"])
    known = numbers(page)
    ask(page, "Set", control=known["width"], value=0.09)
    ask(page, "Set", control=known["mass"], value=0)
    ask(page, "Set", control=known["gait"], value="trott")
    ask(page, "Set", control=99, value=1)
    ask(page, "Jump")
    page.cockpit.publish()
    assert [text for _, text in page.messages[-5:]] == [
        "slider 'width' of the panel 'Gripper': 0.09 m lies outside of its range from 0 to 0.08.",
        "number 'mass' of the panel 'Gripper': 0 kg lies outside of its range from 0.5.",
        "choice 'gait' of the panel 'Gripper': unknown choice 'trott'. Did you mean 'trot'? Valid: walk, trot.",
        "what was set or pressed is not in a panel of the page any more.",
        "unknown request {'do': 'Jump'} of a panel.",
    ]


@pytest.mark.parametrize(
    ("add", "why"),
    [
        (lambda panel: panel.slider("a", 1, 1), "'a' of the panel 'Gripper': the range from 1 to 1 is empty"),
        (lambda panel: panel.slider("a", 0, NAN), "nan is not a finite number"),
        (lambda panel: panel.slider("a", 0, 1, value=2), "2 lies outside of its range from 0 to 1"),
        (lambda panel: panel.slider("a", 0, 1, step=2), "2 lies outside of its range from 0 to 1"),
        (lambda panel: panel.slider("a", 0, 1, unit="m\n"), "is not a text of one line"),
        (lambda panel: panel.button(""), "'' cannot be a name on the page"),
        (lambda panel: panel.button("a\nb"), "cannot be a name on the page"),
        (lambda panel: panel.choice("a", []), "at least one choice is needed"),
        (lambda panel: panel.choice("a", ["x"], value="y"), "unknown choice 'y'. Valid: x"),
        (lambda panel: panel.plot("a", 1.0), "plot 'a' of the panel 'Gripper': 1.0 is not a function"),
        (lambda panel: panel.marker("a", (0, 0)), "the position is three numbers, not (0, 0)"),
        (lambda panel: panel.marker("a", (0, 0, 0), shape="cone"), "unknown shape 'cone'. Valid: "),
        (lambda panel: panel.marker("a", (0, 0, 0), size=0), "the size 0 m is not positive"),
        (lambda panel: panel.marker("a", (0, 0, 0), color=(0, 0, 2)), "2 lies outside of its range from 0 to 1"),
        (lambda panel: [panel.button("a"), panel.text("a")], "already has 'a': each name stands for one thing"),
        (lambda panel: [panel.remove(), panel.button("a")], "has been removed: page.panel('Gripper') makes a new one"),
    ],
)
def test_what_does_not_fit_is_refused_where_it_is_added(panel, add, why):
    with pytest.raises(InputError) as caught:
        add(panel)
    assert why in str(caught.value)


def test_more_controls_than_a_page_can_have_are_refused_in_words(page, panel):
    folder = panel.folder("many")

    def add_all():
        for number in range(10_000):
            folder.button(str(number))

    with pytest.raises(InputError, match=f"have {MOST_PARTS} controls, plots, … at most"):
        add_all()
    folder.remove()
    assert panel.button("one").label == "one"
    assert list(numbers(page)) == ["Gripper", "one"]


def test_a_callback_that_raises_is_named_and_not_called_again(page, panel, caplog):
    calls = []

    def close():
        calls.append(1)
        raise ZeroDivisionError("a mistake")

    panel.button("Close", on_press=close)
    other = panel.checkbox("other")
    known = numbers(page)
    with caplog.at_level(logging.ERROR):
        ask(page, "Press", control=known["Close"])
    (line,) = caplog.messages
    what = "button 'Close' of the panel 'Gripper' has failed, and is not called again: ZeroDivisionError: a mistake ("
    assert line.startswith(what)
    assert "test_own_panels.py:" in line
    assert texts(page.twin.findings, Kind.FAILED)[-1].startswith("button 'Close' of the panel 'Gripper': ZeroDivision")
    seen = shown(page)
    assert seen["problems"][known["Close"]].startswith(what)
    assert seen["disabled"] == [known["Close"]]
    ask(page, "Press", control=known["Close"])
    ask(page, "Set", control=known["other"], value=True)
    assert (len(calls), other.value) == (1, True)
    page.twin.advance_to(0.1)


def test_a_callback_that_refuses_leaves_the_value_and_is_called_again(page, panel):
    def publish(value):
        page.twin.publish(WHEELS_1, [value] * (4 if value < 3 else 5))

    speed = panel.slider("speed", 0, 5, on_change=publish)
    number = numbers(page)["speed"]
    ask(page, "Set", control=number, value=2)
    ask(page, "Set", control=number, value=4)
    assert speed.value == 2
    assert "speed" in shown(page)["problems"][number]
    ask(page, "Set", control=number, value=1)
    assert speed.value == 1
    assert shown(page)["problems"] == {}


def test_a_disabled_control_refuses(page, panel):
    speed = panel.slider("speed", 0, 5)
    speed.enabled = False
    number = numbers(page)["speed"]
    ask(page, "Set", control=number, value=2)
    assert speed.value == 0
    assert shown(page)["disabled"] == [number]


def test_views_are_read_only_while_a_tab_shows_their_panel(page, panel):
    calls = []
    panel.plot("height", lambda: calls.append("plot") or 1.0)
    panel.table("names", lambda: calls.append("table") or {"a": 1})
    panel.image("eye", lambda: calls.append("image") or np.zeros((2, 3), dtype=np.uint8))
    own = page.cockpit.panels["own"]
    look(page)
    for _ in range(9):
        page.cockpit.publish()
    assert calls == []
    assert own.state()["read"] == {}
    shown(page)
    for _ in range(6):
        own.state()
    assert (calls.count("plot"), calls.count("image")) == (7, 3)  # images at once, then at each third
    for _ in range(60):
        own.state()
    calls.clear()
    assert own.state() == {"version": own._parts.version}  # the tab has not asked for 4 s
    assert calls == []


def test_an_image_is_sent_when_it_changes_and_to_those_who_lack_it(page, panel):
    picture = np.arange(24, dtype=np.uint8).reshape(2, 4, 3)
    panel.image("eye", lambda: picture)
    number, own = numbers(page)["eye"], page.cockpit.panels["own"]
    known = list(numbers(page).values())
    look(page, own._parts.version, 0, known)
    sent = [own.state() for _ in range(9)]
    (png,) = (state["images"][number] for state in sent if state["images"])
    assert np.array_equal(np.asarray(Image.open(io.BytesIO(base64.b64decode(png)))), picture)
    look(page, own._parts.version, own._newest_image, known)
    assert [own.state()["images"] for _ in range(6)] == [{}] * 6
    look(page, own._parts.version, 0, known)  # another tab
    assert own.state()["images"] == {number: png}
    assert own.state()["images"] == {}


@pytest.mark.parametrize(
    ("kind", "value", "content"),
    [
        ("plot", 2, {"it": 2.0}),
        ("plot", np.array([1.0, NAN]), {"1": 1.0, "2": None}),
        ("plot", {"x": np.float32(0.5)}, {"x": 0.5}),
        ("plot", "much", "'much' is not a number to plot"),
        ("plot", range(41), "a plot has 40 curves at most"),
        ("table", {"a": 0.123456789, "b": [1, "<b>"]}, [["a", "0.123457"], ["b", "1", "<b>"]]),
        ("table", [(1, 2), (3, True)], [["1", "2"], ["3", "True"]]),
        ("table", 3, "3 is not a mapping or a list of rows"),
        ("table", [[1]] * 201, "a table has 200 rows and 20 columns at most"),
        ("image", np.zeros((2, 2)), "not an array of float64, shape (2, 2)"),
        ("image", None, "not an array of object, shape ()"),
    ],
)
def test_what_a_function_returns_is_shown_or_its_fault(page, panel, kind, value, content):
    getattr(panel, kind)("it", lambda: value)
    number = numbers(page)["it"]
    seen = [shown(page) for _ in range(3)][-1]  # an image is read less often
    if isinstance(content, str):
        assert content in seen["problems"][number]
    else:
        assert seen["read"][number] == content


def test_a_plot_of_a_robot_goes_on_when_the_robot_is_there_again(page, panel):
    twin = page.twin
    panel.plot("x", lambda: twin.robot_state("robot_1").base_pose[0])
    number = numbers(page)["x"]
    assert shown(page)["read"] == {number: {"x": 0.0}}
    robot = twin.scenario.robots[0]
    twin.entities.delete("robot_1")
    seen = shown(page)
    assert (seen["read"], "robot_1" in seen["problems"][number]) == ({}, True)
    twin.entities.spawn(robot)
    seen = shown(page)
    assert (seen["read"], seen["problems"]) == ({number: {"x": 0.0}}, {})
    assert texts(twin.findings, Kind.FAILED) == ()


def test_markers_are_drawn_moved_and_hidden(page, panel):
    scene, twin = page.cockpit._scene, page.twin
    goal = panel.marker("goal", (1, 2, 3), shape="box")
    base = panel.marker("base", lambda: twin.robot_state("robot_1").base_pose[:3])
    path = f"/overlays/own/{numbers(page)['goal']}"
    assert not scene.has_path("/overlays/own")
    page.cockpit.draw()
    assert scene.has_path(path)
    assert base.xyz == pytest.approx(twin.robot_state("robot_1").base_pose[:3])
    goal.xyz = (0, 0, 1)
    page.cockpit.draw()
    ask(page, "Set", control=numbers(page)["goal"], value=False)
    assert not goal.visible
    page.cockpit.draw()
    assert not scene.has_path(path)
    goal.visible = True
    page.cockpit.draw()
    assert scene.has_path(path)
    twin.entities.delete("robot_1")
    page.cockpit.draw()
    assert not scene.has_path(f"/overlays/own/{numbers(page)['base']}")  # its function cannot tell
    assert scene.has_path(path)
    panel.remove()
    page.cockpit.draw()
    assert not scene.has_path("/overlays/own")


def test_no_browser_no_markers(page, panel):
    panel.marker("goal", (1, 2, 3))
    page.cockpit.process_requests()
    assert page.cockpit._scene.has_path("/overlays/own")
    page.server.clients, page.server.is_watched = (), False
    page.cockpit.process_requests()
    assert not page.cockpit._scene.has_path("/overlays/own")


def test_a_panel_replaces_the_one_of_its_title_and_is_removed(page, panel):
    panel.button("old")
    again = page.cockpit.panels["own"].add("Gripper")
    again.button("new")
    assert list(numbers(page)) == ["Gripper", "new"]
    again.remove()
    again.remove()
    assert numbers(page) == {}
    assert repr(panel.title) == "'Gripper'"


def test_a_recording_replays_without_the_panel(page, panel):
    twin = page.twin
    twin.recorder.begin()
    panel.slider("speed", -5, 5, on_change=lambda value: twin.publish(WHEELS_1, [value] * 4))
    twin.advance_to(0.1)
    ask(page, "Set", control=numbers(page)["speed"], value=3)
    twin.advance_to(0.3)
    assert twin.robot_state("robot_1").base_pose[0] > 0.001
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_a_callback_that_moves_the_state_by_drakes_methods_has_failed(page, panel):
    def cheat():
        plant, context = page.twin.plant, page.twin.context
        mine = plant.GetMyMutableContextFromRoot(context)
        plant.SetPositions(mine, plant.GetPositions(mine) + 0.1)

    panel.button("cheat", on_press=cheat)
    ask(page, "Press", control=numbers(page)["cheat"])
    assert "Drake's own methods" in texts(page.twin.findings, Kind.FAILED)[-1]


@pytest.fixture
def registered(monkeypatch):
    monkeypatch.setattr(PAGE_PANELS, "_kinds", PAGE_PANELS._kinds.new_child())


def test_registered_panels_are_filled_for_each_twin_and_one_that_fails_is_named(registered, caplog):
    @page_panel("Gripper")
    def gripper(panel, twin):
        panel.button(f"of {twin.robots[0]}")

    @page_panel("Broken")
    def broken(panel, twin):
        panel.button("first")
        panel.slider("width", 1, 0)

    with caplog.at_level(logging.ERROR):
        page = FakePage(rovers(1).build())
    assert "page panel 'Broken' has failed" in caplog.text
    assert list(numbers(page)) == ["Gripper", "of robot_1", "Broken", "first"]
    look(page)
    problems = [item["problem"] for item in page.cockpit.panels["own"].state()["panels"]]
    assert problems[0] == ""
    assert "the range from 1 to 0 is empty" in problems[1]
    with pytest.raises(InputError, match="'Gripper' is registered by"):
        page_panel("Gripper")(broken)
    with pytest.raises(InputError, match="cannot be a name on the page"):
        page_panel("")
    page.cockpit.close()


def test_a_panel_that_is_refused_stops_no_other_from_drawing(page, panel):
    class Refused:
        def draw(self, scene, time):
            raise InputError("not now")

    page.cockpit.panels = {"refused": Refused(), **page.cockpit.panels}
    panel.marker("goal", (1, 2, 3))
    page.cockpit.draw()
    assert page.cockpit._scene.has_path("/overlays/own")
