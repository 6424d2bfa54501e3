"""Drake's shapes as three.js has them: their sizes, and what a real browser draws of them."""

import io
from types import SimpleNamespace

import numpy as np
import pytest
from chromium import CHROMIUM, SOFTWARE_RENDERING
from meshcat_server import MeshcatServer
from PIL import Image
from pydrake.geometry import Box, Capsule, Convex, Cylinder, Ellipsoid, HalfSpace, Mesh, MeshcatCone, Sphere
from waiting import until

from drake_twin.shared_viewer.frame_sender import Frame
from drake_twin.shared_viewer.meshcat_client import MeshcatClient
from drake_twin.shared_viewer.shared_scene import DrawnGeometry
from drake_twin.shared_viewer.three_js import points_object, three_js_object

OCTAHEDRON = np.vstack([np.eye(3), -np.eye(3)]).T


def drawn(shape, color=(1.0, 0.0, 0.0, 1.0), X_BG=None):
    return three_js_object(DrawnGeometry("r/b/g", shape, color, np.eye(4) if X_BG is None else X_BG))


def corners(document):
    """The eight corners of all that is drawn, in the body's frame."""
    sizes = {geometry["uuid"]: half_sizes(geometry) for geometry in document["geometries"]}
    group = np.reshape(document["object"]["matrix"], (4, 4)).T
    every = np.array(np.meshgrid([-1, 1], [-1, 1], [-1, 1])).reshape(3, 8)
    points = []
    for child in document["object"]["children"]:
        matrix = group @ np.reshape(child["matrix"], (4, 4)).T
        points.append(matrix[:3, :3] @ (every * sizes[child["geometry"]][:, None]) + matrix[:3, 3:])
    return np.hstack(points).T


def half_sizes(geometry):
    match geometry["type"]:
        case "BoxGeometry":  # along x, y and z
            return np.array([geometry["width"], geometry["height"], geometry["depth"]]) / 2
        case "SphereGeometry":
            return np.full(3, geometry["radius"])
        case "CylinderGeometry":  # along y
            radius = max(geometry["radiusTop"], geometry["radiusBottom"])
            return np.array([radius, geometry["height"] / 2, radius])
        case "BufferGeometry":
            data = geometry["data"]["attributes"]["position"]["array"].data
            return np.abs(np.frombuffer(data, np.float32).reshape(-1, 3)).max(axis=0)


@pytest.mark.parametrize(
    ("shape", "lower", "upper"),
    [
        (Box(1, 2, 3), [-0.5, -1, -1.5], [0.5, 1, 1.5]),
        (Sphere(2), [-2, -2, -2], [2, 2, 2]),
        (Ellipsoid(1, 2, 3), [-1, -2, -3], [1, 2, 3]),
        (Cylinder(1, 6), [-1, -1, -3], [1, 1, 3]),
        (Capsule(1, 6), [-1, -1, -4], [1, 1, 4]),
        (MeshcatCone(4, 1, 2), [-1, -2, 0], [1, 2, 4]),
        (HalfSpace(), [-50, -50, -0.01], [50, 50, 0]),
        (Convex(points=OCTAHEDRON, label="octahedron"), [-1, -1, -1], [1, 1, 1]),
    ],
)
def test_a_shape_is_as_large_as_in_drake(shape, lower, upper):
    points = corners(drawn(shape))
    assert points.min(axis=0) == pytest.approx(lower)
    assert points.max(axis=0) == pytest.approx(upper)


def test_a_geometry_stands_where_it_does_on_its_body():
    X_BG = np.eye(4)
    X_BG[:3, 3] = [1, 2, 3]
    assert corners(drawn(Sphere(1), X_BG=X_BG)).mean(axis=0) == pytest.approx([1, 2, 3])


def test_a_color_and_its_opacity():
    (material,) = drawn(Box(1, 1, 1), (1.0, 0.5, 0.0, 0.25))["materials"]
    assert (material["color"], material["opacity"], material["transparent"]) == (0xFF8000, 0.25, True)
    (material,) = drawn(Box(1, 1, 1), (0.0, 0.0, 1.0, 1.0))["materials"]
    assert (material["color"], material["opacity"], material["transparent"]) == (0x0000FF, 1.0, False)


def test_a_hulls_triangles_cover_each_face_once_and_look_outward():
    """A brick of 1 m, 2 m and 3 m: 22 m² of surface, and 6 m³ by the divergence theorem."""
    brick = np.array(np.meshgrid([-0.5, 0.5], [-1, 1], [-1.5, 1.5])).reshape(3, 8)
    (geometry,) = drawn(Convex(points=brick, label="brick"))["geometries"]
    data = geometry["data"]
    at = np.frombuffer(data["attributes"]["position"]["array"].data, np.float32).reshape(-1, 3)
    normals = np.frombuffer(data["attributes"]["normal"]["array"].data, np.float32).reshape(-1, 3)
    faces = np.frombuffer(data["index"]["array"].data, np.uint32).reshape(-1, 3)
    a, b, c = (at[faces[:, corner]] for corner in range(3))
    across = np.cross(b - a, c - a) / 2
    assert np.linalg.norm(across, axis=1).sum() == pytest.approx(22.0)
    assert np.einsum("ij,ij->i", a, across).sum() / 3 == pytest.approx(6.0)
    assert np.einsum("ij,ij->i", across, normals[faces[:, 0]]) == pytest.approx(np.linalg.norm(across, axis=1))


