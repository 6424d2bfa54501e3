"""How a lookup waits for a transform."""

from collections.abc import Callable

from drake_twin.nodes import simulated_time
from drake_twin.nodes.task import here


def wait(is_ready: Callable[[], bool], timeout: int) -> None:
    """Wait until a condition holds, at most for some simulation time (ns); outside of node programs, do not wait."""
    task = here()
    if task is not None and timeout > 0:
        simulated_time.wait_until(task, is_ready, timeout * 1e-9)
