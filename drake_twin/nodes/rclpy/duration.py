"""Stand-in for ``rclpy.duration``."""

from functools import total_ordering
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.constants import S_TO_NS


@total_ordering
class Duration:
    """A span of time in nanoseconds."""

    def __init__(self, *, seconds: float = 0, nanoseconds: float = 0):
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if not -(2**63) <= total < 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C duration.")
        self._nanoseconds = total

    @property
    def nanoseconds(self) -> int:
        return self._nanoseconds

    def __repr__(self) -> str:
        return f"Duration(nanoseconds={self.nanoseconds})"

    def __str__(self) -> str:
        return "Infinite" if self == Infinite else f"{self.nanoseconds} nanoseconds"

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Duration) and self.nanoseconds == other.nanoseconds

    def __hash__(self) -> int:
        return hash(self._nanoseconds)

    def __lt__(self, other: Any) -> bool:
        return self.nanoseconds < other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def __add__(self, other: Any) -> Any:
        if isinstance(other, Duration):
            return Duration(nanoseconds=self.nanoseconds + other.nanoseconds)
        return NotImplemented

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Duration):
            return Duration(nanoseconds=self.nanoseconds - other.nanoseconds)
        return NotImplemented

    def __mul__(self, factor: Any) -> Any:
        if isinstance(factor, int | float):
            return Duration(nanoseconds=self.nanoseconds * factor)
        return NotImplemented

    __rmul__ = __mul__

    def to_msg(self) -> Any:
        kind_of_message = message_class("builtin_interfaces/msg/Duration")

        seconds, nanoseconds = divmod(self.nanoseconds, S_TO_NS)
        return kind_of_message(sec=seconds, nanosec=nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any) -> "Duration":
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)


Infinite = Duration(nanoseconds=2**63 - 1)
