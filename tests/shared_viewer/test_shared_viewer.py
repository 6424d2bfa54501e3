"""Twins on the page of a real ``meshcat-server``, which may be absent, hang, die and come back."""

import io
import json
import os
import signal
import subprocess
import sys
import threading

import numpy as np
import pytest
import zmq
from chromium import CHROMIUM, SOFTWARE_RENDERING
from conftest import ARM, rovers
from meshcat_server import MeshcatServer, free_address
from PIL import Image
from waiting import until

from drake_twin import TwinBuilder
from drake_twin.errors import InputError
from drake_twin.run import main
from drake_twin.shared_viewer.shared_viewer import SharedViewer

WHEELS = "/robot_1/forward_velocity_controller/commands"
LONG = 20  # s: for what comes soon or never


@pytest.fixture
def server():
    server = MeshcatServer()
    yield server
    server.kill()


@pytest.fixture
def viewers():
    """Makes viewers, and closes them."""
    made = []

    def make(*arguments, **options):
        made.append(SharedViewer(*arguments, **options))
        return made[-1]

    yield make
    for viewer in made:
        viewer.close(0.0)


def pose_on_page(scene, path):
    return np.reshape(scene[path]["set_transform"]["matrix"], (4, 4)).T


def pose_in_twin(twin, robot, body):
    plant = twin.plant
    frame = plant.GetBodyByName(body, plant.GetModelInstanceByName(robot))
    return plant.EvalBodyPoseInWorld(plant.GetMyContextFromRoot(twin.context), frame).GetAsMatrix4()


def warnings(caplog, text):
    return [record for record in caplog.records if text in record.getMessage()]


# --- a server that is there


def test_two_twins_show_under_a_folder_each(server, viewers):
    drivers, arm = rovers(1).build(), TwinBuilder().robot("arm", ARM).build()
    for name, twin in (("first", drivers), ("second", arm)):
        viewer = viewers(server.url, name)
        viewer.draw(twin)
        assert viewer.flush(LONG)
    scene = server.scene()
    assert {path.split("/")[2] for path in scene} == {"first", "second"}
    assert "set_object" in scene["/twins/first/robot_1/robot_1_base_link/body"]
    assert "set_object" in scene["/twins/second/arm/forearm/Mesh"]
    assert "set_object" in scene["/twins/second/world/ground"]
    base = pose_on_page(scene, "/twins/first/robot_1/robot_1_base_link")
    assert base == pytest.approx(pose_in_twin(drivers, "robot_1", "robot_1_base_link"), abs=1e-12)


def test_what_moves_moves_on_the_page(server, viewers):
    twin = rovers(1).command(WHEELS, [5] * 4).build()
    viewer = viewers(server.url, "a")
    twin.run(1.0, each_frame=lambda: viewer.draw(twin) or True, as_fast_as_possible=True)
    viewer.draw(twin)
    assert viewer.flush(LONG)
    base = pose_on_page(server.scene(), "/twins/a/robot_1/robot_1_base_link")
    assert base[0, 3] > 0.2
    assert base == pytest.approx(pose_in_twin(twin, "robot_1", "robot_1_base_link"), abs=1e-5)


def test_the_page_outlives_the_twin_and_a_later_one_of_that_name_takes_its_place(server, viewers):
    first = viewers(server.url, "a")
    first.draw(rovers(2).build())
    first.close(LONG)
    assert any("/robot_2/" in path for path in server.scene())
    second = viewers(server.url, "a")
    second.draw(rovers(1).build())
    assert second.flush(LONG)
    scene = server.scene()
    assert any("/robot_1/" in path for path in scene)
    assert not any("/robot_2/" in path for path in scene)


def test_a_robot_that_goes_disappears_from_the_page(server, viewers):
    viewer = viewers(server.url, "a")
    twin = rovers(2).build()
    viewer.draw(twin)
    assert viewer.flush(LONG)
    twin = rovers(1).build()
    viewer.draw(twin)
    assert viewer.flush(LONG)
    scene = server.scene()
    assert any("/robot_1/" in path for path in scene)
    assert not any("/robot_2/" in path for path in scene)


def test_the_page_is_announced_and_who_can_reach_it_is_said(server, viewers, caplog):
    pages = []
    viewer = viewers(server.url, "a", pages.append)
    viewer.draw(rovers(1).build())
    assert viewer.flush(LONG)
    assert pages == [server.page]
    assert len(warnings(caplog, "on every interface")) == 1


