"""Events: what event handlers wait for."""


class Event:
    """Something that happened."""

    name = "launch.Event"
