"""Logs from bags and recordings: what belongs together, in time and by name."""

import numpy as np
import pytest
from pendulum_logs import STATE_TOPIC, STATES, TOPIC, messages, pendulum, write_log

from drake_twin import Twin
from drake_twin.calibration.log import made_log, read_bag
from drake_twin.calibration.recorded_log import recorded_log
from drake_twin.errors import InputError
from drake_twin.scenario import Command


@pytest.fixture(scope="module")
def endpoints(tmp_path_factory):
    with Twin(pendulum(tmp_path_factory.mktemp("pendulum"))) as twin:
        yield twin.graph.endpoints


def under(names, duration=0.5):
    """The log's messages under other topics."""
    for topic, kind, time, message in messages(duration=duration):
        yield names.get(topic, topic), kind, time, message


def measured(*times, name="hinge.position"):
    return ("/s", "/s", {name: (np.array(times, dtype=float), np.zeros(len(times)))})


def test_the_only_joint_states_of_both_belong_together_whatever_their_names(tmp_path, endpoints):
    log = read_bag(write_log(tmp_path / "log", under({STATE_TOPIC: "/joint_states"})), endpoints, {})
    assert [(item.topic, item.twin_topic) for item in log.measured] == [("/joint_states", STATE_TOPIC)]
    assert {command.topic for command in log.commands} == {TOPIC}
    assert [command.time for command in log.commands] == pytest.approx([0.1, 0.2, 0.3, 0.4])


def test_a_topic_that_is_mapped_is_the_one_that_is_named(tmp_path, endpoints):
    bag = write_log(tmp_path / "log", under({STATE_TOPIC: "/s", TOPIC: "/c"}))
    log = read_bag(bag, endpoints, {"/c": TOPIC})
    assert {command.topic for command in log.commands} == {TOPIC}
    with pytest.raises(InputError, match=f"/s is a {STATES}, but the twin's {TOPIC} is a"):
        read_bag(bag, endpoints, {"/c": TOPIC, "/s": TOPIC})
    for renamed, why in (({"/x": TOPIC}, "the bag lacks this topic"), ({"/c": "/x"}, "the twin lacks this topic")):
        with pytest.raises(InputError, match=why):
            read_bag(bag, endpoints, renamed)


def test_a_log_begins_at_its_first_command_or_measurement():
    for first, second in (((5.0, 6.0), 5.5), ((5.5, 6.0), 5.0)):
        log = made_log("log", [(5.9, "/c", [2.0]), (second, "/c", [1.0])], [measured(*first)])
        assert [(command.time, command.fields) for command in log.commands] == [
            (pytest.approx(second - 5.0), [1.0]),
            (pytest.approx(0.9), [2.0]),
        ]
        (times, _) = log.measured[0].series["hinge.position"]
        assert times == pytest.approx(np.array(first) - 5.0)


def test_stamps_of_another_clock_are_moved_to_when_they_were_recorded(tmp_path, endpoints):
    for late in (1e6, -1e6):
        bag = write_log(tmp_path / f"log{late:g}", messages(duration=0.5, late=late))
        log = read_bag(bag, endpoints, {})
        times, _ = log.measured[0].series["hinge.position"]
        assert times == pytest.approx(np.arange(0, 0.5, 0.02), abs=1e-6)
        assert [command.time for command in log.commands] == pytest.approx([0.1, 0.2, 0.3, 0.4])
        assert any(f"another clock, {-late:.3f} s behind" in note for note in log.notes)


@pytest.mark.parametrize(
    ("commands", "times", "why"),
    [
        ([], (0, 1), "commands \\(never\\)"),
        ([(2.0, "/c", [1.0])], (0, 1), "do not overlap in time"),
        ([(2.0, "/c", [1.0])], (3, 4), "do not overlap in time"),
    ],
)
def test_commands_and_measurements_overlap(commands, times, why):
    with pytest.raises(InputError, match=why):
        made_log("log", commands, [measured(*times)])
    with pytest.raises(InputError, match="nothing was measured"):
        made_log("log", [(0.0, "/c", [1.0])], [("/s", "/s", {})])


def test_a_scenarios_commands_are_in_a_recordings_log_as_often_as_they_were_published(tmp_path, endpoints):
    once, often = Command(TOPIC, (1.0,), time=0.1), Command(TOPIC, (2.0,), time=0.05, period=0.1)
    late = Command(TOPIC, (3.0,), time=0.5)
    with Twin(pendulum(tmp_path, commands=(once, often, late))) as twin:
        twin.recorder.begin()
        twin.advance_to(0.3)
        recording = twin.recorder.recording()
    log = recorded_log(recording, endpoints)
    found = [(round(command.time, 6), command.fields[0]) for command in log.commands]
    assert found == [(0.05, 2.0), (0.1, 1.0), (0.15, 2.0), (0.25, 2.0)]
    assert STATE_TOPIC in [item.topic for item in log.measured]
