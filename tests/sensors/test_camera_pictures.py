"""What pictures show, against projections, ranges and the distortion of OpenCV computed by hand."""

import base64
import json
from io import BytesIO

import numpy as np
import pytest
from camera_rig import ball, camera, centroid, heard, need_mesa, seen
from camera_rig import twin_with as twin_on_the_ground
from PIL import Image
from pydrake.math import RigidTransform, RollPitchYaw

from drake_twin.sensors.cameras.picture_messages import pixels

HEIGHT = 51.0  # of the camera: nothing is near that a test does not put there


@pytest.fixture(autouse=True)
def mesa():
    need_mesa()


def twin_with(*parts, **options):
    return twin_on_the_ground(*parts, **{"xyz": (0, 0, HEIGHT - 1), **options})


def frame_of(pose):
    """The camera's frame in the world: x forward, y to the left."""
    x, y, z, roll, pitch, yaw = map(float, pose.split())
    return RigidTransform([0, 0, HEIGHT - 1]) @ RigidTransform(RollPitchYaw(roll, pitch, yaw), [x, y, z])


def projected(point, info):
    """Where camera_info says that a point of the sensor's frame is (OpenCV's projectPoints)."""
    x, y = -point[1] / point[0], -point[2] / point[0]
    k1, k2, p1, p2, k3 = info.d
    r2 = x * x + y * y
    radial = 1 + k1 * r2 + k2 * r2**2 + k3 * r2**3
    u = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)
    v = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
    return np.array([info.k[0] * u + info.k[2], info.k[4] * v + info.k[5]])


