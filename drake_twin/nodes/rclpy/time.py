"""Stand-in for ``rclpy.time``."""

from functools import total_ordering
from typing import Any

from drake_twin.nodes.message_classes import message_class
from drake_twin.nodes.rclpy.clock_type import ClockType
from drake_twin.nodes.rclpy.constants import S_TO_NS
from drake_twin.nodes.rclpy.duration import Duration

CONVERSION_CONSTANT = 10**9


@total_ordering
class Time:
    """A point in time in nanoseconds, of a kind of clock."""

    def __init__(
        self, *, seconds: float = 0, nanoseconds: float = 0, clock_type: ClockType = ClockType.SYSTEM_TIME
    ) -> None:
        if not isinstance(clock_type, ClockType):
            raise TypeError("Clock type must be a ClockType enum")
        if seconds < 0:
            raise ValueError("Seconds value must not be negative")
        if nanoseconds < 0:
            raise ValueError("Nanoseconds value must not be negative")
        total = int(seconds * S_TO_NS) + int(nanoseconds)
        if total >= 2**63:
            raise OverflowError("Total nanoseconds value is too large to store in C time point.")
        self._nanoseconds = total
        self._clock_type = clock_type

    @property
    def nanoseconds(self) -> int:
        return self._nanoseconds

    @property
    def clock_type(self) -> ClockType:
        return self._clock_type

    def seconds_nanoseconds(self) -> tuple[int, int]:
        return self._nanoseconds // S_TO_NS, self._nanoseconds % S_TO_NS

    def __repr__(self) -> str:
        return f"Time(nanoseconds={self.nanoseconds}, clock_type={self.clock_type.name})"

    __hash__ = None  # type: ignore[assignment]

    def __add__(self, other: Any) -> Any:
        if isinstance(other, Duration):
            return Time(nanoseconds=self.nanoseconds + other.nanoseconds, clock_type=self.clock_type)
        return NotImplemented

    __radd__ = __add__

    def __sub__(self, other: Any) -> Any:
        if isinstance(other, Time):
            self._check_same_clock(other, "subtract times")
            return Duration(nanoseconds=self.nanoseconds - other.nanoseconds)
        if isinstance(other, Duration):
            return Time(nanoseconds=self.nanoseconds - other.nanoseconds, clock_type=self.clock_type)
        return NotImplemented

    def __eq__(self, other: object) -> bool:
        if isinstance(other, Time):
            self._check_same_clock(other, "compare times")
            return self.nanoseconds == other.nanoseconds
        return False  # as rclpy before Jazzy; there a comparison with something else is an error

    def __lt__(self, other: Any) -> Any:
        if not isinstance(other, Time):
            return NotImplemented
        self._check_same_clock(other, "compare times")
        return self.nanoseconds < other.nanoseconds

    def to_msg(self) -> Any:
        kind_of_message = message_class("builtin_interfaces/msg/Time")

        seconds, nanoseconds = self.seconds_nanoseconds()
        return kind_of_message(sec=seconds, nanosec=nanoseconds, check_fields=False)

    @classmethod
    def from_msg(cls, msg: Any, clock_type: ClockType = ClockType.ROS_TIME) -> "Time":
        if type(msg).__name__ != "Time":
            raise TypeError("Must pass a builtin_interfaces.msg.Time object")
        return cls(seconds=msg.sec, nanoseconds=msg.nanosec, clock_type=clock_type)

    def _check_same_clock(self, other: "Time", what: str) -> None:
        if self.clock_type != other.clock_type:
            raise TypeError(f"Can't {what} with different clock types")
