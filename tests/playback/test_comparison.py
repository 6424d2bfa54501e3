"""Two runs laid over each other: the differences are those that were put in, and none otherwise."""

import numpy as np
import pytest
from conftest import rovers
from playback.recorded_bags import cart_messages, record, write

from drake_twin import Twin
from drake_twin.cockpit import protocol
from drake_twin.cockpit.scene import Scene
from drake_twin.playback.bag import Bag
from drake_twin.playback.bag_player import BagPlayer
from drake_twin.playback.comparison import GHOSTS, Comparison
from drake_twin.playback.robots import recorded_scenario

STATES = "/robot_1/joint_states"
COMMANDS = "/robot_1/forward_velocity_controller/commands"
REAR = "robot_1_rear_left_wheel_joint"


def driving(rear_left=2.0):
    order = ["front_left", "front_right", "rear_left", "rear_right"]
    return rovers(1).command(COMMANDS, [rear_left if name == "rear_left" else 2.0 for name in order])


@pytest.fixture(scope="module")
def bags(tmp_path_factory):
    folder = tmp_path_factory.mktemp("bags")
    for name, speed in (("first", 2.0), ("same", 2.0), ("other", 3.0)):
        record(driving(speed).build(), folder / name, 2.0)
    return folder


def read(panel):
    for _ in range(10_000):
        state = panel.state()
        if state["progress"] is None:
            return state
    raise AssertionError("it is never read")


@pytest.fixture
def playing(bags):
    with Bag(bags / "first") as bag:
        scenario, robots = recorded_scenario(bag)
        player = BagPlayer(bag, Twin(scenario), robots)
        yield player
        player.comparison.close()


def test_two_equal_runs_have_no_difference(playing, bags):
    playing.comparison.ask({"do": "Open", "bag": str(bags / "same")})
    state = read(playing.comparison)
    assert state["name"] == "same"
    assert state["topics"] > 1
    assert state["table"] == []


def test_a_difference_that_was_put_in_comes_first_with_its_size(playing, bags):
    playing.comparison.open(bags / "other")
    table = read(playing.comparison)["table"]
    joints = {row["field"]: row for row in table if row["topic"] == STATES}
    speed = joints[f"velocity[{REAR}]"]
    assert speed["unit"] == "rad/s"
    assert speed["difference"] >= 0.95
    place = joints[f"position[{REAR}]"]
    assert place["at"] == pytest.approx(2.0, abs=0.02)
    with Bag(bags / "first") as first, Bag(bags / "other") as other:  # the last messages, read by rosbags
        ends = []
        for bag in (first, other):
            *_, last = bag.messages(lambda topic, _: topic == STATES)
            message = last.read()
            ends.append(message.position[message.name.index(REAR)])
    assert place["difference"] == pytest.approx(abs(ends[1] - ends[0]), rel=1e-9)


def test_a_run_is_compared_as_it_goes_on(bags):
    twin = driving(3.0).build()
    panel = Comparison(twin)
    panel.open(bags / "other")
    read(panel)
    twin.advance_to(1.0)
    for _ in range(20):
        state = panel.state()
    assert state["table"] == []  # the same run again
    twin.publish(COMMANDS, [0.0, 0.0, 0.0, 0.0])
    twin.advance_to(1.5)
    for _ in range(20):
        state = panel.state()
    assert max(row["at"] for row in state["table"]) > 1.0
    assert min(row["at"] for row in state["table"]) > 0.99
    panel.close()


def test_a_run_is_compared_from_the_moment_on_that_the_bag_was_opened_though_no_page_was(bags):
    twin = driving(2.0).build()
    panel = Comparison(twin)
    panel.open(bags / "other")
    twin.advance_to(3.0)  # the bag ends at 2 s
    state = read(panel)
    assert state["meet"]
    assert f"velocity[{REAR}]" in [row["field"] for row in state["table"]]
    panel.close()


def test_a_run_that_is_past_the_bags_end_is_not_called_equal(bags):
    twin = driving(2.0).build()
    twin.advance_to(3.0)
    panel = Comparison(twin)
    panel.open(bags / "other")
    twin.advance_to(3.5)
    state = read(panel)
    assert (state["table"], state["meet"]) == ([], False)
    assert state["until"] == pytest.approx(2.0, abs=0.02)
    twin.reset()
    twin.advance_to(1.0)
    assert panel.state()["meet"]
    panel.close()


def test_the_others_robots_are_drawn_where_they_were(playing, bags):
    scene = Scene()
    playing.comparison.open(bags / "other")
    playing.comparison.draw(scene, 1.5)
    assert scene.has_path(GHOSTS)
    ghost = playing.comparison._other._player
    assert ghost.time == pytest.approx(1.5)
    playing.advance_to(1.5)
    turned = [np.array(item._twin.robot_state("robot_1").positions) for item in (ghost, playing)]
    apart = np.abs(turned[0] - turned[1])
    assert apart.max() == pytest.approx(1.5, abs=0.1)  # 1 rad/s more on one wheel
    playing.comparison.ask({"do": "Close"})
    playing.comparison.draw(scene, 1.5)
    assert not scene.has_path(GHOSTS)


def test_what_is_no_bag_is_refused_in_the_panel(playing, tmp_path):
    playing.comparison.ask({"do": "Open", "bag": str(tmp_path / "nothing")})
    assert "the bag does not exist" in playing.comparison.state()["problem"]


def test_bags_of_the_wall_clock_are_laid_over_each_other_by_their_starts(tmp_path):
    later = [(topic, kind, seconds + 3600.0, message) for topic, kind, seconds, message in cart_messages()]
    with Bag(write(tmp_path / "one", cart_messages())) as bag:
        scenario, robots = recorded_scenario(bag)
        player = BagPlayer(bag, Twin(scenario), robots)
        player.comparison.open(write(tmp_path / "two", later))
        state = read(player.comparison)
        assert state["table"] == []
        assert state["topics"] == 1
        player.comparison.close()


def test_a_bags_panel_lists_echoes_and_plots_what_it_holds(tmp_path):
    with Bag(write(tmp_path / "bag", cart_messages())) as bag:
        scenario, robots = recorded_scenario(bag)
        player = BagPlayer(bag, Twin(scenario), robots)
        topics = player.panels["topics"]
        assert topics.state() is None
        topics.ask({"do": "Look", "version": 0, "echo": "/joint_states", "frames": True})
        topics.ask({"do": "Plot", "topic": "/joint_states", "field": "position[lift]"})
        topics.ask({"do": "Plot", "topic": "/joint_states", "field": "position[nobody]"})
        topics.ask({"do": "Plot", "topic": "/nothing", "field": "x"})
        player.do(protocol.Look(1.05))
        state = topics.state()
        assert {row["name"] for row in state["topics"]} == set(bag.topics)
        rows = {path: text for path, text, _ in state["echoes"]["/joint_states"]["rows"]}
        assert rows["position[lift]"] == "0.25"
        assert {row["frame"] for row in state["frames"]} >= {"base", "odom"}
        found, problems = {}, {}
        for _ in range(100):
            if (state := topics.state()) is not None:
                found |= state["curves"]
                problems |= state["problems"]
        curve = found["/joint_states.position[lift]"]
        assert curve["times"] == pytest.approx([index / 10 for index in range(21)], abs=1e-6)
        assert curve["values"] == pytest.approx([index / 40 for index in range(21)])
        assert curve["unit"] == "m"
        assert "Nothing is recorded on /nothing" in problems["/nothing.x"]
        assert "has no field" in problems["/joint_states.position[nobody]"]