def points_before(pose, fov, aspect, count, generator):
    """Points in the view of a camera, 2 m to 4 m away, with small balls that do not hide each other."""
    found = []
    for index in range(count):
        depth = generator.uniform(2.0, 4.0)
        across = np.tan(fov / 2) * 0.85 * (2 * ((index % 5) + 0.5) / 5 - 1)
        down = np.tan(fov / 2) / aspect * 0.85 * (2 * ((index // 5) + 0.5) / ((count + 4) // 5) - 1)
        found.append(depth * np.array([1.0, -across, -down]))
    return found


@pytest.mark.parametrize(
    ("fov", "size", "pose"),
    [
        (0.5, (240, 120), "0 0 1 0 0 0"),
        (1.2, (200, 200), "0.1 0.2 1 0.3 -0.2 0.7"),
        (1.6, (160, 240), "0 0 1 -1.2 0.1 -2.5"),
    ],
)
def test_a_point_is_where_camera_info_projects_it(tmp_path, fov, size, pose):
    X_WS = frame_of(pose)
    points = points_before(pose, fov, size[0] / size[1], 20, np.random.default_rng(1))
    balls = [
        ball(X_WS @ point, radius=2.5 * point[0] * 2 * np.tan(fov / 2) / size[0], name=f"b{index}")
        for index, point in enumerate(points)
    ]
    twin = twin_with(tmp_path, camera("rgbd_camera", size, fov, pose), world="".join(balls))
    with twin:
        reading = twin.sensor("box", "s")
        info, depth = reading.message("info"), reading.depth
        for point in points:
            u, v = projected(point, info)
            columns, rows = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
            near = (np.hypot(columns - u, rows - v) < 12) & np.isfinite(depth)
            assert np.linalg.norm(centroid(near) - [u, v]) < 0.6


def test_depths_are_those_of_the_closed_form(tmp_path):
    """A wall that is turned, a ball before it: depth along the camera's axis."""
    wall = seen("<box><size>0.2 20 20</size></box>", [3.1, 0, HEIGHT], name="wall", turn="0 0 0.4")
    twin = twin_with(
        tmp_path, camera("depth_camera", (96, 72), 1.0), world=wall + ball([2.0, 0, HEIGHT], 0.3), time_step=0.01
    )
    with twin:
        reading = twin.sensor("box", "s")
        depth, info = reading.depth, reading.message("info")
    columns, rows = np.meshgrid(np.arange(96), np.arange(72))
    x, y = (columns - info.k[2]) / info.k[0], (rows - info.k[5]) / info.k[4]
    normal = np.array([np.cos(0.4), np.sin(0.4)])
    start = np.array([3.1, 0.0]) - 0.1 * normal
    expected = (normal @ start) / (normal[0] - normal[1] * x)
    squares = 1 + x**2 + y**2
    root = 4.0 - squares * (4.0 - 0.09)
    ball_depth = np.where(root > 0, (2.0 - np.sqrt(np.maximum(root, 0))) / squares, np.inf)
    inside = root > 0.05
    outside = root < -0.05
    assert inside.sum() > 100
    assert depth[outside] == pytest.approx(expected[outside], rel=1e-3)
    # A ball is drawn as a mesh: a twentieth of a percent of the distance, but its own facets at its rim.
    assert np.median(np.abs(depth[inside] / ball_depth[inside] - 1)) < 1e-3
    assert np.abs(depth[inside] / ball_depth[inside] - 1).max() < 5e-3


def test_what_is_out_of_range_is_infinite(tmp_path):
    near, far = (
        "<near>1.0</near><far>2.5</far>",
        [ball([0.6, 0.2, HEIGHT], 0.1), ball([4.0, -1.0, HEIGHT], 0.5, name="b")],
    )
    middle = ball([2.0, -0.1, HEIGHT], 0.1, name="c")
    with twin_with(tmp_path, camera("depth_camera", (60, 40), clip=near), world="".join(far) + middle) as twin:
        depth = twin.sensor("box", "s").depth
    assert np.isneginf(depth[20, 12])
    assert np.isposinf(depth[20, 45])
    assert np.isposinf(depth[0, 0])
    assert depth[20, 32] == pytest.approx(1.9, abs=0.02)


def test_the_widest_clips_and_views_are_drawn(tmp_path):
    """Near 0, no far end, nearly 180 degrees, the smallest picture, a lens that folds."""
    plugin = '<plugin name="p" filename="libgazebo_ros_camera.so"><min_depth>0</min_depth></plugin>'
    wide = camera("depth", (4, 4), 3.14, clip="<near>0</near><far>1e9</far>", plugin=plugin)
    folding = camera(more="<distortion><k1>-30</k1><k2>1e3</k2></distortion>", name="t", topic="t/image")
    with twin_with(tmp_path, wide, folding, world=ball([1, 0, HEIGHT], 0.5)) as twin:
        assert twin.sensor("box", "s").depth.shape == (4, 4)
        assert twin.sensor("box", "t").image.shape == (48, 64, 3)
        assert twin._session.built.renderer.findings == ()


def test_a_distorted_picture_shows_points_where_opencv_projects_them(tmp_path):
    more = "<distortion><k1>-0.25</k1><k2>0.12</k2><k3>-0.02</k3><p1>0.002</p1><p2>-0.001</p2></distortion>"
    size, fov, pose = (320, 240), 1.2, "0 0 1 0 0 0"
    points = points_before(pose, fov, size[0] / size[1], 20, np.random.default_rng(2))
    balls = [ball(frame_of(pose) @ point, 0.012 * point[0], name=f"b{i}") for i, point in enumerate(points)]
    with twin_with(tmp_path, camera("rgbd_camera", size, fov, pose, more=more), world="".join(balls)) as twin:
        reading = twin.sensor("box", "s")
        info, depth = reading.message("info"), reading.depth
    assert list(info.d) == [-0.25, 0.12, 0.002, -0.001, -0.02]
    columns, rows = np.meshgrid(np.arange(size[0]), np.arange(size[1]))
    for point in points:
        u, v = projected(point, info)
        near = (np.hypot(columns - u, rows - v) < 12) & np.isfinite(depth)
        assert np.linalg.norm(centroid(near) - [u, v]) < 0.6


def test_the_lens_maps_slopes_as_opencv_does():
    """The directions of pixels, projected by OpenCV's formula, are the pixels: to 0.05 pixel."""
    from drake_twin.sensors.cameras.lens import undistorted

    k = (-0.28, 0.07, 0.0009, -0.0012, 0.01)
    x, y = np.meshgrid(np.linspace(-0.6, 0.6, 41), np.linspace(-0.45, 0.45, 31))
    u, v = undistorted(x, y, k)
    r2 = u**2 + v**2
    radial = 1 + k[0] * r2 + k[1] * r2**2 + k[4] * r2**3
    back = (
        u * radial + 2 * k[2] * u * v + k[3] * (r2 + 2 * u * u),
        v * radial + k[2] * (r2 + 2 * v * v) + 2 * k[3] * u * v,
    )
    focal_length = 500
    assert focal_length * np.abs(back[0] - x).max() < 0.05
    assert focal_length * np.abs(back[1] - y).max() < 0.05


def emissive_wall(tmp_path, color):
    """A wall of 4 m in the plane x = 0 that shines in a color: a glTF file (y up, so z there is -y here).

    It is black metal, which reflects nothing, and has a white texture, without which VTK does not let it shine.
    """
    corners = np.array([[0, -2, 2], [0, -2, -2], [0, 2, -2], [0, 2, 2]], dtype=np.float32)  # x, z, -y
    faces = np.array([0, 1, 2, 0, 2, 3, 2, 1, 0, 3, 2, 0], dtype=np.uint16)
    data = corners.tobytes() + np.zeros((4, 2), dtype=np.float32).tobytes() + faces.tobytes()
    white = BytesIO()
    Image.new("RGB", (2, 2), (255, 255, 255)).save(white, "PNG")
    file = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "indices": 2, "material": 0}]}],
        "materials": [
            {
                "emissiveFactor": color,
                "emissiveTexture": {"index": 0},
                "pbrMetallicRoughness": {"baseColorFactor": [0, 0, 0, 1], "metallicFactor": 1, "roughnessFactor": 1},
            }
        ],
        "textures": [{"source": 0}],
        "images": [{"uri": "data:image/png;base64," + base64.b64encode(white.getvalue()).decode()}],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
        "bufferViews": [
            {"buffer": 0, "byteOffset": 0, "byteLength": 48},
            {"buffer": 0, "byteOffset": 48, "byteLength": 32},
            {"buffer": 0, "byteOffset": 80, "byteLength": 24},
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, -2, -2], "max": [0, 2, 2]},
            {"bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2"},
            {"bufferView": 2, "componentType": 5123, "count": 12, "type": "SCALAR"},
        ],
    }
    (tmp_path / "wall.gltf").write_text(json.dumps(file))
    return (
        f'<model name="wall"><static>true</static><pose>1 0 {HEIGHT} 0 0 0</pose><link name="l"><visual name="v">'
        f"<geometry><mesh><uri>file://{tmp_path}/wall.gltf</uri></mesh></geometry></visual></link></model>"
    )


