"""gz-sim's BuoyancyEngine on its own: its ports, its parameters, and what a file may say."""

from math import inf, nan

import pytest
from controller_parameters import parameters_of
from device_harness import Running, setup_of
from waters import bladder, box, twin_of

from drake_twin.controllers.buoyancy_engine import BuoyancyEngine
from drake_twin.description.gazebo_drive import BUOYANCY_ENGINE
from drake_twin.errors import CommandError, InputError
from drake_twin.messages.interface_types import make


def running(**parameters):
    values = parameters_of(BUOYANCY_ENGINE, link_name="palm", **parameters)
    return Running(BuoyancyEngine(setup_of(BuoyancyEngine, values)), buoyancy_engine=None)


def number(value):
    return make("std_msgs/msg/Float64", {"data": value})


def signals(run):
    return run.controller.GetOutputPort("signals").Eval(run.context).tolist()


def volume(run):
    return run.controller.GetOutputPort("current_volume").Eval(run.context).data


def test_without_values_it_is_as_in_gz_sim():
    run = running()
    assert (signals(run), volume(run)) == ([0.0, 3e-5, 3e-5], 3e-5)


def test_it_is_filled_and_drained_at_its_rate_from_what_there_is():
    run = running(default_volume=2e-4, first_target=2e-4, max_inflation_rate=1e-5)
    run.advance(3.0)
    assert volume(run) == 2e-4
    run.send("buoyancy_engine", number(3e-4))
    run.advance(7.0)
    assert volume(run) == pytest.approx(2.4e-4)
    run.send("buoyancy_engine", number(2.1e-4))
    assert signals(run) == pytest.approx([7.0, 2.4e-4, 2.1e-4])
    run.advance(9.0)
    assert volume(run) == pytest.approx(2.2e-4)
    run.advance(11.0)
    assert volume(run) == pytest.approx(2.1e-4)


@pytest.mark.parametrize(("asked", "target"), [(1.0, 9.9e-4), (-1.0, 3e-5), (2e-4, 2e-4)])
def test_a_command_is_within_the_bladders_bounds(asked, target):
    run = running()
    run.send("buoyancy_engine", number(asked))
    assert signals(run)[2] == target


@pytest.mark.parametrize("value", [nan, inf])
def test_a_volume_that_is_not_finite_is_refused(value):
    with pytest.raises(CommandError, match="is not finite"):
        running().send("buoyancy_engine", number(value))


@pytest.mark.parametrize(
    ("parameters", "says"),
    [
        ({"max_inflation_rate": -1.0}, "max_inflation_rate is -1, and has to be zero or more"),
        ({"fluid_density": -1.0}, "fluid_density is -1, and has to be zero or more"),
        ({"max_volume": 1e-5}, "max_volume is less than min_volume"),
    ],
)
def test_parameters_that_are_refused(parameters, says):
    with pytest.raises(InputError, match=says):
        running(**parameters)


def glider(folder, plugin):
    return twin_of(folder, "", 0.01, {"auv": (box("auv", (1.0, 0.4, 0.3), 1000.0, more=plugin), (0, 0, 0))})


@pytest.mark.parametrize(
    ("elements", "says"),
    [
        ({"neutral_volume": "much"}, "<neutral_volume> is 'much', which is not"),
        ({"max_inflation_rate": -1}, "<max_inflation_rate> is -1, and has to be zero or more"),
        ({"fluid_density": -2}, "<fluid_density> is -2, and has to be zero or more"),
        ({"max_volume": 0}, "<max_volume> is less than <min_volume>"),
        ({"surface": "nan"}, "<surface> is 'nan', which is not"),
    ],
    ids=lambda value: next(iter(value)) if isinstance(value, dict) else "",
)
def test_values_that_are_refused_with_file_and_line(tmp_path, elements, says):
    with pytest.raises(InputError) as refusal:
        glider(tmp_path, f"\n{bladder(**elements)}")
    assert str(refusal.value).startswith(f"{tmp_path / 'auv.sdf'}:4: ")
    assert says in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("link", ["keel", ""])
def test_what_does_nothing_in_gazebo_is_said(tmp_path, link):
    twin = glider(tmp_path, bladder(link))
    (finding,) = (str(item) for item in twin.findings if "buoyancy_engine" in str(item))
    assert ("the robot has no link 'keel'" if link else "<link_name> is missing") in finding


@pytest.mark.parametrize(
    ("space", "topics"),
    [
        ({}, ["/buoyancy_engine", "/buoyancy_engine/current_volume"]),
        ({"namespace": "sub"}, ["/auv/buoyancy_engine", "/auv/buoyancy_engine/current_volume"]),
    ],
)
def test_its_topics(tmp_path, space, topics):
    found = glider(tmp_path, bladder(**space)).graph.topics()
    assert sorted(topic for topic in found if "buoyancy" in topic) == topics
    assert all(found[topic] == "std_msgs/msg/Float64" for topic in topics)
