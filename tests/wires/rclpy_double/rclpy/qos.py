"""Quality of service."""

import enum


class DurabilityPolicy(enum.Enum):
    """For late joiners, or not."""

    TRANSIENT_LOCAL = 1
    VOLATILE = 2


class ReliabilityPolicy(enum.Enum):
    """Whether messages may be lost."""

    RELIABLE = 1
    BEST_EFFORT = 2


class HistoryPolicy(enum.Enum):
    """How many messages are kept."""

    KEEP_LAST = 1
    KEEP_ALL = 2


class LivelinessPolicy(enum.Enum):
    """Who says that a publisher is alive."""

    AUTOMATIC = 1
    MANUAL_BY_TOPIC = 3


class QoSProfile:
    """A profile."""

    def __init__(self, *, depth, durability, reliability, history=HistoryPolicy.KEEP_LAST, lifespan=None, **more):
        self.depth, self.reliability, self.lifespan = depth, reliability, lifespan
        self.history, self.more = history, more
        self.is_latched = durability is DurabilityPolicy.TRANSIENT_LOCAL