def test_an_emissive_red_wall_is_red(tmp_path):
    with twin_with(tmp_path, camera(size=(16, 12), fov=0.3), world=emissive_wall(tmp_path, [1, 0, 0])) as twin:
        image = twin.sensor("box", "s").image
    assert image.shape == (12, 16, 3)
    assert np.abs(image.astype(int) - [255, 0, 0]).max() <= 2


@pytest.mark.parametrize(
    ("format_", "encoding"),
    [("R8G8B8", "rgb8"), ("B8G8R8", "bgr8"), ("L8", "mono8"), ("L16", "mono16"), ("BAYER_GRBG8", "bayer_grbg8")],
)
def test_encodings(tmp_path, format_, encoding):
    own = f"<image><width>16</width><height>12</height><format>{format_}</format></image>"
    text = camera(size=(16, 12)).replace("<image><width>16</width><height>12</height></image>", own)
    world = seen("<box><size>0.1 5 5</size></box>", [1.5, 0, HEIGHT], "0.9 0.5 0.1")
    with twin_with(tmp_path, camera(size=(16, 12), name="t", topic="t/image"), text, world=world) as twin:
        red, green, blue = twin.sensor("box", "t").image[6, 8].astype(int)
        message = twin.latest("/box/cam/image")
    values = pixels(message)[6:8, 8:10].astype(int)
    assert message.encoding == encoding
    grey = 0.299 * red + 0.587 * green + 0.114 * blue
    expected = {
        "rgb8": [red, green, blue],
        "bgr8": [blue, green, red],
        "mono8": round(grey),
        "mono16": grey * 257,
        "bayer_grbg8": [[green, red], [blue, green]],
    }[encoding]
    got = values if encoding.startswith("bayer") else values[0, 0]
    assert np.abs(got - expected).max() <= (257 if encoding == "mono16" else 2)
    assert red > green > blue
    assert message.step * message.height == len(message.data)


def test_labels_name_the_bodies(tmp_path):
    box = '<visual><geometry><box size="0.4 0.4 0.2"/></geometry></visual>'
    from rig import BODY

    with twin_with(
        tmp_path,
        camera(size=(40, 30), fov=2.0, pose="-1 0 0.5 0 0.4636 0"),
        world=seen("<box><size>40 1 60</size></box>", [10, 12, HEIGHT]),
        body=BODY.replace("<collision>", f"{box}<collision>", 1),
    ) as twin:
        label = twin.sensor("box", "s").label
        own = int(twin.plant.GetBodyByName("box").index()) + 1
    assert label.dtype == np.uint16
    assert label[15, 20] == own
    assert label[0, 39] == 0
    assert label[5, 3] == 1  # the world: the ground, and what is static


