"""The camera on the page, in a real Chromium: it fits what is there and what is selected; presets, names, help."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, draw, open_tab, page, show
from conftest import ARM, ROVER, rovers
from in_scene import item, look_at, place_of, tools
from show_menu import press
from world_with_crate import rover_and_crate

from drake_twin import TwinBuilder

pytestmark = BROWSER_TESTS

SIZES = ((1280, 800), pytest.param((1920, 1080), marks=pytest.mark.slow), (390, 844))


def place_of_middle(tab):
    """The middle of the scene on the page (pixels)."""
    box = tab.locator("#scene").bounding_box()
    return box["x"] + box["width"] / 2, box["y"] + box["height"] / 2


def are_seen(tab, points):
    box = tab.locator("#scene").bounding_box()
    places = [tools(tab, f"onPicture({list(map(float, point))})") for point in points]
    return all(at["isAhead"] and 0 < at["x"] < box["width"] and 0 < at["y"] < box["height"] for at in places)


@pytest.mark.parametrize("size", SIZES)
def test_an_arm_is_seen_whole_from_the_start(browser, size):
    from browser import Shown

    it = Shown(browser, TwinBuilder().robot("arm", ARM).scenario())
    tab = it.tab()
    tab.set_viewport_size({"width": size[0], "height": size[1]})
    it.frames(lambda: bool(tools(tab, "boxOf(['arm'])")))
    it.for_frames(10)
    box = tools(tab, "boxOf(['arm'])")
    ends = [[box[end][axis] for axis in "xyz"] for end in ("min", "max")]
    points = [(x[0], -z[2], y[1]) for x in ends for y in ends for z in ends]  # three.js has y upwards
    it.frames(lambda: are_seen(tab, points))
    middle = np.mean(points, axis=0)
    assert place_of(tab, map(float, middle)) == pytest.approx(place_of_middle(tab), abs=2)
    tab.mouse.move(*place_of_middle(tab))
    tab.mouse.wheel(0, -200)
    it.frames(lambda: tools(tab, "isTouched"))
    camera = tools(tab, "cameraPlace()")
    tab.set_viewport_size({"width": size[0], "height": size[1] - 100})
    it.for_frames(5)
    assert tools(tab, "cameraPlace()") == pytest.approx(camera, abs=1e-3)  # it stays where a person moved it
    it.close()
    assert it.faults == []


def test_presets_look_from_where_they_say_and_fit_shows_the_selection(show, tmp_path):
    it, tab = show(rover_and_crate(tmp_path).scenario())
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
    it.for_frames(5)

    def view():
        """From the camera's target to the camera, in the world, of length one; and the distance."""
        x, y, z, tx, ty, tz = tools(tab, "cameraPlace()")
        away = np.array([x - tx, tz - z, y - ty])  # three.js has y upwards
        return away / np.linalg.norm(away), np.linalg.norm(away)

    open_tab(tab, "View")
    for name, key, expected in (
        ("Front view", "2", (1, 0, 0)),
        ("Left view", "3", (0, 1, 0)),
        ("Top view", "4", (0, 0, 1)),
    ):
        tab.keyboard.press("1")
        assert view()[0] == pytest.approx(np.array([0.75, -0.65, 0.4]) / np.linalg.norm([0.75, -0.65, 0.4]), abs=1e-6)
        tab.keyboard.press(key)
        assert view()[0] == pytest.approx(expected, abs=0.2)
        tab.keyboard.press("1")
        tab.get_by_role("button", name=name).click()
        assert view()[0] == pytest.approx(expected, abs=0.2)
    open_tab(tab, "World")
    item(tab, "model:crate::crate").click()
    it.frames(lambda: tools(tab, "selected.length") == 1)
    open_tab(tab, "View")
    tab.get_by_role("button", name="Fit the selection").click()
    _, _, _, tx, ty, tz = tools(tab, "cameraPlace()")
    assert (tx, -tz, ty) == pytest.approx(it.twin.entities.state("crate").position, abs=0.01)
    # Its upper face, with sides of 0.4 m, is seen with a quarter more around it; the field of view is 50°.
    distance = 0.2 + 1.25 * 0.2 / np.tan(np.deg2rad(50 / 2))
    assert view()[1] == pytest.approx(distance, rel=0.02)
    assert view()[0] == pytest.approx((0, 0, 1), abs=0.05)  # as before


def test_a_double_click_brings_what_is_there_into_the_picture_and_the_ground_nothing(show, tmp_path):
    it, tab = show(rover_and_crate(tmp_path).scenario())
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
    it.frames(lambda: bool(tools(tab, "boxOf(['crate'])")))
    look_at(tab, "rover", "crate")
    it.for_frames(3)
    before = tools(tab, "cameraPlace()")
    x, y, _ = it.twin.entities.state("crate").position
    tab.mouse.dblclick(*place_of(tab, (x + 0.5, y, 0.0)))
    assert tools(tab, "cameraPlace()") == before
    tab.mouse.dblclick(*place_of(tab, (x, y, 0.4)))
    it.for_frames(10)
    it.frames(lambda: tools(tab, "cameraPlace()") != before)
    _, _, _, tx, ty, tz = tools(tab, "cameraPlace()")
    assert (tx, -tz, ty) == pytest.approx(it.twin.entities.state("crate").position, abs=0.01)
    assert tools(tab, "selected.length") == 1


def test_names_stand_above_robots_and_follow_them(page):
    it, tab = page
    names = tab.frame_locator("#scene").locator(".name")
    assert names.count() == 0
    draw(tab)  # they are laid above the picture
    press(tab, "Names")
    it.frames(lambda: names.count() == 2)
    assert names.all_inner_texts() == ["robot_1", "robot_2"]

    def middle():
        return names.nth(0).evaluate("""name => {
          const box = name.getBoundingClientRect();
          return box.x + box.width / 2 + window.frameElement.getBoundingClientRect().x;
        }""")

    it.frames(lambda: abs(middle() - place_of(tab, (0, 0, 0.4))[0]) < 12)
    it.twin.entities.place("robot_1", (0, -0.7, 0.13))
    it.frames(lambda: abs(middle() - place_of(tab, (0, -0.7, 0.4))[0]) < 12)
    it.twin.entities.delete("robot_2")
    it.frames(lambda: names.count() == 1)
    press(tab, "Names")
    it.frames(lambda: names.count() == 0)


def test_the_help_opens_with_a_key_and_a_button_and_closes(page):
    it, tab = page
    for open_ in (lambda: tab.keyboard.press("?"), lambda: tab.get_by_role("button", name="Keys and mouse").click()):
        open_()
        it.frames(lambda: tab.locator("#help").is_visible())
        assert "Fit the selection" in tab.locator("#help").inner_text()
        tab.keyboard.press("Escape")
        it.frames(lambda: not tab.locator("#help").is_visible())


def test_control_z_undoes_an_edit(show, tmp_path):
    it, tab = show(rover_and_crate(tmp_path).scenario())
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
    open_tab(tab, "World")
    item(tab, "model:crate::crate").click()
    it.frames(lambda: tab.locator(".edits").get_by_role("button", name="Delete").is_visible())
    tab.locator(".edits").get_by_role("button", name="Delete").click()
    it.frames(lambda: item(tab, "model:crate::crate").count() == 0)
    it.frames(lambda: tab.get_by_role("button", name="Undo the last edit").is_visible())
    tab.keyboard.press("Control+z")
    it.frames(lambda: item(tab, "model:crate::crate").count() == 1)
