"""Sensors on the page, without a browser."""

import json

import numpy as np
import pytest
from fake_page import FakePage
from seeing_robot import seeing

from drake_twin import Twin, messages
from drake_twin.cockpit import protocol
from drake_twin.cockpit.color_map import Legend
from drake_twin.cockpit.scene import OVERLAYS
from drake_twin.cockpit.sensor_points import measured
from drake_twin.cockpit.sensor_view import groups_of, small_picture
from drake_twin.sensors.ray_caster import RayCaster

EYE = "wall/l/eye"  # of a model of the world
LIDAR, IMU, CAMERA = (f"box_0/box/{name}" for name in ("lidar", "imu", "camera"))


@pytest.fixture
def page(tmp_path):
    page = FakePage(seeing(tmp_path, 2).build())
    page.drawn = {}
    set_points = page.cockpit._scene.set_points

    def draw(path, points, color, size):
        page.drawn[path] = points
        set_points(path, points, color, size)

    page.cockpit._scene.set_points = draw
    yield page
    page.cockpit.close()
    page.twin.close()


def listeners(twin):
    return len(twin._session.subscriptions._items)


def test_the_sensors_of_all_robots_are_listed_with_topics_and_rates(page):
    assert page.state["sensors"] == {}
    listed = {item["key"]: item for item in page.server.told["robots"]["sensors"]}
    assert set(listed) == {f"box_{index}/box/{name}" for index in (0, 1) for name in ("lidar", "imu", "camera")} | {EYE}
    assert (listed[LIDAR]["kind"], listed[LIDAR]["rate"], listed[LIDAR]["views"]) == ("gpu_lidar", 10.0, ["points"])
    assert listed[CAMERA]["views"] == ["picture"]
    assert listed[IMU]["views"] == ["numbers"]


def test_a_sensor_that_is_not_shown_has_no_listener_nor_one_without_a_browser(page):
    page.cockpit.process_requests()
    before = listeners(page.twin)
    page.ask(protocol.ShowSensor(LIDAR, True), protocol.ShowSensor(IMU, True))
    assert listeners(page.twin) == before + 2
    page.server.clients = ()
    page.cockpit.process_requests()
    assert listeners(page.twin) == before - 1  # nor the timeline's
    page.server.clients = (2,)
    page.cockpit.process_requests()
    assert listeners(page.twin) == before + 2
    page.ask(protocol.ShowSensor(LIDAR, False), protocol.ShowSensor(IMU, False))
    assert listeners(page.twin) == before


def test_points_are_drawn_where_the_rays_met_the_wall_also_while_the_robot_turns(page):
    page.cockpit.process_requests()
    page.ask(protocol.ShowSensor(LIDAR, True))
    page.twin.entities.set_state("box_0", (0.3, 0.2, 0.1), (np.cos(0.1), 0, 0, np.sin(0.1)), angular=(0, 0, 1.0))
    page.twin.advance_to(0.35)
    (points,) = page.drawn.values()
    assert len(points) == 31
    assert points[:, 0] == pytest.approx(2.0, abs=1e-5)
    assert page.cockpit._scene.has_path(f"{OVERLAYS}/measured")
    page.ask(protocol.ShowSensor(LIDAR, False))
    assert not page.cockpit._scene.has_path(f"{OVERLAYS}/measured")


def test_a_depth_cameras_points_lie_on_the_wall_though_they_come_later_while_the_robot_turns(tmp_path):
    page = FakePage(Twin(seeing(tmp_path, camera="rgbd_camera").scenario()))
    if page.twin.sensor("box_0", "camera").depth is None:
        pytest.skip("pictures need Mesa: apt-get install libegl1 libegl-mesa0 libgl1-mesa-dri")
    drawn = []
    page.cockpit._scene.set_points = lambda path, points, color, size: drawn.append((page.twin.time, points))
    page.cockpit.process_requests()
    page.ask(protocol.ShowSensor(CAMERA, True))
    page.twin.entities.set_state("box_0", (0.3, 0.2, 0.3), angular=(0, 0, 1.0))
    page.twin.advance_to(0.55)
    assert [time for time, _ in drawn] == pytest.approx([0.1, 0.3, 0.5])  # a period after 0, 0.2 and 0.4 s
    assert sorted(page.server.pictures) == ["/box_0/camera/depth_image", "/box_0/camera/image"]
    for _, points in drawn:
        on_wall = points[(points[:, 2] > 0.01) & (points[:, 2] < 2.9)]
        assert len(on_wall) > 10_000
        assert on_wall[:, 0] == pytest.approx(2.0, abs=3e-3)
    page.cockpit.close()
    page.twin.close()


def test_no_ray_is_cast_and_no_picture_is_asked_for_while_nothing_is_shown(page, monkeypatch):
    cast, counted = RayCaster.cast, []

    def count(self, *arguments):
        counted.append(arguments)
        return cast(self, *arguments)

    monkeypatch.setattr(RayCaster, "cast", count)
    page.cockpit.process_requests()
    page.twin.advance_to(0.35)
    assert (len(counted), page.twin._session.built.renderer.asked) == (0, 0)
    page.ask(protocol.ShowSensor(LIDAR, True))
    page.twin.advance_to(0.65)
    assert len(counted) == 4  # at once, and at 0.4, 0.5 and 0.6 s
    page.ask(protocol.ShowSensor(LIDAR, False))
    page.twin.advance_to(1.0)
    assert len(counted) == 4