def test_the_page_of_another_machines_server_has_that_machines_name(viewers):
    """The server calls itself 127.0.0.1 whatever its address is."""
    server, pages = MeshcatServer("127.0.0.2"), []
    try:
        viewer = viewers(server.url, "a", pages.append)
        viewer.draw(rovers(1).build())
        assert viewer.flush(LONG)
        assert "//127.0.0.1:" in server.page
        assert pages == [server.page.replace("//127.0.0.1:", "//127.0.0.2:")]
    finally:
        server.kill()


# --- one that is not


def test_without_a_server_the_run_is_the_same_and_it_is_said_once(viewers, caplog):
    alone = rovers(1).command(WHEELS, [3] * 4).build()
    alone.advance_to(0.5)
    twin = rovers(1).command(WHEELS, [3] * 4).build()
    viewer = viewers(free_address(), "a")
    frames = []
    each_frame = lambda: frames.append(viewer.draw(twin)) or True  # noqa: E731
    twin.run(0.5, each_frame=each_frame, as_fast_as_possible=True)
    assert not viewer.flush(LONG)
    assert (viewer.counts.offered, viewer.counts.sent) == (len(frames), 0)
    assert twin.clock.step_count == 500
    assert twin.state_sha256() == alone.state_sha256()
    assert len(warnings(caplog, "no meshcat-server answers there")) == 1


def test_a_server_that_starts_later_is_sent_everything(server, viewers):
    server.kill()
    viewer = viewers(server.url, "a")
    viewer.draw(rovers(1).build())
    assert not viewer.flush(LONG)
    server.start()
    assert viewer.flush(LONG, wait_for_server=True)
    assert "set_object" in server.scene()["/twins/a/robot_1/robot_1_base_link/body"]


def test_a_server_that_dies_and_comes_back_is_sent_everything_again(server, viewers, caplog):
    twin = rovers(1).command(WHEELS, [5] * 4).build()
    viewer = viewers(server.url, "a")
    viewer.draw(twin)
    assert viewer.flush(LONG)
    server.kill()
    for _ in range(10):
        twin.advance_to(twin.time + 0.02)
        viewer.draw(twin)
    assert not viewer.flush(LONG)
    assert viewer.counts.dropped > 0
    assert len(warnings(caplog, "the meshcat-server is gone")) == 1
    server.start()
    assert viewer.flush(LONG, wait_for_server=True)
    scene = server.scene()
    assert "set_object" in scene["/twins/a/robot_1/robot_1_base_link/body"]
    base = pose_on_page(scene, "/twins/a/robot_1/robot_1_base_link")
    assert base == pytest.approx(pose_in_twin(twin, "robot_1", "robot_1_base_link"), abs=1e-5)
    assert len(warnings(caplog, "is back")) == 1


def test_while_a_server_hangs_only_the_latest_frame_is_kept(server, viewers, caplog):
    twin = rovers(1).command(WHEELS, [5] * 4).build()
    viewer = viewers(server.url, "a", patience=0.1)
    viewer.draw(twin)
    assert viewer.flush(LONG)
    server.process.send_signal(signal.SIGSTOP)
    for _ in range(50):
        twin.advance_to(twin.time + 0.02)
        viewer.draw(twin)
    assert not viewer.flush(0.5)
    server.process.send_signal(signal.SIGCONT)
    assert viewer.flush(LONG)
    assert viewer.counts.sent <= 3  # the first, the one on its way when it stopped, the last
    base = pose_on_page(server.scene(), "/twins/a/robot_1/robot_1_base_link")
    assert base == pytest.approx(pose_in_twin(twin, "robot_1", "robot_1_base_link"), abs=1e-5)
    assert len(warnings(caplog, "has not answered for 0.1 s")) == 1


def test_what_it_costs_is_counted_frame_by_frame(viewers):
    viewer, twin = viewers(free_address(), "a"), rovers(1).build()
    costs = []
    for _ in range(3):
        viewer.draw(twin)
        costs.append(viewer.cost)
    assert [cost.frames for cost in costs] == [1, 2, 3]
    assert 0 < costs[0].wall_time < costs[1].wall_time < costs[2].wall_time
    assert costs[2].slowest < costs[2].wall_time