def test_each_point_may_have_its_color():
    """As linear light, which the colors of vertices are in three.js: half of sRGB's range is 21.4 % of the light."""
    colors = np.array([[1.0, 0.0, 0.0], [0.0, 0.5, 1.0]])
    document = points_object("points", np.zeros((2, 3)), colors, 0.1)
    packed = document["geometries"][0]["data"]["attributes"]["color"]["array"].data
    assert np.frombuffer(packed, np.float32).ravel().tolist() == [1, 0, 0, 0, pytest.approx(0.214, abs=1e-3), 1]
    assert document["materials"][0]["vertexColors"]
    assert "vertexColors" not in points_object("points", np.zeros((2, 3)), (1.0, 0.0, 0.0), 0.1)["materials"][0]


def test_the_same_geometry_has_the_same_bytes_so_that_the_server_knows_it_again():
    assert drawn(Capsule(1, 2)) == drawn(Capsule(1, 2))


def test_a_meshs_own_material_comes_before_the_bodys_color(tmp_path):
    (tmp_path / "look.mtl").write_text("newmtl m\nKd 0 0 1\n")
    (tmp_path / "mesh.obj").write_text("mtllib look.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n")
    (material,) = drawn(Mesh(tmp_path / "mesh.obj"))["materials"]
    assert material["color"] == 0x0000FF


@pytest.fixture
def server():
    server = MeshcatServer()
    yield server
    server.kill()


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)")
def test_a_browser_draws_every_shape_and_a_texture(server, tmp_path):
    """Seven things in a row, each in its place and color."""
    from playwright.sync_api import sync_playwright

    Image.new("RGB", (4, 4), (255, 0, 255)).save(tmp_path / "magenta.png")
    (tmp_path / "look.mtl").write_text("newmtl m\nKd 1 1 1\nmap_Kd magenta.png\n")
    (tmp_path / "mesh.obj").write_text(
        "mtllib look.mtl\nv 0 -.3 -.3\nv 0 .3 -.3\nv 0 .3 .3\nv 0 -.3 .3\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvn 1 0 0\n"
        "usemtl m\nf 1/1/1 2/2/1 3/3/1\nf 1/1/1 3/3/1 4/4/1\n"
    )
    shapes = {
        Box(0.5, 0.5, 0.5): (1, 0, 0),
        Sphere(0.3): (0, 1, 0),
        Ellipsoid(0.3, 0.3, 0.15): (0, 0, 1),
        Cylinder(0.2, 0.5): (1, 1, 0),
        Capsule(0.15, 0.3): (0, 1, 1),
        Convex(points=0.3 * OCTAHEDRON, label="octahedron"): (1, 0, 0),
        Mesh(tmp_path / "mesh.obj"): (1, 0, 1),
    }
    geometries = []
    for index, (shape, color) in enumerate(shapes.items()):
        X_BG = np.eye(4)
        X_BG[:3, 3] = [0, 0.7 * (index - 3), 0]
        geometries.append(DrawnGeometry(f"r/b/{index}", shape, (*color, 1.0), X_BG))
    client = MeshcatClient(server.url, "/test", lambda _: None)
    client.offer(Frame(SimpleNamespace(geometries=tuple(geometries), bodies=()), np.empty((0, 4, 4))))
    assert client.flush(20)
    client.close(0)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_RENDERING)
        page = browser.new_page(viewport={"width": 1000, "height": 500})
        errors = []
        page.on("console", lambda message: errors.append(message.text) if message.type == "error" else None)
        page.goto(server.page)
        # The page draws when the browser gets to it, and says nothing about it.
        until(lambda: not missing(page.screenshot(), shapes.values()))
        browser.close()
    assert [error for error in errors if "404" not in error] == []  # the server has no favicon


def missing(screenshot, colors):
    """The indices of the shapes that are not in their places in their colors."""
    picture = np.asarray(Image.open(io.BytesIO(screenshot)).convert("RGB")).astype(int)
    found = []
    for index, color in enumerate(colors):
        lit, unlit = np.array(color, dtype=bool), ~np.array(color, dtype=bool)
        middle = 500 + round(72.5 * (index - 3))
        place = picture[:, middle - 30 : middle + 30]
        brightest = place[..., lit].min(axis=-1)
        if ((brightest > 100) & (brightest > 3 * place[..., unlit].max(axis=-1))).sum() <= 200:
            found.append(index)
    return found
