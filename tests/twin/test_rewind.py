"""The last minute of a twin: going back to a moment, and what keeping it costs and changes."""

from math import inf

import pytest
from conftest import rovers

from drake_twin import Rewind, Robot, replay
from drake_twin.errors import InputError
from drake_twin.messages import float64_multi_array
from drake_twin.scenario import World
from drake_twin.twin.rewind import COMMAND, CONTACT, FAULT, Mark
from drake_twin.twin.session import Session

WHEELS = "/robot_1/forward_velocity_controller/commands"


def driven(count=1):
    """Rovers of which the first one drives, told by the scenario at 0.1 s."""
    builder = rovers(count)
    builder.command(WHEELS, [2.0, 3.0, 2.0, 3.0], time=0.1)
    return builder.build()


def plain_run(until):
    twin = driven()
    twin.advance_to(until)
    return twin.state_sha256()


def test_going_back_ten_seconds_and_on_gives_the_state_of_a_run_that_never_did():
    twin = driven()
    with Rewind(twin) as rewind:
        twin.advance_to(12.0)
        assert rewind.go_to(2.0) == twin.time == 2.0
        twin.advance_to(12.0)
    assert twin.state_sha256() == plain_run(12.0)


def test_keeping_moments_and_looking_at_their_times_changes_nothing():
    twin = driven()
    with Rewind(twin) as rewind:
        twin.advance_to(1.3)
        assert rewind.times == (0.0, 0.5, 1.0)
    assert twin.state_sha256() == plain_run(1.3)


def test_it_goes_to_the_last_moment_before_a_time_and_drops_what_comes_after_it():
    twin = driven()
    with Rewind(twin) as rewind:
        twin.advance_to(3.0)
        assert rewind.go_to(1.7) == twin.time == 1.5
        assert rewind.times == (0.0, 0.5, 1.0, 1.5)
        twin.advance_to(2.2)
        assert rewind.times == (0.0, 0.5, 1.0, 1.5, 2.0)


def test_a_command_that_is_given_again_leads_to_the_same_state():
    twin = rovers(1).build()
    with Rewind(twin) as rewind:
        hashes = []
        for _ in range(2):
            twin.advance_to(1.0)
            twin.publish(WHEELS, float64_multi_array([1.0, 1.0, 1.0, 1.0]))
            twin.advance_to(2.0)
            hashes.append(twin.state_sha256())
            rewind.go_to(0.5)
    assert hashes[0] == hashes[1]


def test_a_recording_of_a_run_that_was_rewound_replays():
    twin = driven()
    twin.recorder.begin()
    with Rewind(twin) as rewind:
        twin.advance_to(2.0)
        twin.publish(WHEELS, [4.0, 4.0, 4.0, 4.0])
        twin.advance_to(3.0)
        rewind.go_to(1.0)
        twin.advance_to(1.6)
        twin.publish(WHEELS, [0.0, 1.0, 0.0, 1.0])
        twin.advance_to(2.5)
    assert replay(twin.recorder.recording()).state_sha256() == twin.state_sha256()


def test_robots_that_came_or_went_are_undone():
    twin = rovers(2).build()
    with Rewind(twin) as rewind:
        twin.advance_to(0.6)
        twin.entities.delete("robot_2")
        twin.entities.spawn(Robot("robot_3", twin.scenario.robots[0].model, xyz=(4, 0, 0.13)))
        twin.advance_to(1.2)
        rewind.go_to(0.5)
        assert twin.robots == ("robot_1", "robot_2")


def test_a_ring_of_a_minute_of_eight_rovers_is_small():
    twin = driven(8)
    twin.clock.set_time_step(0.02)  # the moments do not depend on it
    with Rewind(twin) as rewind:
        twin.advance_to(63.0)
        assert rewind.times == tuple(0.5 * index for index in range(5, 126))  # 2.5 s to 62.5 s
        assert rewind.size <= 2_000_000  # 121 moments of some 7 kB; the bound for all that the page keeps is 50 MB


def test_the_oldest_moments_go_when_the_memory_is_used_up():
    twin = driven()
    with Rewind(twin, most_bytes=20_000) as rewind:
        twin.advance_to(20.0)
        assert 1 < len(rewind.times) < 41
        assert rewind.times[-1] == 19.5
        assert rewind.size <= 20_000


def test_the_memory_is_that_of_the_moments_and_of_each_scenario_once():
    twin = driven()
    with Rewind(twin) as rewind:
        twin.advance_to(1.6)
        packed = [len(moment.packed) for moment in rewind._moments]
        (scenario,) = {moment.scenario for moment in rewind._moments}
        assert len(packed) == 4
        assert rewind.size == sum(packed) + len(scenario)


@pytest.fixture
def counted(monkeypatch):
    """Counts the snapshots that are taken."""
    taken = []
    monkeypatch.setattr(Session, "snapshot", lambda self, take=Session.snapshot: taken.append(1) or take(self))
    return taken


