import pytest
from conftest import rovers

from drake_twin.errors import RunError
from drake_twin.messages.draft import LaterDraft
from drake_twin.systems.plant_reading import Reading
from drake_twin.twin.subscriptions import Subscription, Subscriptions


@pytest.mark.parametrize(("period", "step"), [(0.001, 0.001), (0.002, 0.002), (0.01, 0.001), (0.02, 0.005)])
@pytest.mark.parametrize("hours", [0, 10, 100, 250_000])
def test_every_grid_point_is_met_once_however_long_the_run_has_lasted(period, step, hours):
    first = round(hours * 3600 / step)
    times = []
    subscriptions = Subscriptions(step)
    subscriptions.draft = lambda topic, reading: LaterDraft(lambda: topic)
    subscriptions.add(Subscription("topic", lambda message: times.append(now), period, first * step))
    for now in range(first, first + 200):
        subscriptions.deliver(now)
    every = round(period / step)
    assert times == list(range(first, first + 200, every))


def test_what_is_due_next_is_known_anew_when_somebody_comes_goes_or_the_step_changes():
    subscriptions = Subscriptions(0.001)
    subscriptions.draft = lambda topic, reading: LaterDraft(lambda: topic)
    assert subscriptions.due_step == float("inf")
    subscriptions.add(Subscription("a", lambda message: None, 0.1, 0.05))
    end = subscriptions.add(Subscription("b", lambda message: None, 0.02, 0.05))
    subscriptions.deliver(50)
    assert subscriptions.due_step == 60
    subscriptions.use(0.01)
    assert subscriptions.due_step == 6
    end()
    assert subscriptions.due_step == 10
    subscriptions.begin(0.0)
    assert subscriptions.due_step == 0


def test_a_state_for_which_no_step_can_be_solved_is_a_failure_of_the_run(monkeypatch):
    """Efforts are those of the step to come, so whoever listens to them meets its failure first."""

    def raise_error(*_):
        raise RuntimeError("the solver\n  did not converge")

    twin = rovers(1).build()
    twin.subscribe("/robot_1/joint_states", lambda message: None)
    monkeypatch.setattr(Reading, "with_efforts", property(raise_error))
    monkeypatch.setattr("drake_twin.twin.session.read_robot_state", lambda built, *_, **__: raise_error(built, None))
    for ask in (lambda: twin.advance_to(0.1), lambda: twin.robot_state("robot_1")):
        with pytest.raises(RunError, match=r"the simulation failed after 0 s: .*the solver did not converge"):
            ask()
    twin.snapshot()  # which asks for no efforts
