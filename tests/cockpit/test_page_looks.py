"""How robots and worlds look in the scene, as pixels of a real browser: colors, edges, textures, floors, sizes."""

# ruff: noqa: F401, F811 (fixtures are imported, and named again as arguments)

import numpy as np
import pytest
from browser import BROWSER_TESTS, browser, page, picture, show
from conftest import rovers
from in_scene import tools
from PIL import Image

from drake_twin import TwinBuilder
from drake_twin.scenario import World

pytestmark = BROWSER_TESTS

PLANE = "<geometry><plane><normal>0 0 1</normal><size>100 100</size></plane></geometry>"


def robot(folder, *visuals):
    """A robot that stands in the world and is drawn as these visuals."""
    drawn = "".join(f"<visual>{visual}</visual>" for visual in visuals)
    file = folder / "drawn.urdf"
    file.write_text(
        f'<robot name="drawn"><link name="world"/><link name="base">{drawn}</link><joint name="to_world" type="fixed">'
        '<parent link="world"/><child link="base"/></joint></robot>'
    )
    return TwinBuilder().robot("drawn", str(file)).scenario()


def part(geometry, color=None, xyz="0 0 0.5"):
    material = f'<material name="m{abs(hash(color))}"><color rgba="{color}"/></material>' if color else ""
    return f'<origin xyz="{xyz}"/><geometry>{geometry}</geometry>{material}'


def stl(file, triangles):
    """A mesh file without colors, and without normals that mean anything."""
    kind = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("more", "<u2")])
    facets = np.zeros(len(triangles), kind)
    facets["corners"] = triangles
    file.write_bytes(bytes(80) + len(triangles).to_bytes(4, "little") + facets.tobytes())
    return f'<mesh filename="{file}"/>'


def ball(radius, rings=12, sides=24):
    """The triangles of a sphere, with facets of 15°."""
    height, around = np.linspace(0, np.pi, rings + 1), np.linspace(0, 2 * np.pi, sides + 1)
    x, y = np.outer(np.sin(height), np.cos(around)), np.outer(np.sin(height), np.sin(around))
    at = radius * np.stack([x, y, np.outer(np.cos(height), np.ones_like(around))], axis=-1)
    a, b, c, d = at[:-1, :-1], at[1:, :-1], at[1:, 1:], at[:-1, 1:]
    return np.concatenate([np.stack(half, axis=2).reshape(-1, 3, 3) for half in ((a, b, c), (a, c, d))])


def shot_of(it, tab, *keys):
    """The picture of a paused twin, whole or as a key says, and a function from a point of the world to its pixels."""
    it.twin.pause()
    it.for_frames(5)
    for key in keys:
        tab.keyboard.press(key)
    it.for_frames(2)
    shot = picture(tab)

    def around(x, y, z, reach=1):
        at = tools(tab, f"onPicture([{x}, {y}, {z}])")
        row, column = round(at["y"]), round(at["x"])
        return shot[row - reach : row + reach + 1, column - reach : column + reach + 1]

    return shot, around


def test_a_color_is_as_its_file_says(show, tmp_path):
    """The upper side faces the sun within 30°: it is as bright as the file's color, and of its hue."""
    it, tab = show(robot(tmp_path, part('<box size="1 1 1"/>', "0.8 0.4 0.1 1")))
    _, around = shot_of(it, tab, "4")
    assert around(0.2, 0.2, 1.0).mean(axis=(0, 1)) == pytest.approx([204, 102, 26], abs=28)


def test_what_is_black_shows_its_form(show, tmp_path):
    it, tab = show(robot(tmp_path, part('<sphere radius="0.5"/>', "0 0 0 1")))
    _, around = shot_of(it, tab, "2")
    places = [around(0.5 * np.cos(up), 0.0, 0.5 + 0.5 * np.sin(up)).mean() for up in np.radians([-40, 0, 40, 70])]
    assert np.ptp(places) > 25
    assert max(places) < 128  # it is black nevertheless


def test_a_cubes_edges_are_sharp_and_a_balls_facets_unseen(show, tmp_path):
    """Both from STL files, which have no normals: a side has one shade, and a ball many with small steps between."""
    corners = np.array([[x, y, z] for x in (-0.5, 0.5) for y in (-0.5, 0.5) for z in (-0.5, 0.5)])
    sides = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    cube = stl(
        tmp_path / "cube.stl", [corners[[a, b, c]] for p, q, r, s in sides for a, b, c in ((p, q, r), (p, r, s))]
    )
    round_one = stl(tmp_path / "ball.stl", ball(0.5))
    grey = "0.5 0.5 0.5 1"
    it, tab = show(robot(tmp_path, part(cube, grey, "0 -0.8 0.5"), part(round_one, grey, "0 0.8 0.5")))
    _, around = shot_of(it, tab, "1")
    front = [around(0.5, y, z).mean() for y in (-1.2, -0.5) for z in (0.2, 0.8)]
    upper = [around(x, y, 1.0).mean() for x in (-0.3, 0.4) for y in (-1.2, -0.5)]
    assert np.ptp(front) < 12
    assert np.ptp(upper) < 12
    assert abs(np.mean(upper) - np.mean(front)) > 25
    towards = np.array([0.75, -0.65]) / np.hypot(0.75, 0.65)  # the camera
    upwards = np.radians(np.arange(-30, 76, 3))
    along = [around(*(0.5 * np.cos(up) * towards + [0, 0.8]), 0.5 + 0.5 * np.sin(up)).mean() for up in upwards]
    assert np.ptp(along) > 25
    assert np.abs(np.diff(along)).max() < 8


