"""What rclpy has in C."""

import time

from rclpy.graph import GRAPH


class GuardCondition:
    """Ends a wait."""

    def __init__(self, context):
        self.is_set = False

    def trigger_guard_condition(self):
        """End the present wait, or the next one."""
        with GRAPH.changed:
            self.is_set = True
            GRAPH.changed.notify_all()


class WaitSet:
    """Waits once for what has been added: afterwards it has only what is ready."""

    def __init__(self, subscriptions, guards, timers, clients, services, events, context):
        self._room = {"subscription": subscriptions, "client": clients, "service": services}
        self.clear_entities()

    def clear_entities(self):
        """Forget all."""
        self._handles = {kind: [] for kind in self._room}
        self._guards = []

    def add_guard_condition(self, guard):
        """Add one."""
        self._guards.append(guard)

    def add_subscription(self, handle):
        """Add one."""
        self._add("subscription", handle)

    def add_client(self, handle):
        """Add one."""
        self._add("client", handle)

    def add_service(self, handle):
        """Add one."""
        self._add("service", handle)

    def _add(self, kind, handle):
        assert len(self._handles[kind]) < self._room[kind], "no room"
        self._handles[kind].append(handle)

    def wait(self, timeout):
        """Wait until something is ready, so many ns; for ever if that is negative."""
        with GRAPH.changed:
            until = None if timeout < 0 else time.monotonic() + timeout * 1e-9
            while not (guards := [guard for guard in self._guards if guard.is_set]) and not any(self._ready().values()):
                left = None if until is None else until - time.monotonic()
                if left is not None and left <= 0:
                    break
                GRAPH.changed.wait(left)
            for guard in guards:
                guard.is_set = False
            self._handles, self._guards = self._ready(), guards

    def _ready(self):
        return {kind: [one for one in handles if one._end.come] for kind, handles in self._handles.items()}

    def get_ready_entities(self, kind):
        """Return the addresses of what is ready."""
        return [handle.pointer for handle in self._handles[kind]]


class _Singleton:
    GuardCondition, WaitSet = GuardCondition, WaitSet


rclpy_implementation = _Singleton
