"""Spans of time."""


class Duration:
    """A span of time (ns)."""

    def __init__(self, *, seconds=0):
        self.nanoseconds = int(seconds * 10**9)