def test_numbers_come_with_the_state(page):
    page.cockpit.process_requests()
    page.ask(protocol.ShowSensor(IMU, True))
    page.twin.advance_to(1.0)
    shown = page.state["sensors"][IMU]
    groups = {group["name"]: group for group in shown["groups"]}
    assert groups["linear_acceleration"]["unit"] == "m/s²"
    assert groups["linear_acceleration"]["values"] == pytest.approx([0, 0, 9.81], abs=0.05)
    assert "orientation" in groups


def test_a_robot_that_is_deleted_takes_its_sensors_along(page):
    page.cockpit.process_requests()
    before = listeners(page.twin)
    page.ask(protocol.ShowSensor("box_1/box/lidar", True), protocol.ShowSensor(LIDAR, True))
    page.ask(protocol.Delete("box_1"))
    assert page.state["sensors"].keys() == {LIDAR}
    assert listeners(page.twin) == before + 1
    page.ask(protocol.Reset())
    page.twin.advance_to(0.2)
    assert len(page.drawn) == 1


def test_an_unknown_sensor_is_refused_in_words(page):
    page.ask(protocol.ShowSensor("box_0/box/lidr", True))
    assert any("unknown sensor" in text and LIDAR in text for level, text in page.messages if level == "error")


def test_the_state_does_not_depend_on_what_is_shown(tmp_path):
    hashes = set()
    for shown in (False, True):
        page = FakePage(Twin(seeing(tmp_path).scenario()))
        page.cockpit.process_requests()
        if shown:
            page.ask(protocol.ShowSensor(LIDAR, True), protocol.ShowSensor(IMU, True))
        page.twin.advance_to(0.3)
        hashes.add(page.twin.state_sha256())
        page.cockpit.close()
    assert len(hashes) == 1


def test_a_picture_is_sent_small_and_red(page):
    rgb = np.zeros((480, 640, 3), dtype=np.uint8)
    rgb[..., 0] = 200
    picture, legend = small_picture(rgb)
    assert legend is None
    assert picture.shape == (240, 320, 3)
    assert (picture[..., 0] == 200).all()
    message = messages.Image(messages.header(0.0, "f"), 480, 640, "rgb8", 0, 1920, rgb.ravel())
    page.cockpit.sensors.show(CAMERA, True)
    page.cockpit.sensors._shown[CAMERA]._picture("/camera", message)
    head, _, data = page.server.pictures["/camera"].partition(b"\n")
    about = {"size": [640, 480], "encoding": "rgb8", "legend": None}
    assert json.loads(head) == {"key": CAMERA, "topic": "/camera", "width": 320, "height": 240, **about}
    assert data == picture.tobytes()


def test_depths_have_colors_the_nearest_is_yellow_and_what_is_not_seen_is_black():
    picture, legend = small_picture(np.array([[1.0, 2.0, 3.0, np.inf, -np.inf, np.nan]], dtype=np.float32))
    assert (legend.quantity, legend.unit, legend.lower, legend.upper) == ("depth", "m", 1.0, 3.0)
    stops = legend.as_plain()["stops"]
    assert picture[0, :3].tolist() == [stops[0], stops[2], stops[4]]
    brightness = picture[0] @ [0.299, 0.587, 0.114]
    assert brightness[0] > brightness[1] > brightness[2] > 0
    assert not picture[0, 3:].any()
    picture, legend = small_picture(np.full((2, 2), np.inf))
    assert (picture.shape, picture.max(), legend) == ((2, 2, 3), 0, None)


def test_the_map_of_colors_grows_brighter():
    colors = Legend("x", "", 0.0, 1.0).colors(np.linspace(0, 1, 101))
    assert (np.diff(colors @ [0.299, 0.587, 0.114]) > 0).all()


def test_a_scan_is_colored_by_range_height_or_one_color(page):
    page.cockpit.process_requests()
    page.ask(protocol.ShowSensor(LIDAR, True))
    page.twin.advance_to(0.15)
    shown = page.state["sensors"][LIDAR]
    assert (shown["colored_by"], shown["choices"][:2], shown["choices"][-1]) == (
        "range",
        ["range", "height"],
        "one color",
    )
    ranges = page.twin.sensor("box_0", "lidar").ranges
    assert (shown["legend"]["lower"], shown["legend"]["upper"]) == pytest.approx((ranges.min(), ranges.max()))
    assert shown["legend"]["unit"] == "m"
    page.ask(protocol.ColorSensor(LIDAR, "height"))
    height = page.twin.sensor("box_0", "lidar").pose.translation()[2]
    shown = page.state["sensors"][LIDAR]
    assert (shown["legend"]["lower"], shown["legend"]["upper"]) == pytest.approx((height, height), abs=1e-3)
    page.ask(protocol.ColorSensor(LIDAR, "one color"))
    assert page.state["sensors"][LIDAR]["legend"] is None
    for key, by in ((LIDAR, "smell"), (IMU, "range")):
        page.ask(protocol.ColorSensor(key, by))
        page.cockpit.publish()
        assert page.messages[-1][0] == "error"
    assert "have no 'smell'. Valid: range, height" in page.messages[-2][1]
    assert "is not shown" in page.messages[-1][1]


