"""What is around the robots in the scene, as pixels of a real Chromium: the ground's grid, shadows, sky, the view."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, open_tab, orange, page, picture, show
from conftest import ARM, ROVER, rovers
from in_scene import tools
from show_menu import press

from drake_twin import TwinBuilder
from drake_twin.builder.demo import demo_scenario
from drake_twin.cockpit.scene import OVERLAYS
from drake_twin.scenario import Robot, World

pytestmark = BROWSER_TESTS


def shown(it, tab, key="4", above=None):
    """The picture of a paused twin from above, or from so far above (m), and its brightness at points of the world."""
    it.twin.pause()
    it.frames(lambda: bool(tools(tab, f"boxOf({list(it.twin.robots)})")))
    it.for_frames(5)
    tab.keyboard.press(key)
    it.for_frames(2)
    if above is not None:
        tools(tab, f"placeCamera([0, {above}, 1e-6, 0, 0, 0])")
    shot = picture(tab).sum(axis=2) / 765

    def brightness(x, y, z=0.0):
        at = tools(tab, f"onPicture([{x}, {y}, {z}])")
        row, column = round(at["y"]), round(at["x"])
        return float(shot[row - 1 : row + 2, column - 1 : column + 2].mean())

    return shot, brightness


def test_a_robot_has_a_shadow_on_the_side_away_from_the_sun(show):
    """The sun is to the front, a little to the right: a shadow falls to the rear, half as long as the robot is high."""
    it, tab = show(TwinBuilder().robot("arm", ARM).scenario())
    _, brightness = shown(it, tab, above=2.5)
    lit = brightness(0.6, -0.42)
    assert lit == pytest.approx(brightness(0.6, 0.42), abs=0.06)
    places = [(-0.55 * height, 0.11 * height) for height in np.linspace(0.15, 0.6, 10)]
    shadowed = [brightness(x, y) < 0.75 * lit for x, y in places]
    across = [brightness(-x, -y) < 0.75 * lit for x, y in places]
    assert sum(shadowed) >= 2
    assert sum(shadowed) > sum(across)


def test_the_ground_has_a_grid_of_a_metre(show):
    """Lines at whole metres are darker than the ground between them, along both axes, also far from the robot."""
    it, tab = show(rovers(2).scenario())
    _, brightness = shown(it, tab)
    between = np.array([brightness(x + 0.55, y + 0.45) for x in (-2, -1, 0) for y in (1, 2)])
    for lines in (
        [brightness(x, y + 0.45) for x in (-2, -1, 0) for y in (1, 2)],
        [brightness(x + 0.55, y) for x in (-2, -1, 0) for y in (1, 2)],
    ):
        assert np.median(lines) < 0.95 * np.median(between)


def test_the_ground_fades_into_the_sky(show):
    """There is no edge at the horizon: from row to row the picture changes little above the robots."""
    it, tab = show(rovers(1).scenario())
    shot, _ = shown(it, tab, key="2")
    column = np.median(shot[2 : shot.shape[0] // 2, :40], axis=1)
    assert np.abs(np.diff(column)).max() < 0.12


def test_the_sky_is_dark_where_the_browser_is(show):
    it, tab = show(rovers(1).scenario())
    light = shown(it, tab, key="2")[0][:20].mean()
    tab.emulate_media(color_scheme="dark")
    assert shown(it, tab, key="2")[0][:20].mean() < 0.5 * light
    tab.emulate_media(color_scheme="light")
    assert shown(it, tab, key="2")[0][:20].mean() == pytest.approx(light, abs=0.02)


def test_one_robot_fills_a_third_of_the_first_picture(show):
    it, tab = show(demo_scenario("rover", 1, drive=False))
    it.twin.pause()
    it.for_frames(5)
    shot = picture(tab)
    rows, columns = orange(shot)
    assert np.ptp(columns) > shot.shape[1] / 3 or np.ptp(rows) > shot.shape[0] / 3


def test_robots_that_drive_away_stay_in_the_picture_until_the_camera_is_moved(show):
    """The second one stands where no first picture would show it, once it is spawned."""
    it, tab = show(demo_scenario("rover", 1, drive=False))
    it.for_frames(5)

    def is_seen():
        return tools(tab, "areSeen(['robot_1'])")

    assert is_seen()
    for x in (3.0, 30.0):
        it.twin.entities.place("robot_1", (x, 1.0, 0.1))
        it.frames(is_seen)
    tab.mouse.move(300, 300)
    tab.mouse.wheel(0, -100)
    it.frames(lambda: tools(tab, "isTouched"))
    it.twin.entities.place("robot_1", (-30.0, 1.0, 0.1))
    it.for_frames(10)
    assert not is_seen()


def test_names_do_not_overlap_and_the_nearest_robots_has_one(show):
    it, tab = show(rovers(8).scenario())
    it.twin.pause()
    it.for_frames(5)
    press(tab, "Names")
    tab.keyboard.press("3")
    picture(tab)
    labels = tab.frame_locator("#scene").locator(".name:not([hidden])")
    boxes = [labels.nth(index).bounding_box() for index in range(labels.count())]
    assert 3 <= len(boxes) < 8  # three lines of one place, and what is beside it
    for index, one in enumerate(boxes):
        for other in boxes[:index]:
            (left, right), (upper, lower) = (sorted((one, other), key=lambda box: box[axis]) for axis in "xy")
            apart_x = right["x"] - left["x"] >= left["width"] - 1
            assert apart_x or lower["y"] - upper["y"] >= upper["height"] - 1
    assert "robot_8" in labels.all_inner_texts()  # it is the nearest of them from the left


def test_what_is_deleted_leaves_nothing_on_the_graphics_card(show):
    """The arm's meshes come from files, each of which Meshcat reads into a group of parts."""
    it, tab = show(TwinBuilder().robot("arm", ARM).scenario())
    it.twin.pause()

    def held():
        picture(tab)
        return tab.locator("#scene").evaluate("frame => ({ ...frame.contentWindow.shownViewer.renderer.info.memory })")

    it.frames(lambda: bool(tools(tab, "boxOf(['arm'])")))
    it.for_frames(10)
    before = held()
    for _ in range(3):
        it.twin.entities.spawn(Robot("other", ROVER, xyz=(0.8, 0, 0.13)))  # two arms would share their geometries
        it.frames(lambda: bool(tools(tab, "boxOf(['other'])")))
        it.for_frames(10)
        assert held()["geometries"] > before["geometries"]
        it.twin.entities.delete("other")
        it.frames(lambda: not tools(tab, "boxOf(['other'])"))
        it.for_frames(3)
    after = held()
    assert after["geometries"] <= before["geometries"]
    assert after["textures"] <= before["textures"]


