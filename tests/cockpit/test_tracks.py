"""Tracks of robots against the states that they had."""

from itertools import pairwise

import numpy as np
import pytest
from conftest import ARM, rovers
from fake_page import FakePage
from test_overlays import Drawn

from drake_twin import TwinBuilder
from drake_twin.cockpit import protocol
from drake_twin.cockpit.overlay import OVERLAY_KINDS
from drake_twin.cockpit.overlays.tracks import COLORS
from drake_twin.cockpit.scene import OVERLAYS

WHEELS = "/robot_{}/forward_velocity_controller/commands"


class Lines(Drawn):
    """What is drawn now; lines go when they are deleted."""

    def __init__(self):
        super().__init__()
        self.shared_ = None
        self.tints = {}

    def shared(self, twin):
        self.shared_ = self.shared_ or super().shared(twin)
        return self.shared_

    def set_lines(self, path, ends, color, **_):
        self.lines[path], self.tints[path] = ends, color

    def delete(self, path):
        for each in [each for each in self.lines if each == path or each.startswith(f"{path}/")]:
            del self.lines[each]

    def of(self, robot):
        """The ends of a robot's lines."""
        ends = [self.lines[path][np.all(self.tints[path] == COLORS[robot], axis=1)] for path in self.lines]
        return np.vstack([np.empty((0, 3)), *ends])


def drive(twin, drawn, tracks, until, apart=0.1):
    """The places of both robots at each point of their tracks."""
    places = []
    while twin.time < until - 1e-9:
        twin.advance_to(round(twin.time + apart, 6))
        tracks.draw()
        places.append([twin.robot_state(robot).base_pose[:3] for robot in twin.robots])
    return np.array(places)


def test_a_track_leads_through_the_places_where_the_robot_was():
    twin, drawn = rovers(2).build(), Lines()
    tracks = OVERLAY_KINDS["tracks"].type(drawn, twin)
    tracks.draw()
    twin.publish(WHEELS.format(1), [6, 6, 6, 6])
    twin.publish(WHEELS.format(2), [2, 8, 2, 8])
    places = drive(twin, drawn, tracks, 5.0)
    for robot in range(2):
        ends = drawn.of(robot)
        assert len(ends) == 2 * 50
        for place in places[:, robot]:
            assert np.linalg.norm(ends - place, axis=1).min() < 1e-9
        length = np.linalg.norm(ends[1::2] - ends[::2], axis=1).sum()
        assert length == pytest.approx(np.linalg.norm(np.diff(places[:, robot], axis=0), axis=1).sum(), rel=0.05)


def test_a_reset_ends_the_track_and_a_place_elsewhere_is_not_driven_to():
    twin, drawn = rovers(2).build(), Lines()
    tracks = OVERLAY_KINDS["tracks"].type(drawn, twin)
    twin.publish(WHEELS.format(1), [6, 6, 6, 6])
    drive(twin, drawn, tracks, 3.0)
    assert len(drawn.of(0)) > 20
    twin.entities.place("robot_1", (50, 50, 0.2))
    drive(twin, drawn, tracks, 3.3)
    ends = drawn.of(0)
    assert np.linalg.norm(ends[1::2] - ends[::2], axis=1).max() < 1.0
    twin.reset()
    tracks.draw()
    assert drawn.lines == {}


def test_only_the_last_minute_is_there_and_only_the_last_stretch_is_sent_again(monkeypatch):
    twin, drawn = rovers(1).build(), Lines()
    tracks = OVERLAY_KINDS["tracks"].type(drawn, twin)
    for step in range(700):
        tracks._add(0.1 * step, np.array([[0.1 * step, 0, 0]]))
    ends = drawn.of(0)
    assert ends[:, 0].max() == pytest.approx(69.9)
    assert 69.9 - 62.1 <= ends[:, 0].min() <= 69.9 - 59.9
    sizes = [len(lines) for lines in drawn.lines.values()]
    assert max(sizes) <= 2 * 21
    written = []
    monkeypatch.setattr(drawn, "set_lines", lambda path, *_: written.append(path))
    tracks._add(70.0, np.array([[70.0, 0, 0]]))
    assert written == [f"{OVERLAYS}/tracks/35"]


def test_a_robot_that_stands_adds_nothing_and_an_arms_last_link_draws_its_path():
    twin, drawn = TwinBuilder().robot("arm", ARM).build(), Lines()
    tracks = OVERLAY_KINDS["tracks"].type(drawn, twin)
    tracks.draw()
    twin.advance_to(0.5)
    tracks.draw()
    assert len(drawn.of(0)) == 0
    before = twin.plant.get_body(tracks._bodies[0]).EvalPoseInWorld(twin.plant.GetMyContextFromRoot(twin.context))
    twin.entities.set_joint_positions("arm", {"joint_1": 0.5})
    twin.advance_to(0.7)
    tracks.draw()
    turned = twin.plant.get_body(tracks._bodies[0]).EvalPoseInWorld(twin.plant.GetMyContextFromRoot(twin.context))
    assert np.linalg.norm(turned.translation() - before.translation()) > 0.05
    assert drawn.of(0)[:2] == pytest.approx(np.array([before.translation(), turned.translation()]), abs=1e-4)


def test_a_track_that_is_switched_on_late_has_what_was_seen_before():
    page = FakePage(rovers(2).build())
    page.twin.publish(WHEELS.format(1), [6, 6, 6, 6])
    page.frames(until=lambda: page.twin.time > 2.0)
    page.ask(protocol.Show("tracks", True))
    tracks = page.cockpit._overlays["tracks"]
    times = [time for time, _ in tracks._samples]
    pictures = [picture.time for picture in page.cockpit._timeline._pictures]
    assert set(times) <= set(pictures)
    assert all(0.1 - 1e-6 < later - time < 0.3 + max(np.diff(pictures)) for time, later in pairwise(times))
    assert times[0] == page.cockpit._timeline._pictures[0].time
    driven, standing = tracks._samples[0][1]
    assert 0 <= driven[0] < 0.7 * times[0] + 0.02  # wheels of 0.1 m turn at 6 rad/s
    assert standing == pytest.approx([0, 2, 0.13], abs=0.01)