def test_points_are_colored_by_their_own_intensities():
    intensities = np.array([5.0, 7.0, 9.0])
    scan = messages.LaserScan(
        messages.header(0.0, "f"), 0.0, 0.2, 0.1, 0.0, 0.1, 0.1, 9.0, np.array([1.0, np.inf, 2.0]), intensities
    )
    met = measured(scan)
    assert met.values("intensity", met.points).tolist() == [5.0, 9.0]
    assert met.values("range", met.points).tolist() == pytest.approx([1.0, 2.0])
    assert met.values("one color", met.points) is None
    layout = [messages.PointField(name, 4 * index, 7, 1) for index, name in enumerate(("x", "y", "z", "intensity"))]
    data = np.array([[3, 0, 4, 50], [0, 0, 1, 60]], dtype=np.float32).view(np.uint8).ravel()
    met = measured(messages.PointCloud2(messages.header(0.0, "f"), 1, 2, layout, False, 16, 32, data, True))
    assert met.values("intensity", met.points).tolist() == [50.0, 60.0]
    assert met.values("range", met.points).tolist() == [5.0, 1.0]


def test_numbers_of_different_units_are_different_plots():
    fix = messages.NavSatFix(messages.header(0.0, "f"), messages.NavSatStatus(0, 1), 47.0, 8.0, 400.0, np.zeros(9), 0)
    groups = {group["name"]: (group["unit"], group["labels"]) for group in groups_of(fix)}
    assert groups["latitude"] == ("°", ["latitude", "longitude"])
    assert groups["altitude"] == ("m", ["altitude"])


def test_points_of_the_other_messages():
    angle = messages.Range(messages.header(0.0, "f"), 0, 0.5, 0.1, 4.0, 2.0, 0.0)
    assert np.linalg.norm(measured(angle).points, axis=1) == pytest.approx(2.0)
    cloud = messages.PointCloud(messages.header(0.0, "f"), [messages.Point32(1.0, 2.0, 3.0)], [])
    assert measured(cloud).points.tolist() == [[1.0, 2.0, 3.0]]


def test_a_large_cloud_is_thinned_out_evenly():
    data = np.zeros((480 * 640, 4), dtype=np.float32)
    data[:, 0], data[:, 1] = np.divmod(np.arange(len(data)), 640)
    layout = [messages.PointField(name, 4 * index, 7, 1) for index, name in enumerate("xyz")]
    bytes_ = data.view(np.uint8).ravel()
    cloud = messages.PointCloud2(messages.header(0.0, "f"), 480, 640, layout, False, 16, 10240, bytes_, True)
    points = measured(cloud).points
    assert 19_000 < len(points) < 20_000
    assert len(np.unique(points[:, 0])) == 480
    assert len(np.unique(points[:, 1])) > 600


def test_heights_are_colors_from_blue_to_yellow():
    heights = np.array([1.0, 2.0, 3.0])
    colors = Legend.of(heights, "height", "m").colors(heights)
    assert np.argmax(colors, axis=1).tolist() == [2, 1, 0]
    assert Legend.of(np.zeros(0), "height", "m") is None
    assert len(np.unique(Legend.of(np.zeros(3), "height", "m").colors(np.zeros(3)), axis=0)) == 1


def test_a_range_is_a_fan_from_the_sensor(page):
    page.cockpit.sensors.show(LIDAR, True)
    drawn = []
    page.cockpit._scene.set_lines = lambda path, ends, color: drawn.append(ends)
    shown = page.cockpit.sensors._shown[LIDAR]
    shown._draw(messages.Range(messages.header(0.0, "f"), 0, 0.5, 0.1, 4.0, 2.0, 0.0))
    shown._draw(messages.Range(messages.header(0.0, "f"), 0, 0.5, 0.1, 4.0, float("inf"), 0.0))
    eye = page.twin.sensor("box_0", "lidar").pose.translation()
    away = np.linalg.norm(drawn[0] - eye, axis=1)
    assert away[[0, -1]] == pytest.approx(0.0)
    assert away[1:-1] == pytest.approx(2.0)
    assert drawn[1].shape == (0, 3)


def test_contacts_are_a_number_and_a_force():
    force = messages.Wrench(messages.Vector3(0.0, 3.0, 4.0), messages.Vector3(0.0, 0.0, 0.0))
    zero = messages.Vector3(0.0, 0.0, 0.0)
    state = messages.ContactState("", "a", "b", [force], messages.Wrench(zero, zero), [], [], np.zeros(0))
    groups = list(groups_of(messages.ContactsState(messages.header(0.0, "f"), [state, state])))
    assert [(group["name"], group["values"]) for group in groups] == [("states", [2.0]), ("force", [10.0])]