def test_points_of_gazebo_are_in_the_sensors_frame_and_those_of_classic_in_the_optical_one(tmp_path):
    wall = seen("<box><size>0.2 9 9</size></box>", [2.1, 0, HEIGHT])
    classic = '<plugin name="p" filename="libgazebo_ros_camera.so"><min_depth>0.1</min_depth></plugin>'
    for plugin, names, offsets in (("", ("x", "y", "z"), (0, 4, 8, 12)), (classic, ("z", "x", "y"), (0, 4, 8, 16))):
        text = camera("depth_camera", (32, 24), plugin=plugin)
        with twin_with(tmp_path, text, world=wall) as twin:
            message = twin.sensor("box", "s").message("points")
            info = twin.sensor("box", "s").message("info")
        assert tuple(field.offset for field in message.fields) == offsets
        assert [field.name for field in message.fields] == ["x", "y", "z", "rgb"]
        at = {field.name: field.offset for field in message.fields}
        data = np.asarray(message.data).reshape(24, 32, message.point_step)
        forward, across, down = (data[:, :, at[name] : at[name] + 4].copy().view("<f4")[:, :, 0] for name in names)
        assert forward == pytest.approx(np.full((24, 32), 2.0), rel=1e-3)
        sign = 1.0 if plugin else -1.0
        assert across[5, 30] == pytest.approx(sign * 2.0 * (30 - info.k[2]) / info.k[0], rel=1e-3)
        assert down[5, 30] == pytest.approx(sign * 2.0 * (5 - info.k[5]) / info.k[4], rel=1e-3)
        rgb = data[12, 16, at["rgb"] : at["rgb"] + 4]
        assert rgb[2] > 100 > rgb[1]  # red stands third in little endian
        assert message.row_step == 32 * message.point_step


def test_noise_is_per_pixel_and_the_same_in_all_channels(tmp_path):
    noise = "<noise><type>gaussian</type><mean>0.05</mean><stddev>0.04</stddev></noise>"
    world = seen("<box><size>0.1 9 9</size></box>", [1.5, 0, HEIGHT], "0.5 0.5 0.5")
    texts = [
        camera(size=(120, 90), more=more, name=name, topic=f"{name}/image") for name, more in (("a", noise), ("b", ""))
    ]
    with twin_with(tmp_path, *texts, world=world) as twin:
        noisy, still = (twin.sensor("box", name).image.astype(float) for name in "ab")
    difference = noisy - still
    assert np.ptp(difference, axis=2).max() <= 1.0
    values = difference[:, :, 0] / 255
    assert values.mean() == pytest.approx(0.05, abs=4 * 0.04 / 104)
    assert values.std() == pytest.approx(0.04, rel=0.03)
    assert abs(np.corrcoef(values[:, 1:].ravel(), values[:, :-1].ravel())[0, 1]) < 0.04


def test_noise_of_a_depth_camera_is_in_meters(tmp_path):
    noise = "<noise><type>gaussian</type><stddev>0.02</stddev></noise>"
    wall = seen("<box><size>0.2 1 9</size></box>", [2.1, 0, HEIGHT])
    with twin_with(tmp_path, camera("rgbd_camera", (120, 90), more=noise), world=wall) as twin:
        first, again = (twin.sensor("box", "s").depth for _ in range(2))
        image = twin.sensor("box", "s").image
    assert first.tobytes() == again.tobytes()
    seen_wall = first[np.isfinite(first) & (first < 3)]
    assert seen_wall.mean() == pytest.approx(2.0, abs=1e-3)
    assert seen_wall.std() == pytest.approx(0.02, rel=0.05)
    assert np.isposinf(first[:10, :10]).all()
    assert np.ptp(image[40:50, 55:65, 0]) < 10


def test_lights_and_shadows_of_the_world(tmp_path):
    board = seen("<box><size>1 1 0.05</size></box>", [3, 0, 1.0])
    images = {}
    for shadows in ("true", "false"):
        light = (
            f'<light name="sun" type="directional"><cast_shadows>{shadows}</cast_shadows><direction>0 0 -1</direction>'
            "<diffuse>1 1 1 1</diffuse></light>"
        )
        seeing = camera(size=(60, 60), pose="0 0 1.4 0 0.5 0")
        with twin_on_the_ground(tmp_path, seeing, world=light + board) as twin:
            images[shadows] = twin.sensor("box", "s").image.astype(int)
    difference = images["false"].sum(axis=2) - images["true"].sum(axis=2)
    shaded = difference > 60
    assert 0.01 < shaded.mean() < 0.2
    assert np.abs(difference[shaded == 0]).mean() < 20


