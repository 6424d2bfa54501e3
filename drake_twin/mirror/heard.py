"""What a robot says: its messages, each with the time at which it was heard; from a bag, or from a wire."""

from collections.abc import Iterator
from typing import Any

from drake_twin.dataclass import dataclass
from drake_twin.playback.bag import Bag


@dataclass(frozen=True)
class Heard:
    """A message of the robot.

    Attributes:
        received: When it was heard (s), on the clock of who listens; of a bag, since the bag's start.
        topic: Its topic.
        type: Its ROS type.
        message: The message itself.
    """

    received: float
    topic: str
    type: str
    message: Any

    @property
    def stamp(self) -> float | None:
        """The time in its header (s), on the robot's clock; None without one, or where it is zero."""
        stamp = getattr(getattr(self.message, "header", None), "stamp", None)
        if stamp is None or not (stamp.sec or stamp.nanosec):
            return None
        return float(stamp.sec + stamp.nanosec * 1e-9)


def messages_of(bag: Bag, topics: set[str]) -> Iterator[Heard]:
    """Yield a bag's messages of some topics, in the order in which they were recorded.

    Raises:
        InputError: If the bag is damaged.
    """
    for item in bag.messages(lambda topic, _: topic in topics):
        yield Heard(item.time, item.topic, item.type, item.read())
