"""Sensors on the page, without a browser."""

import json

import numpy as np
import pytest
from fake_page import FakePage
from seeing_robot import seeing

from drake_twin import Twin, messages
from drake_twin.cockpit import protocol
from drake_twin.cockpit.scene import OVERLAYS
from drake_twin.cockpit.sensor_view import groups_of, height_colors, points_of, small_picture
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
    picture = small_picture(rgb)
    assert picture.shape == (240, 320, 3)
    assert (picture[..., 0] == 200).all()
    message = messages.Image(messages.header(0.0, "f"), 480, 640, "rgb8", 0, 1920, rgb.ravel())
    page.cockpit.sensors.show(CAMERA, True)
    page.cockpit.sensors._shown[CAMERA]._picture("/camera", message)
    head, _, data = page.server.pictures["/camera"].partition(b"\n")
    assert json.loads(head) == {"key": CAMERA, "topic": "/camera", "width": 320, "height": 240}
    assert data == picture.tobytes()


def test_depths_are_shades_the_nearest_are_bright_and_what_is_not_seen_is_black():
    shades = small_picture(np.array([[1.0, 2.0, 3.0, np.inf, -np.inf, np.nan]], dtype=np.float32))[0, :, 0]
    assert shades.tolist() == [255, 137, 20, 0, 0, 0]
    assert small_picture(np.full((2, 2), np.inf)).max() == 0


def test_points_of_the_other_messages():
    angle = messages.Range(messages.header(0.0, "f"), 0, 0.5, 0.1, 4.0, 2.0, 0.0)
    assert np.linalg.norm(points_of(angle), axis=1) == pytest.approx(2.0)
    cloud = messages.PointCloud(messages.header(0.0, "f"), [messages.Point32(1.0, 2.0, 3.0)], [])
    assert points_of(cloud).tolist() == [[1.0, 2.0, 3.0]]


def test_a_large_cloud_is_thinned_out_evenly():
    data = np.zeros((480 * 640, 4), dtype=np.float32)
    data[:, 0], data[:, 1] = np.divmod(np.arange(len(data)), 640)
    layout = [messages.PointField(name, 4 * index, 7, 1) for index, name in enumerate("xyz")]
    bytes_ = data.view(np.uint8).ravel()
    points = points_of(
        messages.PointCloud2(messages.header(0.0, "f"), 480, 640, layout, False, 16, 10240, bytes_, True)
    )
    assert 19_000 < len(points) < 20_000
    assert len(np.unique(points[:, 0])) == 480
    assert len(np.unique(points[:, 1])) > 600


def test_heights_are_colors_from_blue_to_orange():
    colors = height_colors(np.array([[0, 0, 1.0], [0, 0, 2.0], [0, 0, 3.0]]))
    assert np.argmax(colors, axis=1).tolist() == [2, 1, 0]
    assert height_colors(np.zeros((0, 3))).shape == (0, 3)
    assert len(np.unique(height_colors(np.zeros((3, 3))), axis=0)) == 1


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
