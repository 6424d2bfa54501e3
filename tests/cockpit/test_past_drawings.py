"""What is drawn besides the robots, at a moment that is looked at: as a browser had it then."""

import numpy as np
import pytest
import umsgpack
from conftest import rovers
from fake_page import FakePage
from seeing_robot import seeing

from drake_twin.cockpit import past_drawings, protocol
from drake_twin.cockpit.scene import OVERLAYS, Scene
from drake_twin.shared_viewer.meshcat_protocol import delete, set_transform

WHEELS = "/robot_1/forward_velocity_controller/commands"


class Browser:
    """What a browser has drawn at and below a path: each object, pose and property by the path."""

    def __init__(self, scene, root=OVERLAYS):
        self.root, self.drawn = root, {}
        scene.listen(self.hear)

    def hear(self, commands):
        for command in commands:
            item = umsgpack.unpackb(command[2])
            path = item["path"]
            if not path.startswith(self.root):
                continue
            if item["type"] == "delete":
                self.drawn = {
                    key: value for key, value in self.drawn.items() if not f"{key[0]}/".startswith(f"{path}/")
                }
            else:
                self.drawn[path, item["type"], item.get("property")] = command[2]

    def seen(self):
        """The objects, with all that holds for them and for the folders around them; what is hidden is not seen."""
        objects = [path for path, kind, _ in self.drawn if kind == "set_object"]
        hidden = {
            path
            for (path, _, name), content in self.drawn.items()
            if name == "visible" and not umsgpack.unpackb(content)["value"]
        }
        objects = [each for each in objects if not any(f"{each}/".startswith(f"{path}/") for path in hidden)]
        return {
            key: content
            for key, content in self.drawn.items()
            if key[2] != "visible" and any(f"{each}/".startswith(f"{key[0]}/") for each in objects)
        }


class Watched:
    """A page whose frames are a thirtieth of a second apart, a browser, and what that had drawn at each frame."""

    def __init__(self, builder, *overlays):
        self.page = FakePage(builder.build(), Scene())
        self.twin, cockpit = self.page.twin, self.page.cockpit
        self.browser = Browser(cockpit._scene)
        cockpit.process_requests()
        self.page.ask(*(protocol.Show(name, True) for name in overlays))
        self.then = []

    def run_to(self, time):
        while self.twin.time < time - 1e-9:
            self.twin.advance_to(min(time, self.twin.time + 1 / 30))
            self.page.cockpit.process_requests()
            self.then.append((self.twin.time, self.browser.seen()))

    def ask(self, *requests):
        self.page.ask(*requests)
        self.page.cockpit.process_requests()


@pytest.fixture
def watched():
    made = []

    def make(builder, *overlays):
        made.append(Watched(builder, *overlays))
        return made[-1]

    yield make
    for each in made:
        each.page.cockpit.close()


def moving():
    """Two rovers that fall to the ground, of which one drives."""
    return rovers(2).command(WHEELS, [5.0, 3.0, 5.0, 3.0])


ALL = ("contacts", "frames", "tracks", "masses", "joints", "goals", "starts", "collision")


@pytest.mark.parametrize("overlays", [(name,) for name in ALL] + [ALL])
def test_a_browser_has_again_what_it_had_then(watched, overlays):
    it = watched(moving(), *overlays)
    it.run_to(2.0)
    now = it.browser.seen()
    for time in np.random.default_rng(3).uniform(0.1, 1.9, 12):
        it.ask(protocol.Look(float(time)))
        near = [seen for at, seen in it.then if time - 0.17 < at < time + 0.05]
        assert it.browser.seen() in near, time
    it.ask(protocol.LookAtNow())
    assert it.browser.seen() == now


def test_who_opens_the_page_meanwhile_sees_that_moment_too(watched):
    it = watched(moving(), "contacts", "frames")
    it.run_to(1.0)
    it.ask(protocol.Look(0.4))
    late = Browser(Scene())
    late.hear(list(it.page.cockpit._scene.everything()))
    assert late.seen() == it.browser.seen()


def test_what_is_switched_off_stays_off_and_what_is_switched_on_is_of_the_present(watched):
    it = watched(moving(), "contacts", "frames")
    it.run_to(1.0)
    it.ask(protocol.Look(0.4), protocol.Show("contacts", False))
    it.ask(protocol.Look(0.6))
    assert not any("/contacts" in path for path, *_ in it.browser.drawn)
    it.ask(protocol.LookAtNow())
    assert not any("/contacts" in path for path, *_ in it.browser.drawn)
    assert any("/frames" in path for path, *_ in it.browser.drawn)


def test_the_memory_is_bounded_and_what_is_not_kept_is_not_drawn(watched, monkeypatch):
    monkeypatch.setattr(past_drawings, "_MOST_BYTES", 60_000)
    it = watched(moving(), "contacts", "frames", "starts")
    it.run_to(6.0)
    past = it.page.cockpit._past
    kept = sum(len(content) for slot in past._slots for content in slot.commands.contents())
    assert 0 < kept < 3 * 60_000
    it.ask(protocol.Look(0.2))  # of which only the poses are kept
    assert {path.split("/")[2] for path, *_ in it.browser.seen()} == {"starts"}
    it.ask(protocol.Look(5.9))
    assert "contacts" in {path.split("/")[2] for path, *_ in it.browser.seen()}


def test_a_reset_forgets_what_was_drawn_after_it(watched):
    it = watched(moving(), "contacts")
    it.run_to(1.0)
    it.twin.reset()
    it.run_to(0.5)
    assert all(slot.end <= 0.5 + 1e-9 for slot in it.page.cockpit._past._slots)


def test_a_page_that_nobody_has_open_keeps_nothing(watched):
    it = watched(moving(), "contacts")
    it.page.server.clients = ()
    it.run_to(0.5)
    assert not it.page.cockpit._past._slots


def test_points_and_pictures_of_sensors_are_those_of_the_moment(watched, tmp_path):
    it = watched(seeing(tmp_path))
    it.ask(*(protocol.ShowSensor(f"box_0/{place}", True) for place in sensor_places(it)))
    pictures = []
    it.page.cockpit._past._send = lambda key, data: pictures.append((it.twin.time, key, data))
    it.run_to(0.3)
    it.twin.entities.place("box_0", xyz=(0.5, 0, 0.1))  # nearer to the wall
    it.run_to(1.0)
    (topic,) = {key for _, key, _ in pictures}
    told = len(pictures)
    it.ask(protocol.Look(0.25))
    assert len(pictures) == told + 1
    assert pictures[-1][2] in [data for at, _, data in pictures[:told] if at < 0.3]
    assert it.browser.seen() in [seen for at, seen in it.then if 0.05 < at < 0.3]
    it.ask(protocol.LookAtNow())
    assert pictures[-1][1:] == (topic, pictures[told - 1][2])


def sensor_places(it):
    return [item["key"].partition("/")[2] for item in it.page.cockpit.sensors.listing() if item["robot"] == "box_0"]


def test_only_what_is_drawn_besides_the_robots_is_kept():
    scene, times = Scene(), iter([0.0] * 9)
    past = past_drawings.PastDrawings(lambda: next(times), scene, lambda *_: None)
    past.keep(True)
    scene.send([set_transform("/twin/robot_1/base", np.eye(4))])
    assert not past._slots
    scene.send([set_transform(f"{OVERLAYS}/mine/1", np.eye(4)), delete(f"{OVERLAYS}/mine/2")])
    assert len(past._slots) == 1