def test_what_no_light_reaches_is_not_black(tmp_path):
    wall = seen("<box><size>0.2 9 9</size></box>", [2, 0, HEIGHT], "0.8 0.8 0.8")
    light = '<light name="l" type="directional"><direction>{} 0 0</direction></light>'
    grey = []
    for direction in (-1, 1):
        with twin_with(tmp_path, camera(size=(16, 12)), world=wall + light.format(direction)) as twin:
            grey.append(int(twin.sensor("box", "s").image[6, 8, 0]))
    assert 50 < grey[0] < 150
    assert grey[1] > grey[0] + 60


def test_depth_and_color_of_one_camera_are_of_the_same_instant(tmp_path):
    """A camera that turns quickly: the ball is at the same columns in both pictures."""
    world = ball([2.0, 0, HEIGHT], 0.15, "1 0 0")
    with twin_with(tmp_path, camera("rgbd_camera", (120, 30), 1.5, rate=20), world=world) as twin:
        twin.entities.set_state("box", angular=[0, 0, 3.0])
        colors, depths = [], []
        twin.subscribe("/box/cam/image/depth_image", depths.append)
        twin.subscribe("/box/cam/image/image", colors.append)
        twin.advance_to(0.21)
    assert len(colors) == len(depths) == 4
    columns = []
    for color, depth in zip(colors, depths, strict=True):
        assert color.header == depth.header
        image = pixels(color).astype(int)
        red = centroid(image[:, :, 0] - image[:, :, 1] > 60)
        assert red == pytest.approx(centroid(pixels(depth) < 2.1), abs=0.3)
        columns.append(red[0])
    assert np.diff(columns).min() > 5


def test_pictures_are_heard_with_their_infos(tmp_path):
    with twin_with(tmp_path, camera(), world=ball([2, 0, 1])) as twin:
        images = heard(twin, "/box/cam/image", 0.25)
    assert [(item.header.stamp.nanosec, item.header.frame_id) for item in images] == [
        (0, "box/box/s"),
        (100_000_000, "box/box/s"),
    ]
    assert (images[0].width, images[0].height, images[0].step) == (64, 48, 192)


def test_a_mesh_has_its_own_colors_or_those_of_the_robot_file(tmp_path):
    """An OBJ file with a material of its own, and one without, as visuals of a static model."""
    corners = "v 0 -2 -2\nv 0 2 -2\nv 0 2 2\nv 0 -2 2\nvn -1 0 0\nvt 0 0\n"
    faces = "f 1/1/1 4/1/1 3/1/1\nf 1/1/1 3/1/1 2/1/1\n"
    (tmp_path / "own.obj").write_text(f"mtllib own.mtl\n{corners}usemtl own\n{faces}")
    (tmp_path / "own.mtl").write_text("newmtl own\nKd 0.0 0.8 0.0\n")
    (tmp_path / "plain.obj").write_text(corners + faces)
    blue = "<material><diffuse>0 0 0.8 1</diffuse></material>"
    for file, material, strongest in (("own", "", 1), ("plain", blue, 2)):
        wall = (
            f'<model name="wall"><static>true</static><pose>1 0 {HEIGHT} 0 0 0</pose><link name="l"><visual name="v">'
            f"<geometry><mesh><uri>file://{tmp_path}/{file}.obj</uri></mesh></geometry>{material}</visual></link></model>"
        )
        with twin_with(tmp_path, camera(size=(16, 12)), world=wall) as twin:
            red_green_blue = twin.sensor("box", "s").image[6, 8].astype(int)
        assert red_green_blue.argmax() == strongest, red_green_blue
        assert red_green_blue.max() > 1.3 * np.sort(red_green_blue)[1]


def test_the_ground_is_drawn(tmp_path):
    """Below a camera that looks down, with and without a world of its own: at its height."""
    down = camera("depth_camera", (16, 12), pose="0 0 1 0 1.5707963267948966 0")
    solids = "".join(  # so many that a box stands in for the plane
        f'<collision name="c{i}"><pose>{i} 40 0 0 0 0</pose><geometry><sphere><radius>.1</radius></sphere></geometry>'
        "</collision>"
        for i in range(110)
    )
    many = f'<model name="many"><static>1</static><link name="l">{solids}</link></model>'
    for world in ("", None, "<include><uri>model://ground_plane</uri></include>", many):
        with twin_on_the_ground(tmp_path, down, world=world) as twin:
            assert twin.sensor("box", "s").depth == pytest.approx(np.full((12, 16), 1.1), rel=1e-3)
