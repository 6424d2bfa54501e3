"""The timeline of the page, without a browser."""

from dataclasses import replace

import numpy as np
import pytest
import umsgpack
from conftest import ROVER, rovers
from fake_page import FakePage

from drake_twin import Robot, Twin
from drake_twin.cockpit import protocol
from drake_twin.cockpit.scene import Scene

WHEELS = "/robot_1/forward_velocity_controller/commands"


class Watched:
    """A page with a timeline; its frames are a thirtieth of a second of simulation time apart."""

    def __init__(self, builder):
        self.scene = Scene()
        self.page = FakePage(builder.build(), self.scene)
        self.twin = self.page.twin
        self.page.cockpit.process_requests()

    def run_to(self, time):
        while self.twin.time < time - 1e-9:
            self.twin.advance_to(min(time, self.twin.time + 1 / 30))
            self.page.cockpit.process_requests()

    def ask(self, *requests):
        self.page.ask(*requests)
        self.page.cockpit.process_requests()

    @property
    def told(self):
        self.page.cockpit.publish()
        return self.page.server.told["timeline"]

    @property
    def drawn_x(self):
        """Where the page draws the first rover's base along x (m)."""
        commands = map(umsgpack.unpackb, self.scene.everything().contents())
        paths = {item["path"]: item for item in commands if item["type"] == "set_transform"}
        matrix = np.array(paths["/twin/robot_1/robot_1_base_link"]["matrix"]).reshape(4, 4)
        return float(matrix[3, 0])  # column by column


@pytest.fixture
def driving():
    it = Watched(rovers(2).command(WHEELS, [5.0, 5.0, 5.0, 5.0]))
    yield it
    it.page.cockpit.close()


def true_x(twin):
    return twin.entities.state("robot_1").position[0]


def test_looking_back_draws_where_the_robot_was_and_pauses(driving):
    driving.run_to(1.5)
    then = true_x(driving.twin)
    driving.run_to(3.0)
    before = driving.twin.state_sha256()
    driving.ask(protocol.Look(1.5))
    assert driving.twin.clock.paused
    assert driving.twin.time == pytest.approx(3.0)
    assert driving.drawn_x == pytest.approx(then, abs=0.01)  # a picture each 0.03 s, at 0.5 m/s
    assert driving.told["looked"] == pytest.approx(1.5, abs=0.04)
    assert driving.told["back_to"] == pytest.approx(1.5 if driving.told["looked"] >= 1.5 else 1.0)
    driving.ask(protocol.LookAtNow())
    assert driving.drawn_x == pytest.approx(true_x(driving.twin), abs=1e-6)
    assert driving.told["looked"] is None
    assert driving.twin.state_sha256() == before


def test_going_on_from_now_or_from_there_is_as_if_nobody_had_looked(driving):
    plain = rovers(2).command(WHEELS, [5.0, 5.0, 5.0, 5.0]).build()
    plain.advance_to(13.0)
    driving.run_to(12.5)
    driving.ask(protocol.Look(2.6))
    driving.ask(protocol.Play())
    assert driving.told["looked"] is None
    driving.run_to(13.0)
    assert driving.twin.state_sha256() == plain.state_sha256()
    driving.ask(protocol.Look(3.0), protocol.GoOnFrom(2.6))
    assert driving.twin.time == 2.5
    assert not driving.twin.clock.paused
    assert driving.drawn_x == pytest.approx(true_x(driving.twin), abs=1e-6)
    assert driving.page.messages[-1] == ("info", "the twin went back from 13.000 s and continues from 2.500 s")
    driving.run_to(13.0)
    assert driving.twin.state_sha256() == plain.state_sha256()


@pytest.mark.parametrize("request_", [protocol.Play(), protocol.Step(1), protocol.Reset()])
def test_a_present_that_changes_is_drawn(driving, request_):
    driving.run_to(1.0)
    driving.ask(protocol.Look(0.4))
    driving.ask(request_)
    driving.twin.pause()
    driving.run_to(driving.twin.time)
    if request_ == protocol.Play():
        driving.twin.play()
        driving.run_to(1.1)
    assert driving.told["looked"] is None
    assert driving.drawn_x == pytest.approx(true_x(driving.twin), abs=1e-6)


