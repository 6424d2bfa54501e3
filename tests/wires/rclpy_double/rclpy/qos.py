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


class QoSProfile:
    """A profile."""

    def __init__(self, *, depth, durability, reliability, lifespan=None):
        self.depth, self.reliability, self.lifespan = depth, reliability, lifespan
        self.is_latched = durability is DurabilityPolicy.TRANSIENT_LOCAL
