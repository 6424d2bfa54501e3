"""The events of a launch: what is called when, and what waits for what."""

import pytest

from drake_twin.errors import InputError
from drake_twin.ros2.event_queue import EventQueue
from drake_twin.ros2.launch.event import Event


class Shutdown(Event):
    reason = "done"


class Waiting:
    """A handler for one kind of event, as `launch`'s."""

    fired = False

    def __init__(self, kind, *, once=False):
        self.waits_for, self.handle_once = kind, once

    def matches(self, event):
        return isinstance(event, self.waits_for)


@pytest.fixture
def seen():
    """What the queue ran: times and names, and handlers with their events."""
    return []


@pytest.fixture
def queue(seen):
    return EventQueue(lambda handler, event: seen.append((handler, event)))


def test_what_is_due_is_called_by_time_and_then_as_it_came(queue, seen):
    def note(name):
        return lambda: seen.append((queue.time, name))

    queue.after(2.0, note("late"))
    queue.after(1.0, note("first of two"))
    queue.after(1.0, note("second of two"))
    queue.after(-5.0, note("at once"))
    queue.run()
    assert seen == [(0.0, "at once"), (1.0, "first of two"), (1.0, "second of two"), (2.0, "late")]
    assert queue.time == 2.0


def test_a_delay_counts_from_the_call_that_asks_for_it(queue, seen):
    queue.after(1.0, lambda: queue.after(0.5, lambda: seen.append(queue.time)))
    queue.run()
    assert seen == [1.5]


def test_handlers_are_asked_in_their_order_and_one_that_ends_hears_one_event(queue, seen):
    once, always, other = Waiting(Event, once=True), Waiting(Event), Waiting(Shutdown)
    queue.handlers += [once, other, always]
    first, second = Event(), Event()
    queue.dispatch(first)
    queue.dispatch(second)
    assert seen == [(once, first), (always, first), (always, second)]
    assert queue.handlers == [other, always]
    assert (once.fired, other.fired, always.fired) == (True, False, True)


def test_a_handler_that_another_one_removes_does_not_hear_the_event(seen):
    def run(handler, event):
        seen.append(handler)
        queue.handlers.remove(second)

    queue = EventQueue(run)
    first, second = Waiting(Event), Waiting(Event)
    queue.handlers += [first, second]
    queue.dispatch(Event())
    assert seen == [first]


def test_after_a_shutdown_nothing_is_called(queue, seen):
    handler = Waiting(Shutdown)
    queue.handlers.append(handler)
    queue.after(1.0, lambda: seen.append("called"))
    event = Shutdown()
    queue.shut_down(event)
    queue.shut_down(Shutdown())
    queue.run()
    assert seen == [(handler, event)]
    assert (queue.is_shutdown, queue.shutdown_reason) == (True, "done")


def test_events_without_end_are_refused(queue):
    def again():
        queue.after(0.0, again)

    again()
    with pytest.raises(InputError, match="after 20000 events the launch still has not come to rest: does it loop"):
        queue.run()


def test_as_many_events_as_are_allowed_are_called(queue, seen):
    for _ in range(20_000):
        queue.after(0.0, lambda: seen.append(None))
    queue.run()
    assert len(seen) == 20_000
