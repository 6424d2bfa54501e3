"""Functions and coroutines as rclpy's tasks: called until they have ended, with their result."""

import pytest

from drake_twin.nodes.rclpy.task import Future, Task


def test_a_function_has_its_result_after_one_call():
    task = Task(lambda a, b=0: a + b, (2,), {"b": 3})
    assert task._is_ready()
    task()
    assert (task.result(), task._done, task._is_ready()) == (5, True, False)
    task()  # which does nothing
    assert task.result() == 5


def test_a_coroutine_waits_for_a_future_and_has_its_result():
    future, seen = Future(), []

    async def work(factor):
        seen.append("begun")
        return factor * await future

    task = Task(work, (4,))
    task()
    assert (seen, task._done, task._is_ready()) == (["begun"], False, False)
    future.set_result(2.5)
    assert task._is_ready()
    task()
    assert (task.result(), task._done) == (10.0, True)
    assert seen == ["begun"]


def test_a_function_that_returns_a_coroutine_is_one():
    async def work():
        return "done"

    task = Task(lambda: work())
    task()
    assert task.result() == "done"


def test_what_a_task_raises_is_its_exception():
    async def work():
        raise KeyError("x")

    for handler in (work, lambda: {}["x"]):
        task = Task(handler)
        task()
        assert isinstance(task.exception(), KeyError)
        assert task._done
        with pytest.raises(KeyError):
            task.result()


def test_callbacks_are_called_once_when_it_has_ended_or_is_cancelled():
    called = []
    first, second = Future(), Future()
    for future in (first, second):
        future.add_done_callback(called.append)
    assert first.remove_done_callback(called.append) is True
    assert first.remove_done_callback(called.append) is False
    first.set_result(1)
    assert called == []
    second.cancel()
    assert called == [second]
    assert (second.cancelled(), second._done) == (True, False)  # as in rclpy 7.1
    second.add_done_callback(called.append)
    assert called == [second]
