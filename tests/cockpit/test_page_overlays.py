"""Overlays as a real browser has them in its scene: they go with the links, and are seen."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, open_tab, page, picture, show
from conftest import ARM, rovers
from in_scene import look_at, place_of, tools
from robots_to_steer import WHEELS_1
from show_menu import press
from test_ghosts import TRAJECTORIES, TRAJECTORY
from test_water_and_wind import label
from waters import layers
from winds import windy_world

from drake_twin import TwinBuilder
from drake_twin.scenario import World

pytestmark = BROWSER_TESTS

PLACE = """(frame, path) => {
  const { shownViewer: viewer, MeshCat } = frame.contentWindow;
  const { object } = viewer.scene_tree.find(path.split("/"));
  viewer.scene.updateMatrixWorld(true);
  const at = frame.contentWindow.sceneTools.twin.worldToLocal(object.getWorldPosition(new MeshCat.THREE.Vector3()));
  let isVisible = true;
  for (let each = object; each; each = each.parent) isVisible &&= each.visible;
  let meshes = 0;
  object.traverse(({ isMesh }) => (meshes += isMesh ? 1 : 0));
  return { at: at.toArray(), isVisible, meshes };
}"""


def place(tab, path):
    """Where the object of a path is (m, in the world), whether it is visible, and how many meshes it has."""
    return tab.locator("#scene").evaluate(PLACE, path)


def has_color(shot, color, spread=30):
    """How many pixels have nearly a color."""
    return int((np.abs(shot - np.array(color)).max(axis=2) < spread).sum())


def test_shapes_go_with_the_links_though_no_pose_is_sent_for_them(page):
    it, tab = page
    press(tab, "Collision shapes")
    it.frames(lambda: "collision" in it.cockpit._overlays)
    it.twin.publish(WHEELS_1, [6, 6, 6, 6])
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 0.3)
    it.twin.pause()
    it.for_frames(5)
    for link in ("robot_1_base_link", "robot_1_rear_left_wheel"):
        body = it.twin.plant.GetBodyByName(link)
        truth = body.EvalPoseInWorld(it.twin.plant.GetMyContextFromRoot(it.twin.context)).translation()
        found = place(tab, f"overlays/collision/on/robot_1/{link}")
        assert found["isVisible"]
        assert found["at"] == pytest.approx(truth, abs=1e-3)


def test_a_track_is_seen_behind_the_robot_and_is_gone_with_its_switch(page):
    it, tab = page
    it.twin.publish(WHEELS_1, [8, 8, 8, 8])
    tab.keyboard.press("t")
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 1.0)
    it.twin.pause()
    look_at(tab, "robot_1", "robot_2")
    it.for_frames(5)
    blue = (38, 99, 168)
    shown = picture(tab)
    tab.keyboard.press("t")
    it.frames(lambda: "tracks" not in it.cockpit._overlays)
    it.for_frames(3)
    shown[np.abs(shown - picture(tab)).sum(axis=2) < 30] = 255  # the page's own controls are blue, too
    assert has_color(shown, blue, spread=50) > 15


def test_ghosts_of_the_start_stay_there_with_all_meshes(page):
    it, tab = page
    tab.keyboard.press("o")
    it.twin.publish(WHEELS_1, [8, 8, 8, 8])
    it.frames(lambda: it.twin.robot_state("robot_1").base_pose[0] > 0.5)
    ghost, robot = (place(tab, f"{folder}/robot_1/robot_1_base_link") for folder in ("overlays/starts", "twin"))
    assert ghost["at"] == pytest.approx([0, 0, 0.13], abs=0.02)
    assert robot["at"][0] > 0.4
    assert ghost["meshes"] == robot["meshes"] > 0


def test_a_goals_ghost_stands_where_the_arm_arrives_and_goes_then(show, tmp_path):
    file = tmp_path / "controllers.yaml"
    file.write_text(TRAJECTORIES)
    it, tab = show(TwinBuilder().robot("arm", ARM, controllers=str(file)).scenario())
    tab.keyboard.press("g")
    point = {"positions": [0.9, 0.5, -0.4], "time_from_start": 1.0}
    it.twin.publish(TRAJECTORY, {"joint_names": ["joint_1", "joint_2", "joint_3"], "points": [point]})
    links = [path.partition("/")[2] for path in it.scene.shared(it.twin).bodies]
    it.frames(lambda: it.scene.has_path("/overlays/goals"))
    paths = [path for path in it.scene.everything().paths() if path.startswith("/overlays/goals")]
    assert len(paths) == len(links)
    paths = [path.lstrip("/") for path in paths]
    it.frames(lambda: all(place(tab, path)["meshes"] for path in paths))
    goals = {path.rpartition("/")[2]: place(tab, path) for path in paths}
    assert all(goal["isVisible"] for goal in goals.values())
    start = it.twin.time
    it.frames(lambda: it.twin.time > start + 1.5)
    it.frames(lambda: not any(place(tab, path)["isVisible"] for path in paths))
    for link, goal in goals.items():
        assert place(tab, f"twin/arm/{link}")["at"] == pytest.approx(goal["at"], abs=0.02)


def test_balls_of_centers_of_mass_are_seen_through_the_robot(page):
    it, tab = page
    it.twin.pause()
    look_at(tab, "robot_1", "robot_2")
    it.for_frames(3)
    before = picture(tab)
    tab.keyboard.press("m")
    it.frames(lambda: "masses" in it.cockpit._overlays)
    it.for_frames(3)
    at = place(tab, "overlays/masses/robots/robot_2")["at"]
    rows, columns = np.nonzero(np.abs(picture(tab) - before).sum(axis=2) > 60)
    box = tab.locator("#scene").bounding_box()
    x, y = place_of(tab, at)
    assert np.hypot(rows + box["y"] - y, columns + box["x"] - x).min() < 3
    assert len(rows) > 30
    plant = it.twin.plant
    context, instance = plant.GetMyContextFromRoot(it.twin.context), plant.GetModelInstanceByName("robot_2")
    assert at == pytest.approx(plant.CalcCenterOfMassPositionInWorld(context, [instance]), abs=1e-3)


def test_frames_have_their_names_which_do_not_overlap(page):
    it, tab = page
    it.twin.pause()
    tab.keyboard.press("y")
    look_at(tab, "robot_1")
    labels = tab.frame_locator("#scene").locator(".name.small")
    links = {link.child_frame_id for topic in ("/tf", "/tf_static") for link in it.twin.latest(topic).transforms}
    it.frames(lambda: set(labels.all_text_contents()) & links)
    picture(tab)
    assert set(labels.all_text_contents()) <= links
    shown = tab.frame_locator("#scene").locator(".name.small:not([hidden])")
    boxes = [shown.nth(index).bounding_box() for index in range(shown.count())]
    assert len(boxes) > 2
    for index, one in enumerate(boxes):
        for other in boxes[:index]:
            (left, right), (upper, lower) = (sorted((one, other), key=lambda box: box[axis]) for axis in "xy")
            apart_x = right["x"] - left["x"] >= left["width"] - 1
            assert apart_x or lower["y"] - upper["y"] >= upper["height"] - 1
    tab.keyboard.press("y")
    it.frames(lambda: labels.count() == 0)


def test_the_ranges_of_joints_are_those_of_the_selected_robot(page):
    it, tab = page
    tab.keyboard.press("j")
    it.frames(lambda: "joints" in it.cockpit._overlays)

    def visible(robot):
        it.for_frames(3)
        return place(tab, f"overlays/joints/on/{robot}/{robot}_base_link/limits")["isVisible"]

    it.frames(lambda: not visible("robot_1") and not visible("robot_2"))
    open_tab(tab, "World")
    item = tab.locator("[role=treeitem]", has_text="robot_2").first
    it.frames(item.is_visible)
    item.click(force=True)
    it.frames(lambda: tools(tab, "selected.length") > 0)
    it.frames(lambda: visible("robot_2"))
    assert not visible("robot_1")


def test_in_a_browser_water_is_over_what_is_below_its_surface_alone(show, tmp_path):
    """Of rovers that do not float, and whose masts are higher; the water has no shadow, and the wind its speed."""
    water = layers((0.33, 0.0)).replace("</plugin>", "<enable>nothing</enable></plugin>")
    file = windy_world(tmp_path, water, "6 2 0", 9.81)
    it, tab = show(rovers(2, world=World(file=str(file), ground=True)).scenario())
    it.twin.pause()
    it.frames(lambda: bool(tools(tab, f"boxOf({list(it.twin.robots)})")))
    it.for_frames(3)
    before = picture(tab)
    tab.keyboard.press("u")
    it.frames(lambda: abs(place(tab, "overlays/fluids/surfaces/0")["at"][2] - 0.33) < 0.01)
    it.for_frames(3)
    after = picture(tab)
    box = tab.locator("#scene").bounding_box()
    scale = after.shape[1] / box["width"]

    def change(point):
        x, y = place_of(tab, point)
        row, column = round(scale * (y - box["y"])), round(scale * (x - box["x"]))
        return after[row, column].astype(int) - before[row, column].astype(int)

    roof, ground, far_ground, mast = map(change, [(-0.1, 0, 0.24), (0.5, 1, 0), (-8, 6, 0), (0.21, 0, 0.42)])
    for red, _, blue in (roof, ground, far_ground):
        assert blue - red > 30
    assert ground == pytest.approx(far_ground, abs=15)
    assert np.abs(mast).max() < 10
    assert label(it.scene) == "wind 6.3 m/s"
    tab.keyboard.press("u")
    it.frames(lambda: not it.scene.has_path("/overlays/fluids"))
