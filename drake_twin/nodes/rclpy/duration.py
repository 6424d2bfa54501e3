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
        return "Infinite" if self.nanoseconds == 2**63 - 1 else f"{self.nanoseconds} nanoseconds"

    __hash__ = None  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Duration) and self.nanoseconds == other.nanoseconds

    def __lt__(self, other: Any) -> bool:
        return self.nanoseconds < other.nanoseconds if isinstance(other, Duration) else NotImplemented

    def to_msg(self) -> Any:
        kind_of_message = message_class("builtin_interfaces/msg/Duration")

        seconds, nanoseconds = divmod(self.nanoseconds, S_TO_NS)
        return kind_of_message(sec=seconds, nanosec=nanoseconds, check_fields=False)

    def get_c_duration(self) -> "rcl_duration_t":
        return rcl_duration_t(self._nanoseconds)

    @classmethod
    def from_msg(cls, msg: Any) -> "Duration":
        if getattr(msg, "__ros_type__", "") != "builtin_interfaces/msg/Duration":
            raise TypeError("Must pass a builtin_interfaces.msg.Duration object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec)


class rcl_duration_t:  # noqa: N801
    """What stands for rcl's structure."""

    def __init__(self, nanoseconds: int):
        self.nanoseconds = nanoseconds


Infinite = Duration(nanoseconds=2**63 - 1)
