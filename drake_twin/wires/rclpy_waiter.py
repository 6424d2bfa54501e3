"""A thread that waits for what comes to endpoints of rclpy, in the process of the machine's ROS 2."""

import threading
from collections.abc import Callable
from typing import Any

from drake_twin.wires.rclpy_endpoints import Endpoint


class Waiter:
    """Waits for what comes to endpoints and takes it, as an executor of rclpy does with more Python.

    To wait costs 2 µs for each endpoint: those of topics, to which more comes, do not wait with those of services.

    Args:
        context: The context of rclpy.
        lock: The lock of the endpoints.
        kinds: Which endpoints: ``subscription``, ``client``, ``service``.
        destroy: Destroys an endpoint for which nobody waits; called with the lock.
        failed: Is called with an endpoint and the exception of what came to it.
    """

    def __init__(
        self,
        context: Any,
        lock: Any,
        kinds: tuple[str, ...],
        destroy: Callable[[Endpoint], None],
        failed: Callable[[Endpoint, Exception], None],
    ):
        from rclpy.impl.implementation_singleton import rclpy_implementation

        self._context, self._lock, self._kinds, self._rclpy = context.handle, lock, kinds, rclpy_implementation
        self._destroy, self._failed = destroy, failed
        self._wake = rclpy_implementation.GuardCondition(self._context)
        self._ends: dict[int, Endpoint] = {}  # by the address that tells who is ready
        self._closed: list[Endpoint] = []
        self._has_changed = True
        self._is_over = False
        self._thread = threading.Thread(target=self._run, name=f"waits for {kinds[0]}", daemon=True)
        self._thread.start()

    def add(self, end: Endpoint) -> None:
        """Wait for what comes to an endpoint, too; with the lock."""
        self._ends[end.of.handle.pointer] = end
        self._interrupt()

    def remove(self, end: Endpoint) -> None:
        """Destroy an endpoint as soon as nobody waits for it; with the lock."""
        self._closed.append(self._ends.pop(end.of.handle.pointer))
        self._interrupt()

    def close(self) -> None:
        """End the thread."""
        self._is_over = True
        self._interrupt()
        self._thread.join()

    def _interrupt(self) -> None:
        self._has_changed = True
        self._wake.trigger_guard_condition()

    def _run(self) -> None:
        while not self._is_over:
            with self._lock:
                if self._has_changed:
                    self._has_changed = False
                    self._follow()
                self._prepare()
            self._wait_set.wait(-1)
            for kind in self._kinds:
                for pointer in self._wait_set.get_ready_entities(kind):
                    self._take(self._waited[pointer])

    def _follow(self) -> None:
        """Wait for the present endpoints."""
        for end in self._closed:
            self._destroy(end)
        self._closed = []
        self._waited = dict(self._ends)
        self._of_kinds = [(kind, [end for end in self._waited.values() if end.what == kind]) for kind in self._kinds]
        counts = {kind: len(ends) for kind, ends in self._of_kinds}
        subscriptions, clients, services = (counts.get(kind, 0) for kind in ("subscription", "client", "service"))
        self._wait_set = self._rclpy.WaitSet(subscriptions, 1, 0, clients, services, 0, self._context)

    def _prepare(self) -> None:
        """Let the wait set have all endpoints: a wait leaves those that are ready in it."""
        self._wait_set.clear_entities()
        self._wait_set.add_guard_condition(self._wake)
        for kind, ends in self._of_kinds:
            add = getattr(self._wait_set, f"add_{kind}")
            for end in ends:
                add(end.of.handle)

    def _take(self, end: Endpoint) -> None:
        try:
            end.take()
        except Exception as error:
            self._failed(end, error)