def test_robots_that_were_deleted_are_seen_again(driving):
    driving.run_to(0.7)
    driving.twin.entities.delete("robot_2")
    driving.run_to(1.2)
    assert not driving.scene.has_path("/twin/robot_2")
    driving.ask(protocol.Look(0.6))
    assert driving.scene.has_path("/twin/robot_2")
    driving.ask(protocol.GoOnFrom(0.6))
    assert driving.twin.robots == ("robot_1", "robot_2")


def test_a_minute_is_kept_in_little_memory():
    it = Watched(rovers(8, time_step=0.02))
    it.run_to(63.0)
    timeline = it.page.cockpit._timeline
    assert it.told["first"] == pytest.approx(3.0, abs=0.05)
    assert len(timeline._pictures) <= 60 * 30 + 2
    assert it.told["bytes"] <= 8_000_000  # 1,800 pictures of 40 bodies of 48 bytes, and the moments; the bound is 50 MB
    assert sum(item.size for item in timeline._pictures) == timeline._size
    it.page.cockpit.close()


def test_the_bytes_that_are_told_are_those_that_are_kept(driving, monkeypatch):
    """A picture is 48 bytes a body; the oldest go at the bound, and those after the moment that is returned to."""
    driving.run_to(1.0)
    timeline = driving.page.cockpit._timeline
    count = len(timeline._pictures)
    timeline._pictures[0] = replace(timeline._pictures[0], size=timeline._pictures[1].size)  # without its scene
    timeline._size = sum(item.size for item in timeline._pictures)
    (picture,) = {item.size for item in timeline._pictures}
    assert picture == 48 * len(timeline._pictures[0].poses)
    assert 20 < count <= 31
    assert driving.told["bytes"] == count * picture + timeline._rewind.size
    monkeypatch.setattr("drake_twin.cockpit.timeline._MOST_BYTES", count * picture)
    driving.run_to(1.5)
    assert len(timeline._pictures) == count  # at the bound, and not one fewer
    assert driving.told["first"] > 0.4
    assert driving.told["bytes"] == count * picture + timeline._rewind.size
    monkeypatch.undo()
    driving.ask(protocol.GoOnFrom(0.6))
    kept = sum(item.time <= 0.5 for item in timeline._pictures)
    assert 0 < kept < 20
    assert driving.told["bytes"] == sum(item.size for item in timeline._pictures) + timeline._rewind.size
    assert len(timeline._pictures) in (kept, kept + 1)  # and the present