def test_a_textures_colors_are_those_of_its_picture(show, tmp_path):
    """A board, whose left half is of one color and whose right half is of another one, as bright as in the picture."""
    pixels = np.zeros((8, 8, 3), np.uint8)
    pixels[:, :4], pixels[:, 4:] = (200, 60, 40), (40, 90, 120)
    Image.fromarray(pixels).save(tmp_path / "halves.png")
    (tmp_path / "look.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd halves.png\n")
    (tmp_path / "board.obj").write_text(
        "mtllib look.mtl\nv -.5 -.5 0\nv .5 -.5 0\nv .5 .5 0\nv -.5 .5 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 0 0 1\n"
        "usemtl m\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n"
    )
    it, tab = show(robot(tmp_path, part(f'<mesh filename="{tmp_path}/board.obj"/>')))
    _, around = shot_of(it, tab, "4")
    assert around(-0.25, 0.0, 0.5).mean(axis=(0, 1)) == pytest.approx([200, 60, 40], abs=28)
    assert around(0.25, 0.0, 0.5).mean(axis=(0, 1)) == pytest.approx([40, 90, 120], abs=28)


@pytest.mark.parametrize("ground", ["", "plane"])
def test_a_worlds_floor_at_height_0_hides_the_ground_everywhere(show, tmp_path, ground):
    """Seen from two sides, near and far: nothing of the ground comes through, be it the twin's or the world's plane."""
    plane = f'<visual name="seen">{PLANE}</visual><collision name="felt">{PLANE}</collision>'
    floor = "<pose>0 0 -0.05 0 0 0</pose><geometry><box><size>16 16 0.1</size></box></geometry>"
    red = "<material><diffuse>0.8 0.1 0.1 1</diffuse></material>"
    (tmp_path / "floor.sdf").write_text(
        '<sdf version="1.9"><world name="hall"><model name="floor"><static>true</static><link name="link">'
        f'<visual name="red">{floor}{red}</visual><collision name="c">{floor}</collision></link></model>'
        + (f'<model name="ground"><static>true</static><link name="link">{plane}</link></model>' if ground else "")
        + "</world></sdf>"
    )
    it, tab = show(rovers(1, world=World(file=str(tmp_path / "floor.sdf"))).scenario())
    near, far = np.arange(1.0, 7.6, 0.5), np.arange(1.0, 7.6)
    beyond = {"1": [(-a, b) for a in near for b in far], "3": [(a - 4.0, -b) for a in far for b in near]}
    for key, places in beyond.items():
        _, around = shot_of(it, tab, key)
        colors = np.array([found[0, 0] for found in (around(x, y, 0.0, 0) for x, y in places) if found.size])
        assert len(colors) > 20, key
        assert np.mean(colors[:, 0] > 2.5 * colors[:, 1]) > 0.9, key  # but for what the rover and the timeline hide


def test_a_worlds_ground_plane_has_a_grid_and_no_end(show, tmp_path):
    """As the twin's own: every world of Gazebo has one, 100 m wide."""
    (tmp_path / "plain.sdf").write_text(
        '<sdf version="1.9"><world name="plain"><model name="ground_plane"><static>true</static><link name="link">'
        f'<visual name="seen">{PLANE}</visual><collision name="felt">{PLANE}</collision></link></model></world></sdf>'
    )
    it, tab = show(rovers(2, world=World(file=str(tmp_path / "plain.sdf"))).scenario())
    _, around = shot_of(it, tab, "4")
    places = [(x, y + 0.45) for x in (-1, 0, 1) for y in (0, 1)]
    lines, between = ([around(x + aside, y, 0.0).mean() for x, y in places] for aside in (0.0, 0.55))
    assert np.median(lines) < 0.95 * np.median(between)
    shot, _ = shot_of(it, tab, "2")
    column = np.median(shot[2 : shot.shape[0] // 2, :40].sum(axis=2), axis=1) / 765
    assert np.abs(np.diff(column)).max() < 0.12


@pytest.mark.parametrize("size", [0.05, 1.0, 40.0])
def test_a_robot_of_any_size_fills_a_third_of_the_first_picture(show, tmp_path, size):
    visual = part(f'<box size="{size} {size / 2} {size / 4}"/>', "1 0 0 1", f"0 0 {size / 8}")
    it, tab = show(robot(tmp_path, visual))
    shot, _ = shot_of(it, tab)
    rows, columns = np.nonzero((shot[..., 0] > 100) & (shot[..., 0] > 2 * shot[..., 1]))
    assert max(np.ptp(columns) / shot.shape[1], np.ptp(rows) / shot.shape[0]) > 1 / 3
    assert columns.min() > 0
    assert columns.max() < shot.shape[1] - 1
