"""Where an advance stops, where it does not, and what is left of one that fails."""

import threading

import pytest
from two_hinges import INERTIA, efforts, hinges, velocities

from drake_twin.errors import InputError, RunError, ThreadError
from drake_twin.twin.stepper import Stepper

WHEELS = "/r/wheels/commands"


def drive(left, right):
    """Return a controller that drives by two wheels at once, without limits."""
    parameters = {"left_wheel_names": [left], "right_wheel_names": [right]}
    sizes = {"wheel_separation": 0.5, "wheel_radius": 0.1, "use_stamped_vel": False, "cmd_vel_timeout": 9.0}
    return "diff_drive_controller/DiffDriveController", parameters | sizes


@pytest.fixture
def make(tmp_path):
    return lambda kind=velocities, **options: hinges(tmp_path, {"wheels": kind("left", "right")}, **options).build()


def test_joints_are_looked_at_at_the_same_times_however_the_time_is_cut(make):
    ends = []
    for parts in ((1.0,), (0.1137, 0.3, 0.3003, 1.0), [0.107 + 0.007 * k for k in range(127)] + [1.0]):
        twin = make()
        twin.publish(WHEELS, [3.0, -1.0])
        twin.step(100)
        twin.publish(WHEELS, [0.0, 0.0])  # they brake, and are held once they are seen to rest
        for part in parts:
            twin.advance_to(part)
        ends.append(twin.state_sha256())
    assert len(set(ends)) == 1


def test_a_push_ends_at_its_time_within_an_advance(make):
    twin = make(efforts)
    twin.entities.apply_wrench("r::left_link", torque=(0.0, 0.0, 2.0), duration=0.3)
    twin.advance_to(1.0)
    assert twin.robot_state("r").velocities[0] == pytest.approx(2.0 / INERTIA * 0.3, rel=1e-6)


@pytest.mark.parametrize("steps", [1, 2, 3, 10])
@pytest.mark.parametrize("good", [0, 1, 2, 9])
def test_an_advance_that_fails_ends_before_the_step_that_fails(make, monkeypatch, steps, good):
    twin = make()
    twin.publish(WHEELS, [3.0, -1.0])
    advance = Stepper._advance_simulator

    def raise_error(self, step):
        advance(self, min(step, good))
        if step > good:
            raise RuntimeError("the solver did not converge")
        return False

    monkeypatch.setattr(Stepper, "_advance_simulator", raise_error)
    if good >= steps:
        twin.step(steps)
    else:
        with pytest.raises(RunError, match="did not converge"):
            twin.step(steps)
    assert twin.clock.step_count == min(good, steps)
    assert twin.context.get_time() == pytest.approx(twin.time, abs=1e-12)
    monkeypatch.undo()
    twin.advance_to(0.05)
    whole = make()
    whole.publish(WHEELS, [3.0, -1.0])
    whole.advance_to(0.05)
    assert twin.state_sha256() == whole.state_sha256()


def test_a_push_whose_step_fails_is_still_to_come(make, monkeypatch):
    twin = make(efforts)
    twin.entities.apply_wrench("r::left_link", torque=(0.0, 0.0, 2.0), duration=0.3)
    twin.advance_to(0.3)

    def raise_error(self, step):
        raise RuntimeError("the solver did not converge")

    before = twin.state_sha256()
    monkeypatch.setattr(Stepper, "_advance_simulator", raise_error)
    with pytest.raises(RunError):
        twin.step()
    assert twin.state_sha256() == before  # the push, which ends here, is part of it


def test_a_callback_and_another_thread_are_told_apart(make):
    twin, errors = make(), {}

    def call(who):
        try:
            twin.step()
        except (InputError, ThreadError) as error:
            errors[who] = str(error)

    def callback(message):
        call("callback")
        thread = threading.Thread(target=call, args=("thread",))
        thread.start()
        thread.join()

    twin.subscribe("/clock", callback, 1.0)
    twin.step()
    assert errors["callback"].startswith("a callback cannot advance the twin")
    assert errors["thread"].startswith("twin.step: the twin belongs to the thread 'MainThread', and this is 'Thread-")
    assert twin.clock.step_count == 1


def test_a_time_is_met_although_a_callback_changes_the_step_on_the_way(make):
    twin = make()
    changes = [0.004, 0.005]
    twin.subscribe("/clock", lambda message: changes and twin.clock.set_time_step(changes.pop(0)), 1.0)
    twin.advance_to(2.0)
    assert (twin.time, twin.clock.time_step) == (2.0, 0.005)
    assert twin.context.get_time() == pytest.approx(2.0)


@pytest.mark.parametrize("engine", ["discrete", "cenic"])
def test_no_stamp_is_left_out_where_a_controller_ends_an_advance(make, engine):
    """Every 11 ms, of which .055 s and others are a rounding before their step: the clock tells of each step."""
    twin, stamps = make(drive, rate=1 / 0.011, time_step=0.001, engine=engine), []
    twin.graph.subscribe("/clock", lambda message: stamps.append(round(message.clock.nanosec / 1e6)), None)
    for update in range(30):  # each starts or stops the wheels
        twin.publish("/r/wheels/cmd_vel_unstamped", {"linear": {"x": 0.3 * (update % 2)}})
        twin.step(11)
    twin.step()
    assert stamps == list(range(len(stamps)))
    assert len(stamps) > 330