def test_the_scenes_that_spawns_leave_count(driving, monkeypatch):
    """Each has all geometries of the twin: a spawn and a delete in each second were ten times as large as the poses."""
    timeline = driving.page.cockpit._timeline
    for number in range(8):
        driving.twin.entities.spawn(Robot(f"guest_{number}", ROVER, xyz=(3.0, 0.0, 0.13)))
        driving.run_to(driving.twin.time + 0.1)
        driving.twin.entities.delete(f"guest_{number}")
        driving.run_to(driving.twin.time + 0.1)
    scenes = {id(item.scene): item.scene for item in timeline._pictures}.values()
    geometries = sum(len(scene.geometries) for scene in scenes)
    assert len(scenes) >= 16
    assert timeline._size >= 430 * geometries
    monkeypatch.setattr("drake_twin.cockpit.timeline._MOST_BYTES", timeline._size // 2)
    driving.run_to(driving.twin.time + 0.1)
    assert len({id(item.scene) for item in timeline._pictures}) < len(scenes)


def test_without_a_browser_nothing_is_kept():
    it = Watched(rovers(1))
    it.run_to(0.6)
    it.page.server.clients, it.page.server.is_watched = (), False
    it.run_to(2.0)
    times = it.page.cockpit._timeline._rewind.times
    assert times == (0.0, 0.5)
    assert it.twin.recorder.listeners == []
    it.page.server.clients, it.page.server.is_watched = (1,), True
    it.run_to(2.6)
    assert it.page.cockpit._timeline._rewind.times[:2] == (0.0, 0.5)  # what was kept is still there
    assert it.page.cockpit._timeline._rewind.times[-1] == 2.5
    it.page.cockpit.close()
    fresh = FakePage(rovers(1).build())
    fresh.server.clients = ()
    fresh.cockpit.process_requests()
    assert fresh.cockpit._timeline._rewind is None
    fresh.cockpit.close()


def test_what_cannot_be_looked_at_or_returned_to_is_said():
    page = FakePage(rovers(1).build())
    page.ask(protocol.GoOnFrom(0.0))
    page.server.is_watched = False
    page.ask(protocol.GoOnFrom(1.0))
    texts = [text for _, text in page.messages]
    assert "no moment is kept yet: the twin has not advanced" in texts[0]
    page.cockpit.close()


def test_after_a_reset_nothing_of_the_former_future_is_looked_at(driving):
    driving.run_to(2.0)
    driving.ask(protocol.Reset(), protocol.Look(1.5))
    assert (driving.twin.time, driving.told["looked"]) == (0.0, None)
    assert "nothing was drawn yet that could be looked at again" in driving.page.messages[-1][1]


def test_a_callback_cannot_go_back_in_time(driving):
    driving.run_to(1.0)
    driving.page.server.ask(protocol.GoOnFrom(0.5))
    driving.page.cockpit.process_requests(in_callback=True)
    driving.page.cockpit.publish()
    assert "GoOnFrom is refused while the program advances the twin itself" in driving.page.messages[-1][1]


def test_marks_are_told(driving):
    driving.run_to(0.6)
    driving.ask(protocol.EmergencyStop("robot_1"))
    mark = {"kind": "command", "text": "emergency stop robot_1", "start": 0.6, "end": 0.6}
    assert mark in driving.told["marks"]


def test_robots_that_are_only_displayed_have_no_timeline():
    page = FakePage(Twin(rovers(1).scenario()), only_displayed=True)
    page.cockpit.process_requests()
    page.cockpit.publish()
    assert page.server.told["timeline"] is None
    page.cockpit.close()


def test_a_replay_draws_at_the_rate_and_ends_with_the_last_picture(driving):
    driving.run_to(2.0)
    timeline = driving.page.cockpit._timeline
    driving.twin.clock.real_time_rate = 2.0
    driving.ask(protocol.Look(0.5))
    timeline.draw(100.0)
    timeline.do(protocol.Replay(True))
    assert timeline.draw(100.1)
    assert timeline._replayed == pytest.approx(0.7, abs=0.04)
    for frame in range(2, 10):
        timeline.draw(100 + frame / 10)
    assert timeline._replayed is None
    assert driving.told["looked"] == pytest.approx(2.0, abs=0.04)
    assert driving.twin.time == pytest.approx(2.0)
    assert not driving.told["replaying"]


def test_a_loop_begins_again(driving):
    driving.run_to(1.0)
    timeline = driving.page.cockpit._timeline
    driving.ask(protocol.Look(0.9), protocol.Loop(True))
    timeline.draw(50.0)
    timeline.do(protocol.Replay(True))
    timeline.draw(50.19)
    assert timeline._looked is timeline._pictures[0]
    assert driving.told["replaying"]
    assert driving.told["loop"]
    driving.ask(protocol.Replay(False))
    looked = timeline._looked
    timeline.draw(60.0)
    assert timeline._looked is looked


def test_steps_go_from_picture_to_picture(driving):
    driving.run_to(1.0)
    timeline = driving.page.cockpit._timeline
    driving.ask(protocol.LookBy(-3))
    assert timeline._looked is timeline._pictures[-4]
    driving.ask(protocol.LookBy(1))
    assert timeline._looked is timeline._pictures[-3]
    driving.ask(protocol.LookBy(-10_000))
    assert timeline._looked is timeline._pictures[0]
    driving.ask(protocol.LookBy(10_000))
    assert timeline._looked is timeline._pictures[-1]
