"""Parts that look alike are drawn together: fewer calls, the same picture."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, changed, orange_bodies, picture, show
from conftest import ROVER, rovers
from in_scene import look_at, tools
from test_page_looks import part, robot

from drake_twin.scenario import Robot

pytestmark = BROWSER_TESTS

FEW = 12  # calls: more kinds of parts, as those near the camera have finer shapes
EACH_BY_ITSELF = "viewer.redraw = () => viewer.set_dirty();"  # in place of alike.js
CALLS = """({ contentWindow: { shownViewer } }) => {
  shownViewer.render();
  return shownViewer.renderer.info.render.calls;
}"""
TIES = 60  # pixels of sides in the same place, of which the one that is drawn first is seen
FAR, NEAR = [-9.0, 0.0, 4.0], [-0.5, 0.3, 0.2]  # m, from the first robot's place


MIRRORED = """({ contentWindow: { sceneTools, shownViewer } }) => {
  const wedges = [];
  sceneTools.twin.traverse((part) => part.geometry?.attributes.position.count === 12 && wedges.push(part));
  for (const part of wedges.slice(3)) Object.assign(part, { matrixAutoUpdate: true }).scale.set(1, -1, 1);
  shownViewer.redraw();
  return wedges.length;
}"""


def still(it, tab):
    """Pause the twin, once all robots are drawn."""
    it.twin.pause()
    it.frames(lambda: bool(tools(tab, f"boxOf({list(it.twin.robots)})")))
    it.for_frames(5)


def seen(tab):
    """The picture above the timeline."""
    shot = picture(tab)
    return shot[: int(0.88 * len(shot))]


def looked(tab, away):
    """The picture from a place (m, in the world), towards the first robot."""
    x, y, z = away
    tools(tab, f"placeCamera([{x}, {z}, {-y}, 0, 0.15, 0])")
    return seen(tab)


def by_themselves(it, tab):
    """Draw each part by itself from now on."""
    tab.route("**/alike.js", lambda route: route.fulfill(body=EACH_BY_ITSELF, content_type="text/javascript"))
    tab.reload()
    it.frames(lambda: tab.locator("body.ready").count() == 1)
    it.frames(lambda: bool(tools(tab, f"boxOf({list(it.twin.robots)})")))
    it.for_frames(5)


def test_more_robots_need_few_more_calls(show):
    calls = {}
    for count in (4, 12):
        it, tab = show(rovers(count).scenario())
        still(it, tab)
        look_at(tab, *it.twin.robots)
        picture(tab)
        calls[count] = tab.locator("#scene").evaluate(CALLS)
    assert calls[12] <= calls[4] + FEW
    assert calls[12] < 12 * 5  # the wheels and the body of each


def test_the_picture_is_that_of_parts_drawn_one_by_one(show):
    it, tab = show(rovers(4).scenario())
    still(it, tab)
    together = {away: looked(tab, away) for away in map(tuple, (FAR, NEAR))}
    by_themselves(it, tab)
    for away, shot in together.items():
        one_by_one = looked(tab, away)
        assert changed(shot, one_by_one) < 0.003 * shot[..., 0].size, away
    assert changed(*together.values()) > 0.03 * shot[..., 0].size  # robots are a good part of the nearer one


def test_mirrored_parts_are_the_right_way_round(show, tmp_path):
    """Three wedges and three mirror images of them, seen as when each is drawn by itself.

    The twin's own meshes are mirrored before they are drawn; a panel's may be mirrored where they are.
    """
    faces = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n"
    (tmp_path / "wedge.obj").write_text(f"v 0 0 0\nv .4 0 0\nv 0 .4 0\nv 0 0 .4\n{faces}")
    wedge = f'<mesh filename="{tmp_path}/wedge.obj"/>'
    wedges = [part(wedge, "0.8 0.4 0.1 1", f"{place} {side} 0") for side in (0.3, -0.3) for place in (-1, 0, 1)]
    it, tab = show(robot(tmp_path, *wedges))
    still(it, tab)
    away = [2.0, 0.5, 1.5]
    assert tab.locator("#scene").evaluate(MIRRORED) == 6
    together = looked(tab, away)
    by_themselves(it, tab)
    tab.locator("#scene").evaluate(MIRRORED)
    one_by_one = looked(tab, away)
    assert changed(together, one_by_one) < TIES
    assert (one_by_one[..., 0] > 1.5 * one_by_one[..., 2]).sum() > 2000  # they are seen


def test_a_selected_robot_glows_alone(show):
    it, tab = show(rovers(4).scenario())
    still(it, tab)
    before = looked(tab, FAR)
    tools(tab, "highlight(['robot_2'])")
    glowing = np.abs(seen(tab) - before).sum(axis=2) > 60
    scale = before.shape[1] / tab.locator("#scene").bounding_box()["width"]
    corners = [tools(tab, f"onPicture([{x}, {y}, {z}])") for x in (-0.5, 0.5) for y in (1.5, 2.5) for z in (0.0, 0.5)]
    rows, columns = ([scale * at[axis] for at in corners] for axis in "yx")
    inside = glowing[int(min(rows)) : int(max(rows)) + 1, int(min(columns)) : int(max(columns)) + 1]
    assert inside.sum() > 50
    assert glowing.sum() == inside.sum()
    tools(tab, "highlight([])")
    assert changed(seen(tab), before) < TIES


def test_robots_that_come_and_go_are_seen_to(show):
    it, tab = show(rovers(4).scenario())
    still(it, tab)
    away = [-12.0, 0.0, 6.0]
    assert orange_bodies(looked(tab, away)) == 4
    it.twin.entities.delete("robot_3")
    it.frames(lambda: tools(tab, "object('robot_3')") is None)
    it.for_frames(3)
    assert orange_bodies(looked(tab, away)) == 3
    it.twin.entities.spawn(Robot("robot_5", ROVER, xyz=(0.0, 8.0, 0.13)))
    it.frames(lambda: bool(tools(tab, "boxOf(['robot_5'])")))
    it.for_frames(3)
    assert orange_bodies(looked(tab, away)) == 4


def test_a_preview_goes_even_if_things_were_drawn_anew_meanwhile(show):
    it, tab = show(rovers(2).scenario())
    still(it, tab)
    before = looked(tab, FAR)
    tab.locator("#scene").evaluate(
        "({ contentWindow: { sceneTools, shownViewer, MeshCat } }) => { sceneTools.paths = ['robot_1'];"
        " sceneTools.preview(new MeshCat.THREE.Matrix4().makeTranslation(0, -2, 0)); shownViewer.redraw(); }"
    )
    assert changed(seen(tab), before) > 100
    tools(tab, "endPreview()")
    assert changed(seen(tab), before) < TIES