def test_something_else_at_the_address_is_not_taken_for_a_server(viewers, caplog):
    url = free_address()
    with zmq.Context() as context, context.socket(zmq.REP) as other:
        other.linger = 0
        other.bind(url)
        asked = []

        def answer():
            asked.append(other.recv_multipart())
            other.send(b"who are you")

        thread = threading.Thread(target=answer)
        thread.start()
        viewer = viewers(url, "a")
        viewer.draw(rovers(1).build())
        assert not viewer.flush(LONG)
        thread.join()
        viewer.close(0.0)
    assert asked == [[b"url"]]
    assert len(warnings(caplog, "another program answers there, not a meshcat-server")) == 1


@pytest.mark.parametrize(
    "url", ["", "127.0.0.1:6000", "http://127.0.0.1:6000", "tcp://host", "tcp://*:6000", "tcp://a:0"]
)
def test_what_is_no_address_is_refused(url):
    with pytest.raises(InputError, match="is not the address of a meshcat-server"):
        SharedViewer(url, "a")


@pytest.mark.parametrize("name", ["", "a/b", " a", "<object>", "a\n"])
def test_what_is_no_folder_is_refused(name):
    with pytest.raises(InputError, match="cannot be a folder on the shared page"):
        SharedViewer("tcp://127.0.0.1:6000", name)


# --- the program


def test_the_program_shows_a_run_on_the_page_and_leaves_it_there(server, capsys, tmp_path):
    file = tmp_path / "summary.json"
    arguments = ["--robots", "2", "--headless", "--duration", "0.2", "--viewer", server.url, "--summary", str(file)]
    assert main([*arguments, "--viewer-name", "mine"]) == 0
    assert f"shared page: {server.page} (folder twins/mine)" in capsys.readouterr().out
    base = pose_on_page(server.scene(), "/twins/mine/robot_2/robot_2_base_link")
    at_the_end = json.loads(file.read_text())["robots"]["robot_2"]["base_pose"][:3]
    assert base[:3, 3] == pytest.approx(at_the_end, abs=1e-5)


def test_the_folder_is_named_after_the_target_and_the_process(server, capsys):
    assert main(["diagrams/two_arms.yaml", "--headless", "--duration", "0.01", "--viewer", server.url]) == 0
    assert f"(folder twins/two_arms-{os.getpid()})" in capsys.readouterr().out


def test_ctrl_c_ends_a_run_whose_server_hangs(server):
    command = [sys.executable, "-m", "drake_twin.run", "--headless", "--viewer", server.url]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    with process:
        assert process.stdout.readline().startswith("shared page: ")
        server.process.send_signal(signal.SIGSTOP)
        process.send_signal(signal.SIGINT)
        assert process.wait(LONG) == 0


def test_a_name_without_a_viewer_is_refused(capsys):
    assert main(["--viewer-name", "a"]) == 2
    assert "it needs --viewer URL" in capsys.readouterr().err


# --- the page as a person sees it


@pytest.mark.browser
@pytest.mark.skipif(CHROMIUM is None, reason="no Chromium here (on Debian: apt install chromium)")
def test_a_person_sees_the_robots_of_both_twins(server, viewers, tmp_path):
    from playwright.sync_api import sync_playwright

    twins = {
        "rover": rovers(1).build(),
        "arm": TwinBuilder().robot("arm", ARM, xyz=(0, 1, 0)).build(),
    }
    for name, twin in twins.items():
        viewer = viewers(server.url, name)
        viewer.draw(twin)
        assert viewer.flush(LONG)
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=CHROMIUM, args=SOFTWARE_RENDERING)
        page = browser.new_page(viewport={"width": 800, "height": 600})
        page.goto(server.page)

        def both_are_seen():  # the page draws when the browser gets to it, and says nothing about it
            picture = Image.open(io.BytesIO(page.screenshot())).convert("RGB")
            red, green, blue = np.moveaxis(np.asarray(picture).astype(int)[200:], 2, 0)
            orange = (red > 130) & (red > 1.6 * green) & (green > 1.5 * blue)  # the rover's
            blueish = (blue > 90) & (blue > 1.6 * green) & (green > 1.5 * red)  # the arm's
            return orange.sum() > 100 and blueish.sum() > 100

        until(both_are_seen)
        browser.close()
