"""What follows when processes end that keep running while a launch file is evaluated, such as the user's nodes."""

import io
from collections.abc import Iterator
from contextlib import redirect_stdout
from dataclasses import replace

from drake_twin.ros2.launch.events.execution_complete import ExecutionComplete
from drake_twin.ros2.launch.events.process import ProcessExited
from drake_twin.ros2.launch.launch_context import LaunchContext
from drake_twin.ros2.launch_errors import launch_error
from drake_twin.ros2.launched import Ending, LaunchedProcess, UnfiredHandler

_MOST_GENERATIONS = 8  # of processes that each start when another one has ended


def endings(context: LaunchContext, keys: list[int] | None = None, generation: int = 1) -> Iterator[Ending]:
    """Yield what follows when processes end, evaluated as if each of them ended now.

    Actions that depend on how it ended are evaluated for an end without an error and for one with an error.

    Args:
        context: The evaluation, which has come to rest; it is as before when the next one is asked for.
        keys: The processes; all that keep running by default.
        generation: How many of them start one after the other.
    """
    if context.is_shutdown or generation > _MOST_GENERATIONS:
        return
    kinds = (ProcessExited, ExecutionComplete)
    is_heard = any(issubclass(kind, handler.waits_for) for handler in context.events.handlers for kind in kinds)
    for key in [*context.lasting] if keys is None else keys:
        if not (is_heard or context.lasting[key].has_followers):
            continue
        found: list[Ending] = []
        for code in (0, 1):
            ending = _ending(context, key, code, generation, found)
            if ending is None:
                found = [replace(found[0], code=None)]
            else:
                found.append(ending)
        yield from (ending for ending in found if ending.processes or ending.log or ending.shutdown is not None)


def _ending(context: LaunchContext, key: int, code: int, generation: int, known: list[Ending]) -> Ending | None:
    """Evaluate one end; return None if it is as one that is known."""
    events, count, logged = context.events, len(context.processes), len(context.log)
    handlers, lasting, time = list(events.handlers), dict(context.lasting), events.time
    waiting = [handler for handler in handlers if not handler.fired]
    printed = io.StringIO()
    events.time = 0.0
    try:
        with context.restored(context.snapshot()), redirect_stdout(printed):
            context.lasting.pop(key).exited(code)
            events.run()
            ending = Ending(
                key=key,
                code=code,
                processes=tuple(context.processes[count:]),
                log=(*printed.getvalue().splitlines(), *context.log[logged:]),
                shutdown=events.shutdown_reason,
                handlers=tuple(
                    UnfiredHandler(item.what, len(item.entities), item.place)
                    for item in waiting
                    if item.fired and item.place is not None
                ),
            )
            if any(_is_same(ending, other) for other in known):
                return None
            started = [process.key for process in ending.processes if process.key in context.lasting]
            return replace(ending, endings=tuple(endings(context, started, generation + 1)))
    except Exception as error:  # a launch file's code raises whatever it likes
        return Ending(key, code, log=(f"what follows could not be evaluated: {launch_error(error, context)}",))
    finally:
        for handler in waiting:
            handler.fired = False
        events.come_to_rest(handlers, time)
        context.lasting = lasting
        del context.processes[count:], context.log[logged:]


def _is_same(one: Ending, other: Ending) -> bool:
    return replace(one, code=None, processes=_without_keys(one)) == replace(
        other, code=None, processes=_without_keys(other), endings=one.endings
    )


def _without_keys(ending: Ending) -> tuple[LaunchedProcess, ...]:
    return tuple(replace(process, key=0) for process in ending.processes)