def test_a_twin_without_it_takes_no_snapshots_and_hears_no_commands(counted):
    twin = driven()
    with Rewind(twin):
        twin.advance_to(1.2)
    assert len(counted) == 3
    assert twin.recorder.listeners == []
    assert twin._session.subscriptions.due_step == inf
    twin.advance_to(3.0)
    assert len(counted) == 3


def test_after_a_reset_only_what_leads_to_the_present_is_kept():
    twin = driven()
    with Rewind(twin) as rewind:
        twin.advance_to(5.0)
        twin.reset()
        assert rewind.times == (0.0,)
        twin.advance_to(0.6)
        assert rewind.times == (0.0, 0.5)


@pytest.mark.parametrize("time", [-0.1, 2.1, float("nan"), "1"])
def test_another_time_is_refused_with_those_that_are_kept(time):
    twin = driven()
    with Rewind(twin) as rewind:
        twin.advance_to(2.0)
        with pytest.raises(InputError, match=r"it must be from 0 s to 2 s"):
            rewind.go_to(time)
        assert twin.time == 2.0


def test_there_is_nothing_to_return_to_before_the_first_advance():
    with Rewind(driven()) as rewind, pytest.raises(InputError, match="no moment is kept yet"):
        rewind.go_to(0.0)


def test_a_callback_cannot_go_back():
    twin = driven()
    refusals = []
    with Rewind(twin) as rewind:

        def go_back(_message):
            with pytest.raises(InputError) as error:
                rewind.go_to(0.0)
            refusals.append(str(error.value))

        twin.advance_to(1.0)
        end = twin.subscribe("/clock", go_back, rate=1.0)
        twin.advance_to(1.5)
        end()
    assert refusals == ["a callback cannot restore the twin that calls it: it may publish, pause and subscribe."]


@pytest.mark.parametrize(
    ("options", "text"),
    [
        ({"seconds": 0}, "seconds"),
        ({"seconds": 1e9}, "seconds"),
        ({"period": "1"}, "period"),
        ({"most_bytes": -1}, "most_bytes"),
    ],
)
def test_invalid_values_are_refused(options, text):
    with pytest.raises(InputError, match=f"not valid for {text}"):
        Rewind(driven(), **options)


def test_commands_leave_marks_that_are_joined_while_they_last():
    twin = rovers(1).build()
    with Rewind(twin) as rewind:
        for tick in range(20):  # ten a second
            twin.advance_to(0.1 * tick)
            twin.publish(WHEELS, [1.0, 1.0, 1.0, 1.0])
        twin.advance_to(4.0)
        twin.control.emergency_stop("robot_1")
        with pytest.raises(InputError):
            twin.publish(WHEELS, [1.0, 1.0, 1.0, 1.0])  # refused: no mark
        twin.control.manager("robot_1").switch_controller((), ["forward_velocity_controller"])
        publish, stop, switch = rewind.marks
        assert publish == Mark(COMMAND, f"publish {WHEELS}", 0.0, pytest.approx(1.9))
        assert stop == Mark(COMMAND, "emergency stop robot_1", 4.0, 4.0)
        assert switch.text == "switch controller robot_1"
        rewind.go_to(1.0)
        assert [(mark.text, mark.end) for mark in rewind.marks] == [(f"publish {WHEELS}", 1.0)]


def test_the_first_touch_of_two_models_leaves_a_mark():
    twin = rovers(2, spacing=0.8).build()
    with Rewind(twin) as rewind:
        twin.advance_to(0.7)
        assert rewind.marks == ()
        twin.entities.place("robot_2", (0.0, 0.0, 0.60))  # it falls onto the other
        twin.advance_to(3.0)
        marks = [mark for mark in rewind.marks if mark.kind == CONTACT]
    assert [mark.text for mark in marks] == ["robot_1 touches robot_2"]
    assert 0.7 < marks[0].start <= 1.5


def test_a_fault_leaves_a_mark():
    twin = driven()
    with Rewind(twin) as rewind:
        twin.advance_to(0.6)
        with pytest.raises(InputError):
            twin.publish(WHEELS, [1.0])  # the wrong size: ros2_control deactivates the controller
        twin.advance_to(1.2)
        faults = [mark for mark in rewind.marks if mark.kind == FAULT]
    assert [mark.start for mark in faults] == [1.0]
    assert "forward_velocity_controller" in faults[0].text


def test_the_marks_are_bounded():
    twin = driven()
    with Rewind(twin) as rewind:
        for index in range(1200):
            rewind._mark(COMMAND, f"publish /topic_{index}")
        assert len(rewind.marks) == 1000
        assert {mark.text for mark in rewind.marks} == {f"publish /topic_{index}" for index in range(200, 1200)}


def test_a_twin_at_rest_on_its_ground_has_no_marks():
    builder = rovers(1, world=World())
    with (twin := builder.build()), Rewind(twin) as rewind:
        twin.advance_to(1.0)
        assert rewind.marks == ()