def standing(folder, *boxes):
    """A robot that is part of the world: boxes of a size at places (m)."""
    visuals = "".join(
        f'<visual><origin xyz="{at}"/><geometry><box size="{size}"/></geometry></visual>' for size, at in boxes
    )
    (folder / "drawn.urdf").write_text(
        f'<robot name="drawn"><link name="world"/><link name="base">{visuals}</link><joint name="fixed" type="fixed">'
        '<parent link="world"/><child link="base"/></joint></robot>'
    )
    return TwinBuilder().robot("drawn", str(folder / "drawn.urdf"))


def seen_from(it, tab, eye, target):
    """The picture from a place to another one (m, in the world), and a function that gives colors around a point."""
    it.twin.pause()
    it.frames(lambda: bool(tools(tab, f"boxOf({list(it.twin.robots)})")))
    it.for_frames(3)
    place = [number for x, y, z in (eye, target) for number in (x, z, -y)]
    tools(tab, f"placeCamera({place})")
    shot = picture(tab)

    def around(x, y, z=0.0):
        at = tools(tab, f"onPicture([{x}, {y}, {z}])")
        row, column = round(at["y"]), round(at["x"])
        return shot[row - 1 : row + 2, column - 1 : column + 2].mean(axis=(0, 1))

    return shot, around


def test_what_has_gone_far_beyond_the_cameras_target_has_a_shadow(show, tmp_path):
    """1 m high over the ground, and 4 m behind a target that is 3.4 m away; the shadow falls 0.56 m to the rear."""
    it, tab = show(standing(tmp_path, ("0.6 0.6 0.2", "0 4 1")).scenario())
    _, around = seen_from(it, tab, (0, -3, 1.5), (0, 0, 0))
    assert around(-0.56, 4.1).sum() < 0.85 * around(0.7, 4.1).sum()


def test_points_just_inside_a_wall_are_seen(show, tmp_path):
    """What a lidar measures is behind the surface as often as before it."""
    it, tab = show(standing(tmp_path, ("0.2 2 2", "0 0 1")).scenario())
    points = np.array([[0.1 - 0.03, 0.02 * y, 1.0] for y in range(-9, 10)])
    it.scene.set_points(f"{OVERLAYS}/measured", points, (1.0, 0.0, 0.0), 0.04)
    _, around = seen_from(it, tab, (3, 0, 1.5), (0, 0, 1))
    red, green, _ = around(0.1, 0.0, 1.0)
    assert red > 3 * green


def test_the_ground_of_gazebos_worlds_has_no_end(show, tmp_path):
    """A plane has none in its physics; the SDF file's 100 m are what Gazebo draws of it."""
    plane = "<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>"
    brown = "<material><diffuse>0.6 0.3 0.1 1</diffuse></material>"
    (tmp_path / "plain.sdf").write_text(
        '<sdf version="1.9"><world name="plain"><model name="ground_plane"><static>true</static><link name="link">'
        f'<visual name="seen">{plane}{brown}</visual><collision name="felt">{plane}</collision></link></model>'
        "</world></sdf>"
    )
    it, tab = show(rovers(1, world=World(file=str(tmp_path / "plain.sdf"))).scenario())
    _, around = seen_from(it, tab, (-20, 0, 8), (20, 0, 0))
    for x in (40.0, 75.0, 90.0):
        red, _, blue = around(x, 3.0)
        assert red > 2 * blue, x
